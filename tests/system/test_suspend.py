# SPDX-License-Identifier: Apache-2.0
"""A team of a hundred is suspended and resumed while it runs: at once, and without losing mail."""
import csv
import json

from support import FOLLOW, MUSTER, ROOT, Processes, check, check_equal, folder, members, muster, new_domain, wait_for

CREW, DURATION_S, LAST_TICK_S = 100, 30, 29
DIRECTIVES = 3  # start, suspend, resume

RULES = """; SPDX-License-Identifier: Apache-2.0
(defglobal ?*next* = 1)
(defrule turn "On the spot: nobody runs into anybody."
  (position $?)
  =>
  (setSpeed 0 30)
  (update-sensors))
(defrule hear "What comes out of order, twice or not at all is told."
  (declare (salience 10))
  ?mail <- (mail (from talker) (content tick ?n))
  (not (mail (from talker) (content tick ?earlier&:(< ?earlier ?n))))
  =>
  (if (<> ?n ?*next*) then
    (send talker expected ?*next* got ?n))
  (bind ?*next* (+ ?n 1))
  (retract ?mail))
"""
TALKER = f"""; SPDX-License-Identifier: Apache-2.0
(defglobal ?*ticks* = 0)
(defrule tick
  (position ?time&:(< ?time {LAST_TICK_S}) $?)
  =>
  (bind ?*ticks* (+ ?*ticks* 1))
  (group-send crew tick ?*ticks*)
  (update-sensors))
"""


def team_write(out):
    (out / "crew.clp").write_text(RULES)
    (out / "talker.clp").write_text(TALKER)
    (out / "hall.world").write_text(f'include "{ROOT}/worlds/pioneer.inc"\n'
                                    'model ( name "hall" size [60 60 0.8] boundary 1 )\n')
    path = out / "team.yaml"
    path.write_text(f"""
world: hall.world
duration: {DURATION_S}
robots:
  - {{name: w, count: {CREW}, processes: 2, body: pioneer, place: random, rules: crew.clp, groups: [crew]}}
  - {{name: talker, body: pioneer, place: random, rules: talker.clp}}
""")
    return path


def states(domain):
    return [line["state"] for name, line in members(domain).items() if name.startswith("w_")]


def still_steps(path):
    """For each robot of the crew the steps, counted from 0, in which it does not move."""
    step, still = {}, {}
    with open(path) as file:
        for row in csv.DictReader(file):
            name = row["robot"]
            step[name] = step.get(name, -1) + 1
            if float(row["forward_m_s"]) == 0 and float(row["turn_rad_s"]) == 0:
                still.setdefault(name, []).append(step[name])
    return {name: steps for name, steps in still.items() if name.startswith("w_")}


def ticks_told(domain):
    """How many steps the talker has made: one who is not suspended."""
    said = muster("do", "talker", "?*ticks*", "--domain", domain).stdout.split()
    return int(said[1]) if said[1:] else 0


def steps_pass(domain, count):
    before = ticks_told(domain)
    wait_for(lambda: ticks_told(domain) >= before + count, 20, f"{count} steps")


def test_a_team_of_a_hundred_is_suspended_within_one_step():
    with folder() as out, Processes() as processes:
        domain = new_domain()
        run = processes.start(MUSTER, "run", team_write(out), "--quiet", "--rate", 1, "--out",
                              out / "r", "--domain", domain)
        wait_for(lambda: states(domain) == CREW * ["running"], 20, "the crew")
        steps_pass(domain, 1)
        check_equal(muster("suspend", "group:crew", "--domain", domain).returncode, 0, "suspend")
        wait_for(lambda: states(domain) == CREW * ["suspended"], 5, "they sleep")
        steps_pass(domain, 15)  # by what is told of the run, which may be some steps behind
        check_equal(muster("resume", "group:crew", "--domain", domain).returncode, 0, "resume")
        wait_for(lambda: states(domain) == CREW * ["running"], 5, "they wake")
        check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "full speed")
        check_equal(run.wait(60), 0, "exit code of the run")

        still = still_steps(out / "r" / "run.csv")
        first = still["w_0"]
        check_equal(len(still), CREW, "robots that have stood still")
        slept = first[1:]  # nobody has said anything in step 0
        check(first[0] == 0 and len(slept) >= 10, f"stood still in {first}")
        check_equal(slept, list(range(slept[0], slept[-1] + 1)), "from there on until it is resumed")
        for name, steps in still.items():
            check_equal(steps, first, f"the steps in which {name} stood still")

        summary = json.loads((out / "r" / "summary.json").read_text())
        robots = {r["name"]: r for r in summary["robots"]}
        ticks = robots["talker"]["mail_sent"]
        check(ticks > 200, f"{ticks} ticks")
        for name in still:
            check_equal(robots[name]["mail_sent"], DIRECTIVES - 1, f"answers of {name}")
            check_equal(robots[name]["mail_received"], ticks + DIRECTIVES, f"what {name} has heard")
            check(robots[name]["rule_firings"] > ticks + 200, f"{name} has looked at each tick")
        check_equal((summary["mail"]["lost"], summary["mail"]["refused"]), (0, 0), "mail lost")


def test_who_cannot_sleep_is_not_said_to():
    """The observer of a run goes on: it refuses, and all is those who can."""
    with folder() as out, Processes() as processes:
        domain = new_domain()
        processes.start(MUSTER, "run", FOLLOW, "--quiet", "--rate", 1, "--out", out / "r", "--domain", domain)
        check_equal(muster("wait", "--run", "yellow", "--domain", domain).returncode, 0, "the run")
        done = muster("suspend", "observer", "--domain", domain)
        check_equal((done.returncode, "observer refuses: suspend unsupported" in done.stderr), (6, True), done.stderr)
        done = muster("suspend", "all", "--domain", domain)
        check_equal((done.returncode, "observer" in done.stdout + done.stderr), (0, False), done.stdout + done.stderr)
        check_equal([members(domain)[name]["state"] for name in ("red", "blue", "observer")],
                    ["suspended", "suspended", "running"], "who sleeps")
