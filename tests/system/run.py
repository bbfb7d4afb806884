#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs every test_* function of tests/system/test_*.py: run.py [WORD in its name ...]"""
import importlib
import pathlib
import sys
import time
import traceback

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from support import Skip  # noqa: E402


def tests(words):
    for path in sorted(HERE.glob("test_*.py")):
        module = importlib.import_module(path.stem)
        for name, function in list(vars(module).items()):
            if name.startswith("test_") and callable(function):
                full = f"{path.stem}.{name}"
                if not words or any(word in full for word in words):
                    yield full, function


def main():
    passed = failed = skipped = 0
    for name, function in tests(sys.argv[1:]):
        began = time.monotonic()
        try:
            function()
            passed += 1
            word = "ok"
        except Skip as why:
            skipped += 1
            word = f"skipped: {why}"
        except Exception:  # a test that breaks has failed, whatever broke
            failed += 1
            word = "FAILED\n" + traceback.format_exc()
        print(f"  {name} ({time.monotonic() - began:.1f} s) {word}", flush=True)
    print(f"{passed} passed, {failed} failed, {skipped} skipped")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
