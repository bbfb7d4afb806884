#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A hundred kills of the broker at random instants, in mid-write and mid-drain: durable mail is all
there, once, in order.  `make soak-store`, or tests/soak/store.py SEED; about a minute and a half.
"""
import pathlib
import random
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "system"))
from support import folder, new_domain  # noqa: E402
from test_store import lives  # noqa: E402

RUNS, KILLS, MAILS = 10, 10, 40000


def main():
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else random.randrange(1 << 30)
    print(f"seed {seed}", flush=True)
    failed = 0
    for run in range(RUNS):
        level = "synced" if run % 4 == 3 else "logged"
        with folder() as out:
            try:
                lives(out, new_domain(), level, KILLS, MAILS, seed + run)
                print(f"  {KILLS} kills, {MAILS} {level} mails: ok", flush=True)
            except AssertionError as why:
                failed += 1
                print(f"  {KILLS} kills, {MAILS} {level} mails: {str(why)[:2000]}", flush=True)
    print(f"{RUNS - failed} passed, {failed} failed")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
