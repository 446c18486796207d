# SPDX-License-Identifier: MIT
"""What programs that fly for benchmarks/results share: where figures are from, files that are there whole or not at
all, and refusals."""
import os
import pathlib
import signal
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def refuse(why):
    print(f"{pathlib.Path(sys.argv[0]).name}: {why}", file=sys.stderr)
    sys.exit(2)


def end_with_children():
    """On SIGTERM, so that whoever flies ends, too."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))


def programs(folder, needed):
    """The folder of programs, whole, in which `needed` is one."""
    folder = folder.resolve()
    if not (folder / needed).exists():
        refuse(f"--bin {folder}: no {needed}; expected the folder of programs")
    return folder


def chosen(text, option, known):
    """a,b → [a, b], all of them known."""
    names = text.split(",")
    for name in names:
        if name not in known:
            refuse(f"{option} {name}: expected some of {', '.join(known)}")
    return names


def write_whole(path, text):
    partial = path.with_suffix(".partial")
    partial.write_text(text + "\n")
    partial.rename(path)


def provenance():
    """Commit and machine, as every file of results has them."""
    def told(*command):
        return subprocess.run(command, text=True, capture_output=True, check=True).stdout.strip()
    cpu = next((line.split(":")[1].split() for line in open("/proc/cpuinfo")
                if line.startswith("model name")), ["unknown"])
    version = ".".join(told("g++", "-dumpfullversion").split(".")[:2])
    return {"commit": told("git", "-C", str(ROOT), "rev-parse", "--short", "HEAD"),
            "machine": {"nproc": os.cpu_count(), "cpu": " ".join(cpu[:2]),
                        "compiler": f"g++ {version}",
                        "load": f"{os.getloadavg()[0]:.0f} others waiting"}}
