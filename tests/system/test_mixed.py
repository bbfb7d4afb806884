# SPDX-License-Identifier: Apache-2.0
"""One experiment with all kinds of agents: two robots in rules, one in C, three agents without a body in
two processes, a resolver in rules, timers, a layer of its own.  It has one hash, whatever is killed."""
import functools
import pathlib
import random
import shutil
import tempfile

import pytest
from support import BUILD, ROOT, check, check_equal, experiment_run, muster

TEAM = """name: mixed
world: {root}/worlds/arena.world
duration: 20
on-crash: restart
restarts: 9
checkpoint: 0.1
robots:
  - name: red
    controller: {{program: {build}/examples/braitenberg, args: ["0.3"]}}
  - {{name: blue, rules: robot.clp}}
  - {{name: green, rules: robot.clp}}
agents:
  - {{name: desk, rules: desk.clp}}
  - {{name: clerk, rules: clerk.clp, count: 2, processes: 1}}
observer:
  - {{at: 0, do: blue, line: "(follow red)"}}
  - {{at: 0, do: green, line: "(follow blue)"}}
expect:
  - {{sequence: [clerk_0 told order, blue told free, blue told goods, clerk_0 told thanks]}}
  - {{sequence: [clerk_1 told order, green told free, green told goods, clerk_1 told thanks]}}
  - {{statistic: mail.refused, at_most: 0}}
{more}"""

# Robots take orders on layer 5, and do them by their timers.
ROBOT = """(extends "follower.clp")
(deffunction trade (?id ?from ?performative ?content)
  (if (neq ?performative order) then (return FALSE))
  (assert (order ?from (nth$ 2 ?content)))
  (after 0.7 ready ?from (nth$ 2 ?content))
  TRUE)
(on-layer 5 trade)
(defrule ready (declare (salience 10)) ?t <- (timeout ready ?who ?n) ?o <- (order ?who ?n) => (retract ?t ?o)
  (send desk free) (speak deliver ?who (create$ goods ?n) layer 5))
"""

# least:1 is the robot that has had the fewest orders.
DESK = """
(deffacts beginning (had blue 0) (had green 0))
(deffunction more (?a ?b) (> (nth$ 2 (fact-slot-value ?a implied)) (nth$ 2 (fact-slot-value ?b implied))))
(deffunction least (?count ?sender)
  (bind ?best (nth$ 1 (sort more (find-all-facts ((?f had)) TRUE))))
  (bind ?had (fact-slot-value ?best implied))
  (retract ?best)
  (assert-string (str-cat "(had " (nth$ 1 ?had) " " (+ 1 (nth$ 2 ?had)) ")"))
  (nth$ 1 ?had))
(on-resolve least least)
(defrule free ?m <- (mail (from ?who) (content free)) => (retract ?m) (assert (idle ?who)))
"""

CLERK = """
(defglobal ?*n* = 0)
(defrule begin (event on-run) => (every 1 "(order)"))
(deffunction order () (bind ?*n* (+ ?*n* 1)) (speak order least:1 (create$ order ?*n*) layer 5))
(deffunction delivered (?id ?from ?performative ?content)
  (if (neq ?performative deliver) then (return FALSE))
  (send ?from thanks (nth$ 2 ?content))
  TRUE)
(on-layer 5 delivered)
"""


@pytest.fixture(scope="module", name="team")
def team_made():
    """A function that runs the team with more lines: its summary, its folder."""
    out = pathlib.Path(tempfile.mkdtemp(prefix="muster-mixed-"))
    for name, rules in (("robot", ROBOT), ("desk", DESK), ("clerk", CLERK)):
        (out / f"{name}.clp").write_text(rules)

    @functools.lru_cache
    def run(name, more=""):
        file = out / f"{name}.yaml"
        file.write_text(TEAM.format(root=ROOT, build=BUILD, more=more))
        done, summary = experiment_run(out / name, file=file)
        check_equal(done.returncode, 0, f"{done.stdout}{done.stderr}")
        return summary, out / name
    yield run
    shutil.rmtree(out)


def test_it_has_one_hash_and_is_verified(team):
    calm, folder = team("calm")
    check_equal([len(calm[key]) for key in ("robots", "agents")], [3, 3], "robots and agents")
    for agent in calm["agents"]:
        check(agent["mail_sent"] > 30, f"{agent['name']} orders each second, and says thanks: {agent}")
    check_equal(team("again")[0]["hash"], calm["hash"], "the hash")
    verified = muster("verify", "--programs", folder / "run.mcap")
    check_equal(verified.returncode, 0, verified.stdout + verified.stderr)
    check(calm["hash"] in verified.stdout, verified.stdout)


@pytest.mark.parametrize("seed", [1, 2])
def test_processes_in_rules_die_at_random_steps_and_nothing_changes(team, seed):
    dice = random.Random(seed)
    kills = sorted((dice.randint(1, 190) / 10, who) for who in ("blue", "green", "desk", "clerk_0", "desk"))
    wild, _ = team(f"wild-{seed}", "chaos:\n" + "".join(f"  - {{at: {at}, kill: {who}}}\n" for at, who in kills))
    check_equal(sum(r["count"] for r in wild["restarts"]), 5, f"restarts of {kills}: {wild['restarts']}")
    check_equal(wild["hash"], team("calm")[0]["hash"], f"the hash with {kills}")
