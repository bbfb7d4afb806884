#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Twenty recordings that go the same way again, every stall of ten runs explained, and what counts
as sensed in ten runs of every experiment.

`make soak-verify`; about six minutes.
"""
import json
import pathlib
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support" / "system"))
from support import BUILD, ROOT, experiment_run, folder, muster  # noqa: E402

EXPERIMENTS = ("follow", "collect", "crowd", "explore", "formation")
SEEDS = range(1, 5)
# Nobody keeps away from anybody: where these robots go, they stall.
STUBBORN = """world: {world}
duration: 60
robots:
  - {{name: s, count: 8, body: pioneer, place: random, rules: stubborn.clp}}
observer:
  - {{at: 0, do: robots, line: "(assert (goal on))"}}
"""
STUBBORN_RULES = """(defrule on (goal on) (position ? $? FALSE) => (setSpeed 400 10))
(defrule back (goal on) (position ?time $? TRUE) =>
  (setSpeed -300 (if (evenp (integer ?time)) then 40 else -40))
  (broadcast ouch))
(defrule away (goal on) (message ouch) (position ?time $? FALSE) (test (evenp (integer ?time)))
  => (setSpeed 300 -30))
"""
ENDS = {"sensed", "mail", "line"}


def verified(out, file, seed):
    done, summary = experiment_run(out / f"{file.stem}-{seed}", "--seed", seed, "--duration", 30,
                                   file=file)
    if not summary:
        sys.exit(f"a run without a summary: {done.stderr}")
    again = muster("verify", out / f"{file.stem}-{seed}" / "run.mcap", "--json", timeout=300)
    print(f"  {file.stem} seed {seed}: {again.stdout.strip() or again.stderr.strip()}", flush=True)
    return again.returncode == 0


def stalls_explained(out, file, seed):
    """(stalls, stalls whose chain ends in what was sensed, said or commanded)"""
    _, summary = experiment_run(out / "run", "--seed", seed, file=file)
    stalls = []
    for robot in summary["robots"]:
        told = muster("why", out / "run" / "run.mcap", robot["name"], "--json").stdout
        stalls += [json.loads(line) for line in told.splitlines()]
    good = [s for s in stalls if ENDS & set(s["ends"]) and "unknown" not in s["ends"]]
    for s in stalls:
        if s not in good:
            print(f"  {s}", flush=True)
    return len(stalls), len(good)


def sensed_falsely(out, file, seed):
    """(facts that count as sensed, those of them that no sensor makes)"""
    experiment_run(out / "run", "--seed", seed, file=file)
    done = subprocess.run([BUILD / "test" / "sensed", out / "run" / "run.mcap"], check=True,
                          stdout=subprocess.PIPE, text=True)
    return [int(n) for n in done.stdout.split()]


def main():
    passed = failed = 0
    with folder() as out:
        for name in EXPERIMENTS:
            for seed in SEEDS:
                equal = verified(out, ROOT / "experiments" / f"{name}.yaml", seed)
                passed, failed = passed + equal, failed + (not equal)
        for file in sorted((ROOT / "experiments").glob("*.yaml")):
            counts = [sensed_falsely(out, file, seed) for seed in range(1, 11)]
            sensed, wrong = map(sum, zip(*counts))
            print(f"  {file.stem}: {sensed} facts sensed, {wrong} of them by no sensor", flush=True)
            passed, failed = passed + (wrong == 0), failed + (wrong > 0)
        (out / "stubborn.clp").write_text(STUBBORN_RULES)
        (out / "stubborn.yaml").write_text(
            STUBBORN.format(world=ROOT / "worlds" / "arena.world"))
        for seed in range(1, 11):
            stalls, good = stalls_explained(out, out / "stubborn.yaml", seed)
            print(f"  seed {seed}: {stalls} stalls, {good} explained", flush=True)
            passed, failed = passed + (stalls == good > 0), failed + (stalls != good or not good)
    print(f"{passed} passed, {failed} failed")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
