#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Runs every test_* function of tests/system/test_*.py: run.py [WORD in its name ...]

Most of them wait for leases and clocks more than they compute, so two run at a time, in two
processes with domains of their own; TEST_JOBS says otherwise.
"""
import concurrent.futures
import importlib
import os
import pathlib
import sys
import time
import traceback

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "support" / "system"))
sys.path.insert(0, str(HERE))

import support  # noqa: E402


def tests(words):
    for path in sorted(HERE.glob("test_*.py")):
        module = importlib.import_module(path.stem)
        for name, function in list(vars(module).items()):
            if name.startswith("test_") and callable(function):
                full = f"{path.stem}.{name}"
                if not words or any(word in full for word in words):
                    yield path.stem, name


def run(module, name):
    """One test.  @return what became of it, and how many seconds it took"""
    began = time.monotonic()
    try:
        getattr(importlib.import_module(module), name)()
        word = "ok"
    except support.Skip as why:
        word = f"skipped: {why}"
    except Exception:  # a test that breaks has failed, whatever broke
        word = "FAILED\n" + traceback.format_exc()
    return word, time.monotonic() - began


def main():
    counts = {"ok": 0, "FAILED": 0, "skipped:": 0}
    jobs = int(os.environ.get("TEST_JOBS", "2"))
    with support.folder() as own, concurrent.futures.ProcessPoolExecutor(
            jobs, initializer=support.process_own, initargs=(own,)) as pool:
        names = {pool.submit(run, *test): ".".join(test) for test in tests(sys.argv[1:])}
        for done in concurrent.futures.as_completed(names):
            word, took_s = done.result()
            counts[word.split()[0]] += 1
            print(f"  {names[done]} ({took_s:.1f} s) {word}", flush=True)
    print(f"{counts['ok']} passed, {counts['FAILED']} failed, {counts['skipped:']} skipped")
    return counts["FAILED"] > 0


if __name__ == "__main__":
    sys.exit(main())
