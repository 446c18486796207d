#!/usr/bin/env python3
"""Every header includes, by whatever way, what declares the names it uses.

    headers_complete.py include

What only the compiler sees is left to the target `headers`, which compiles each of them alone.
"""
import functools
import pathlib
import re
import sys

STANDARD = {
    "algorithm": "sort stable_sort min max clamp min_element max_element find_if any_of all_of none_of count count_if "
                 "lower_bound upper_bound nth_element reverse rotate remove_if unique transform fill copy",
    "array": "array", "atomic": "atomic", "bit": "bit_cast endian countr_zero popcount has_single_bit", "cctype": "isspace isdigit",
    "chrono": "chrono", "cmath": "sqrt hypot abs cos sin tan acos asin atan2 exp log pow floor ceil round lround isfinite isnan fmod cbrt",
    "concepts": "convertible_to same_as invocable floating_point integral", "condition_variable": "condition_variable",
    "cstdint": "int8_t int16_t int32_t int64_t uint8_t uint16_t uint32_t uint64_t", "cstring": "memcpy memcmp memset",
    "deque": "deque", "exception": "exception_ptr", "filesystem": "filesystem", "fstream": "ifstream ofstream",
    "functional": "function greater", "istream": "istream", "limits": "numeric_limits", "list": "list", "map": "map multimap",
    "memory": "unique_ptr shared_ptr weak_ptr make_unique make_shared", "mutex": "mutex lock_guard unique_lock scoped_lock",
    "numbers": "numbers", "numeric": "accumulate iota reduce gcd", "optional": "optional nullopt", "ostream": "ostream",
    "queue": "queue priority_queue", "set": "set multiset", "span": "span", "sstream": "istringstream ostringstream stringstream",
    "string": "string to_string getline", "string_view": "string_view", "thread": "thread", "tuple": "tuple tie make_tuple apply",
    "unordered_map": "unordered_map", "unordered_set": "unordered_set", "utility": "pair move swap exchange as_const",
    "variant": "variant visit monostate get_if holds_alternative", "vector": "vector",
}
EIGEN = {"Eigenvalues": "SelfAdjointEigenSolver EigenSolver", "SVD": "JacobiSVD BDCSVD", "Cholesky": "LLT LDLT",
         "LU": "FullPivLU PartialPivLU", "QR": "HouseholderQR ColPivHouseholderQR",
         "Geometry": "AngleAxisd Quaterniond Isometry3d AlignedBox Rotation2Dd Hyperplane"}
# What standard headers, and Eigen, include by what they promise.
PARENTS = {"fstream": ["istream", "ostream"], "sstream": ["istream", "ostream", "string"], "iostream": ["istream", "ostream"],
           "istream": ["ostream"], "map": ["utility"], "unordered_map": ["utility"], "vector": [], "algorithm": ["utility"],
           "tuple": ["utility"], "functional": ["utility", "tuple"], "memory": ["utility", "tuple"], "optional": ["utility"],
           "variant": ["utility"], "iomanip": ["istream", "ostream"], "filesystem": ["string", "memory"], "queue": ["vector", "deque"],
           "span": ["array"], "array": ["utility"], "string": ["string_view", "utility"], "random": ["string", "cmath", "limits"],
           "thread": ["memory"], "Eigen/Geometry": ["Eigen/SVD", "Eigen/LU"], "Eigen/Eigenvalues": ["Eigen/Cholesky", "Eigen/Geometry"],
           "Eigen": ["cmath", "limits", "algorithm", "functional", "cstdint", "utility", "string", "istream"]}

root = pathlib.Path(sys.argv[1])
headers = {str(path.relative_to(root)): path.read_text(encoding="utf-8") for path in sorted(root.rglob("*.hpp"))}


def bare(text):
    """Without comments and literals."""
    text = re.sub(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"', lambda m: '""' if m.group()[0] == '"' else "", text, flags=re.S)
    return re.sub(r"^#.*$", "", text, flags=re.M)


code = {name: bare(text) for name, text in headers.items()}
includes = {name: re.findall(r"^#include <([^>]+)>", text, re.M) for name, text in headers.items()}


@functools.lru_cache(None)
def closure(name):
    found, queue = set(), [name]
    while queue:
        at = queue.pop()
        if at in found:
            continue
        found.add(at)
        queue += includes.get(at, []) + PARENTS.get(at, []) + (PARENTS["Eigen"] if at.startswith("Eigen/") else [])
    return frozenset(found)


TYPE = re.compile(r"^(?:template <.*> )?(?:struct|class|enum class|union|concept|using) (?:\[\[nodiscard\]\] )?(\w+)", re.M)
CONSTANT = re.compile(r"^inline constexpr [\w:<>, ]+? (k[A-Z]\w*)", re.M)
FUNCTION = re.compile(r"^(?!return|using|namespace|struct|class|enum|#|concept|requires|template <[^>]*>;)[\w:][\w:<>,&*\[\] ]*? \*?&?(\w+)\(", re.M)
declared = {}
for name, text in code.items():
    for pattern in (TYPE, CONSTANT, FUNCTION):
        for match in pattern.finditer(text):
            declared.setdefault(match.group(1), set()).add(name)

standard = {word: header for header, words in STANDARD.items() for word in words.split()}
eigen = {word: header for header, words in EIGEN.items() for word in words.split()}
wrong = []
for name, text in code.items():
    near = closure(name)
    for match in re.finditer(r"\bstd::(\w+)", text):
        header = standard.get(match.group(1))
        if header and header not in near:
            wrong.append(f"{name}: std::{match.group(1)}, but not <{header}>")
    for match in re.finditer(r"\bEigen::(\w+)", text):
        header = eigen.get(match.group(1))
        if header and not {f"Eigen/{header}", "Eigen/Dense"} & near:
            wrong.append(f"{name}: Eigen::{match.group(1)}, but not <Eigen/{header}>")
    known = set(re.findall(r"(?:struct|class|enum class|using|typename|concept|union) (\w+)", text))
    known |= set(re.findall(r"[<,] ?(?:\w+) (\w+)(?= ?[=,>])", text))  # template parameters
    known |= set(re.findall(r"(?:[\w>\]]|[\w>][&*]) (\w+)\(", re.sub(r"\b(?:return|throw|else|new|case|and|or|not) ", "return(", text)))
    known |= set(re.findall(r"[\w>&*] (\w+)(?=[,)])", text)) | set(re.findall(r"\{ (\w+)\(", text))  # parameters, required
    known |= set(re.findall(r"\bauto (\w+) = ", text)) | set(re.findall(r"[\w>&*] (\w+)(?: = [^;]*|\{[^;]*)?;", text))
    for match in re.finditer(r"(?<![\w.>:])(?:surfleet::|detail::)*([A-Za-z]\w*)", text):
        word = match.group(1)
        where = declared.get(word)
        if not where or word in known or where & near:
            continue
        if word[0].islower() and not re.match(r"\s*(?:<[\w:, ]+>)?\(", text[match.end():match.end() + 40]) and not re.match(r"k[A-Z]", word):
            continue
        wrong.append(f"{name}: {word}, but nothing that declares it ({', '.join(sorted(where))})")
print(f"{len(headers)} headers, {len(declared)} names")
print("\n".join(sorted(set(wrong))))
sys.exit(1 if wrong or not headers else 0)
