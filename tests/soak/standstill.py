#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Robots that are killed and stopped at random steps, in random order, again and again: the hash is
that of the run in which nothing happened.  `make soak-standstill`, or tests/soak/standstill.py
[RUNS [SEED]].
"""
import pathlib
import random
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support" / "system"))
from support import check_equal, folder, pair_run  # noqa: E402

DURATION_S = 8
EVENTS = 4


def strokes(dice):
    """Each of them, in one order or another, at any step."""
    steps = sorted(dice.sample(range(5, DURATION_S * 10 - 5), EVENTS))
    verbs = [dice.choice(("kill", "stop")) for _ in range(EVENTS - 2)] + ["kill", "stop"]
    dice.shuffle(verbs)
    for step, verb in zip(steps, verbs):
        wall_s = dice.choice((0.1, 0.4)) if verb == "kill" else dice.choice((0.3, 1.2, 1.6))
        yield f"  - {{at: {step / 10}, {verb}: {dice.choice(('red', 'blue'))}, wall_s: {wall_s}}}\n"


def main():
    runs = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int(time.time())
    dice = random.Random(seed)
    print(f"seed {seed}")
    with folder() as out:
        _, calm = pair_run(out, "calm", "", duration_s=DURATION_S)
        for i in range(runs):
            chaos = "".join(strokes(dice))
            done, summary = pair_run(out, f"{i}", "\non-crash: restart\ncheckpoint: 0.1\n"
                                     "restarts: 100\nchaos:\n" + chaos, duration_s=DURATION_S)
            check_equal(done.returncode, 0, f"run {i}\n{chaos}{done.stderr}")
            check_equal(summary["hash"], calm["hash"], f"run {i}\n{chaos}{done.stderr}")
    print(f"{runs} runs of {EVENTS} kills and stops each: one hash")


if __name__ == "__main__":
    main()
