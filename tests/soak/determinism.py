#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Twenty runs of the whole follow experiment: one hash.

Some run beside a busy loop on each core, two at 20 times real time.  Another seed, another rule, another
mail and another wheel command each give another hash.  `make soak`; about a minute.
"""
import collections
import os
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support" / "system"))
from support import ROOT, Processes, experiment_run, folder  # noqa: E402

RUNS_IDLE, RUNS_BUSY, RUNS_PACED = 10, 8, 2


def run_hash(out, *words):
    done, summary = experiment_run(out, *words)
    if not summary:
        sys.exit(f"a run without a summary: {done.stderr}")
    return summary["hash"], summary["real_time_factor"]


def changed_rules(out, action):
    path = out / "rules.clp"
    path.write_text((ROOT / "rules/follower.clp").read_text() +
                    "\n(defrule hello (declare (salience 100)) (initial-fact)"
                    f" => (bind ?x 1) {action})\n")
    return ("--set", f"robots.red.rules={path}")


def main():
    hashes = collections.Counter()
    with folder() as out:
        factors = []
        for _ in range(RUNS_IDLE):
            value, factor = run_hash(out / "r")
            hashes[value] += 1
            factors.append(factor)
        with Processes() as processes:
            for _ in range(os.cpu_count() or 1):
                processes.start("timeout", "300", "sh", "-c", "while :; do :; done")
            for _ in range(RUNS_BUSY):
                hashes[run_hash(out / "r")[0]] += 1
        for _ in range(RUNS_PACED):
            hashes[run_hash(out / "r", "--rate", "20")[0]] += 1
        print(f"{sum(hashes.values())} runs, {len(hashes)} hash(es): {dict(hashes)}")
        print(f"idle: {min(factors):.0f} to {max(factors):.0f} x real time")
        others = {"seed": run_hash(out / "r", "--seed", "2")[0]}
        for what, action in (("rule", ""), ("mail", "(send blue hello)"),
                             ("wheels", "(setSpeed 1 0) (update-sensors)")):
            others[what] = run_hash(out / "r", *changed_rules(out, action))[0]
        for what, value in others.items():
            print(f"another {what}: {value}")
    ok = len(hashes) == 1 and len({*hashes, *others.values()}) == 1 + len(others)
    print(f"{int(ok)} passed, {int(not ok)} failed")
    return not ok


if __name__ == "__main__":
    sys.exit(main())
