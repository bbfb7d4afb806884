#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""make soak-snapshots: a mind that is written down in the middle of a run goes on as if it were not.

The programs are those of soak-engine.  tests/soak/snapshots.py [SEED [PROGRAMS]]
"""
import os
import pathlib
import random
import subprocess
import sys
import tempfile

from engine import program

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
SNAPSHOTS = ROOT / "build" / os.environ.get("BUILD", "release") / "test" / "snapshots"


def main():
    rng = random.Random(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    with tempfile.TemporaryDirectory(prefix="muster-soak-") as name:
        paths = [pathlib.Path(name) / f"{i}.clp" for i in range(count)]
        for path in paths:
            path.write_text(program(rng))
        return subprocess.run([SNAPSHOTS, *paths], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
