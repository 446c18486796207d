#!/usr/bin/env python3
"""Every block of C++ in a document must stand, line by line, in a source that is compiled.

    readme_code.py README.md SOURCE...

Indentation and empty lines are free.
"""
import pathlib
import re
import sys


def lines(text):
    return [line.strip() for line in text.splitlines() if line.strip()]


document = pathlib.Path(sys.argv[1])
sources = {name: lines(pathlib.Path(name).read_text(encoding="utf-8")) for name in sys.argv[2:]}
blocks = re.findall(r"```cpp\n(.*?)```", document.read_text(encoding="utf-8"), re.S)
failed = not blocks
for block in blocks:
    wanted = lines(block)
    found = any(
        source[i : i + len(wanted)] == wanted
        for source in sources.values()
        for i in range(len(source) - len(wanted) + 1)
    )
    if not found:
        failed = True
        print(f"{document}: in no compiled source:\n{block}")
sys.exit(1 if failed else 0)
