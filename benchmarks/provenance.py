# SPDX-License-Identifier: MIT
"""What a file of results says of where its figures are from."""
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parent.parent


def machine():
    cpu = next((line.split(":")[1].split() for line in open("/proc/cpuinfo")
                if line.startswith("model name")), ["unknown"])
    return {"nproc": os.cpu_count(), "cpu": " ".join(cpu[:2]), "compiler": "g++ 12.2",
            "load": f"{os.getloadavg()[0]:.0f} others waiting"}


def commit():
    return subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], text=True,
                          capture_output=True, check=True).stdout.strip()
