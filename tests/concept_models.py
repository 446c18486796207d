#!/usr/bin/env python3
"""A seam has two models at least: each concept is asserted of two types, by `static_assert`, in headers, tests or
examples.

    concept_models.py include tests examples
"""
import collections
import pathlib
import re
import sys


def closing(text, start, opening, end):
    """Where the bracket that opens at `start` is closed."""
    depth = 0
    for at in range(start, len(text)):
        depth += (text[at] == opening) - (text[at] == end)
        if depth == 0:
            return at
    return len(text)


def code(path):
    return re.sub(r"//[^\n]*", "", path.read_text(encoding="utf-8"))


sources = {path: code(path) for folder in sys.argv[1:] for ending in ("hpp", "cpp")
           for path in sorted(pathlib.Path(folder).rglob(f"*.{ending}"))}
concepts = {name for path, text in sources.items() if path.is_relative_to(sys.argv[1])
            for name in re.findall(r"\bconcept (\w+) =", text)}
models = collections.defaultdict(set)
for path, text in sources.items():
    for found in re.finditer(r"\bstatic_assert\(", text):
        asserted = text[found.end():closing(text, found.end() - 1, "(", ")")]
        for use in re.finditer(r"(?<![!\w])(?:surfleet::)?(\w+)<", asserted):
            if use[1] not in concepts or asserted[:use.start()].rstrip().endswith("!"):
                continue
            arguments = asserted[use.end():closing(asserted, use.end() - 1, "<", ">")]
            models[use[1]].add(re.sub(r"\s+|surfleet::", "", arguments))
few = {name: models[name] for name in concepts if len(models[name]) < 2}
print(f"{len(concepts)} concepts, {len(few)} of them with fewer than two models")
for name, known in sorted(few.items()):
    print(f"{name}: {', '.join(known) or 'asserted of none'}; expected two models")
sys.exit(1 if few or not concepts else 0)
