#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One hash of a hundred robots' bodies and beams, whoever compiled the simulator and how.

Builds the engine's bench program with gcc and clang, without and with optimization, and runs each
with every kernel of beams that this processor has, with 1 and 2 threads.  `make soak-builds`.
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "bench" / "sim"))
import layout  # noqa: E402

SECONDS = 20
FANS = ("portable", "sse2", "avx2", "avx512")


def build(compiler, level):
    """@return the program"""
    out = f"build/same/{compiler}{level}"
    subprocess.run(["make", "-s", "-j2", "DEPS=skip", f"O={out}", f"CC={compiler}", "WERROR=", "WARN=",
                    f"LEVEL={level}", f"{out}/bench/sim/engine"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    return ROOT / out / "bench" / "sim" / "engine"


def run(program, world, threads, fan):
    """@return the hashes of bodies and of percepts; None: this processor has no such kernel"""
    done = subprocess.run([program, world, str(SECONDS), "1", str(threads)], text=True, timeout=300,
                          capture_output=True, env={**os.environ, "MUSTER_FAN": fan})
    return tuple(done.stdout.split()[3:5]) if done.returncode == 0 else None


def main():
    found = {}
    with tempfile.TemporaryDirectory() as folder:
        world = layout.write(100, 1, folder)[1]
        for compiler in ("gcc", "clang"):
            if not shutil.which(compiler):
                print(f"  {compiler}: left out, not installed")
                continue
            for level in ("-O0", "-O2", "-O3"):
                program = build(compiler, level)
                for fan in FANS:
                    for threads in (1, 2):
                        hashes = run(program, world, threads, fan)
                        if hashes:
                            found.setdefault(hashes, []).append(
                                f"{compiler} {level} {fan} {threads}")
                print(f"  {compiler} {level}: {len(found)} hash{'es' if len(found) > 1 else ''}",
                      flush=True)
    most = max(found.values(), key=len)
    others = [name for names in found.values() if names is not most for name in names]
    for name in others:
        print(f"  another hash: {name}")
    print(f"{len(most)} passed, {len(others)} failed")
    return bool(others)


if __name__ == "__main__":
    sys.exit(main())
