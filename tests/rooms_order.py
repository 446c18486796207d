#!/usr/bin/env python3
"""A room includes only rooms above it in the README's table, and none includes adapters.

    rooms_order.py README.md include/surfleet [--lines MOST]

Headers longer than MOST lines are refused, too.
"""
import argparse
import pathlib
import re
import statistics
import sys

parser = argparse.ArgumentParser()
parser.add_argument("readme")
parser.add_argument("headers")
parser.add_argument("--lines", type=int, default=None)
args = parser.parse_args()

rooms = re.findall(r"^\| `(\w+)` \|", pathlib.Path(args.readme).read_text(encoding="utf-8"), re.M)
root = pathlib.Path(args.headers)
rooms = [room for room in rooms if (root / room).is_dir()]
wrong = []
for room in sorted(path.name for path in root.iterdir() if path.is_dir()):
    if room not in rooms:
        wrong.append(f"{room}: not in the table of rooms")
lengths = []
for header in sorted(root.glob("*/**/*.hpp")):
    text = header.read_text(encoding="utf-8")
    room = header.relative_to(root).parts[0]
    lengths.append(text.count("\n"))
    if args.lines and lengths[-1] > args.lines:
        wrong.append(f"{header}: {lengths[-1]} lines; expected at most {args.lines}")
    for included in re.findall(r"#include <surfleet/(\w+)[/.]", text):
        if included not in rooms or room not in rooms:
            continue
        below = rooms.index(included) > rooms.index(room)
        if below or (included == "adapters" and room != "adapters"):
            wrong.append(f"{header}: includes {included}, which stands below {room}")
print(f"{len(lengths)} headers, {statistics.median(lengths):.0f} lines in the median, {max(lengths)} at most")
print("\n".join(wrong))
sys.exit(1 if wrong or not rooms else 0)
