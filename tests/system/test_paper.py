# SPDX-License-Identifier: Apache-2.0
"""The paper's own fragment of rules, where somebody has it: it runs as it stands.

MUSTER_TEST_DATA names the folder with paper-fragment.clp; MUSTER_FREE_S makes the run out of lock
step longer, which is in real time.
"""
import json
import os
import pathlib

from support import ROOT, Skip, check, check_equal, folder, muster

TEAM = """
name: paper
world: {root}/worlds/arena.world
duration: {seconds}
robots:
  - {{name: red,    rules: {root}/rules/follower.clp}}
  - {{name: blue,   rules: {fragment}}}
  - {{name: green,  rules: {fragment}}}
  - {{name: yellow, rules: {fragment}}}
observer:
  - {{at: 0, do: red,    line: "(wander)"}}
  - {{at: 0, do: blue,   line: "(follow red)"}}
  - {{at: 0, do: green,  line: "(follow blue)"}}
  - {{at: 0, do: yellow, line: "(follow green)"}}
expect:
  - inside: arena
"""


def fragment():
    path = pathlib.Path(os.environ.get("MUSTER_TEST_DATA", "")) / "paper-fragment.clp"
    if not os.environ.get("MUSTER_TEST_DATA") or not path.exists():
        raise Skip("MUSTER_TEST_DATA has no paper-fragment.clp")
    return path


def run_team(seconds, *words):
    with folder() as out:
        file = out / "paper.yaml"
        file.write_text(TEAM.format(root=ROOT, fragment=fragment(), seconds=seconds))
        done = muster("run", file, "--out", out / "report", *words, timeout=seconds + 120)
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        check("rule " not in done.stderr, f"a rule has failed: {done.stderr}")
        robots = json.loads((out / "report" / "summary.json").read_text())["robots"]
    for robot in robots:
        check(robot["stalled_s"] < 0.01 * seconds, f"stalled too long: {robot}")
        check(robot["distance_m"] > 0.1 * seconds, f"hardly moved: {robot}")


def test_the_papers_rules_run_ten_minutes_in_lock_step():
    run_team(600)


def test_the_papers_rules_run_free():
    run_team(int(os.environ.get("MUSTER_FREE_S", "12")), "--free")
