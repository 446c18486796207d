#!/usr/bin/env python3
"""A room includes only rooms above it in the README's table, and none includes adapters.

    rooms_order.py README.md include/surfleet [--lines MOST] [--median MOST] [--apart ROOM OTHER]... [--only HEADER]

Headers that include themselves by way of others are refused, too, and those longer than MOST lines, alone or in the
median, and a ROOM that includes OTHER by way of any header. With --only, says how long HEADER is with all that no
other header needs, those of whole rooms aside.
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
parser.add_argument("--median", type=int, default=None)
parser.add_argument("--apart", nargs=2, action="append", default=[])
parser.add_argument("--only", default=None)
args = parser.parse_args()

rooms = re.findall(r"^\| `(\w+)` \|", pathlib.Path(args.readme).read_text(encoding="utf-8"), re.M)
root = pathlib.Path(args.headers)
rooms = [room for room in rooms if (root / room).is_dir()]
wrong = []
for room in sorted(path.name for path in root.iterdir() if path.is_dir()):
    if room not in rooms:
        wrong.append(f"{room}: not in the table of rooms")
lengths, users, uses = {}, {}, {}
for header in sorted(root.glob("*/**/*.hpp")):
    text = header.read_text(encoding="utf-8")
    name = header.relative_to(root)
    room = name.parts[0]
    lengths[str(name)] = text.count("\n")
    uses[str(name)] = re.findall(r"#include <surfleet/([^>]+)>", text)
    for used in uses[str(name)]:
        users.setdefault(used, set()).add(str(name))
    if args.lines and lengths[str(name)] > args.lines:
        wrong.append(f"{header}: {lengths[str(name)]} lines; expected at most {args.lines}")
    for included in re.findall(r"#include <surfleet/(\w+)[/.]", text):
        if included not in rooms or room not in rooms:
            continue
        below = rooms.index(included) > rooms.index(room)
        if below or (included == "adapters" and room != "adapters"):
            wrong.append(f"{header}: includes {included}, which stands below {room}")
below, done = [], set()


def seek_circles(header):
    """Whatever `header` includes, by way of any other."""
    if header in below:
        wrong.append("a circle: " + " → ".join(below[below.index(header):] + [header]))
    if header in below or header in done:
        return
    below.append(header)
    for used in uses.get(header, []):
        # What a header declares may be defined in a file beside it, which includes it.
        if "/detail/" not in used or header not in uses.get(used, []):
            seek_circles(used)
    done.add(below.pop())


for header in uses:
    seek_circles(header)
for room, other in args.apart:
    reached = {header for header in uses if header.startswith(room + "/")}
    if not reached or other not in rooms:
        wrong.append(f"--apart {room} {other}: expected two rooms")
    while more := {used for header in reached for used in uses.get(header, [])} - reached:
        reached |= more
    wrong += [f"{room} includes {header}" for header in sorted(reached) if re.match(rf"{other}[/.]", header)]
if args.median and statistics.median(lengths.values()) > args.median:
    wrong.append(f"{statistics.median(lengths.values())} lines in the median; expected at most {args.median}")
print(f"{len(lengths)} headers, {statistics.median(lengths.values()):.0f} lines in the median, "
      f"{max(lengths.values())} at most")
if args.only:
    if args.only not in lengths:
        sys.exit(f"--only {args.only}: no such header")
    own = {args.only}
    while more := {h for h, by in users.items() if h in lengths and h not in own and by <= own}:
        own |= more
    print(f"{args.only}: {sum(lengths[h] for h in own)} lines in {len(own)} headers")
print("\n".join(wrong))
sys.exit(1 if wrong or not rooms else 0)
