# SPDX-License-Identifier: Apache-2.0
"""What rules say to each other: groups, services, questions, layers, and the robot's life."""
import json

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, members,
                     muster, new_domain, wait_for)

MARKET = ROOT / "experiments" / "market.yaml"


def robot_start(processes, domain, name, rules, out):
    path = out / f"{name}.clp"
    path.write_text(rules)
    processes.start(MUSTER, "robot", name, "--rules", path, "--domain", domain)
    wait_for(lambda: name in members(domain), 10, f"{name} in the white pages")


def facts_of(domain, name):
    return muster("do", name, "(facts)", "--domain", domain).stdout


def market_run(out, *words):
    """Gives what the robots printed, and the summary."""
    done = muster("run", MARKET, "--out", out, *words)
    check_equal(done.returncode, 0, f"the market: {done.stdout} {done.stderr}")
    return done.stdout + done.stderr, json.loads((out / "summary.json").read_text())


def test_the_market_is_the_same_every_time():
    """A group, the yellow pages, a question with its answer, a layer of the rules' own."""
    with folder() as out:
        hashes = set()
        for life in ("a", "b"):
            said, summary = market_run(out / life)
            for line in ("blue: bought from red for 10", "green: bought from red for 10",
                         "green: red has no layer 5"):
                check_equal(said.count(line), 1, f"'{line}' in {said}")
            for robot in summary["robots"]:
                moved = robot["distance_m"] > 0
                check_equal(moved, robot["name"] != "red", f"{robot['name']} went to the shop")
            hashes.add(summary["hash"])
        check_equal(len(hashes), 1, "different hashes of two runs")
        dear = out / "dear.clp"
        dear.write_text('(extends "shop.clp")\n(defglobal ?*price* = 21)\n')
        said, summary = market_run(out / "c", "--set", f"robots.red.rules={dear}")
        check("bought" not in said, "a shop that is too dear was found")
        check(summary["hash"] not in hashes, "another price, the same hash")


def test_a_robot_says_what_it_does_not_understand():
    shop = """
    (deffunction trade (?id ?from ?performative ?content)
      (if (eq ?performative cfp) then (reply ?id price 10)))
    (on-layer 4 trade)
    (deffunction keep (?id ?from ?performative ?content)
      (if (eq ?performative suspend) then (speak refuse ?from never layer 1) else FALSE))
    (on-layer 1 keep)
    """
    asker = "(defrule wait (never) (mail (from red)) =>)"
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        robot_start(processes, domain, "red", shop, out)
        robot_start(processes, domain, "blue", asker, out)

        def answered(line, answer):
            done = muster("do", "blue", line, "--domain", domain)
            check_equal(done.returncode, 0, f"{line}: {done.stdout} {done.stderr}")
            wait_for(lambda: answer in facts_of(domain, "blue"), 10, f"{answer} after {line}")
            muster("do", "blue", "(do-for-all-facts ((?m mail)) TRUE (retract ?m))",
                   "--domain", domain)

        answered("(send-layer 4 cfp red map)", "(content price 10) (layer 4)")
        answered("(send-layer 5 cfp red map)", "(performative not-understood)")
        answered("(speak haggle red map)", "(content haggle) (layer 3)")
        answered("(send-layer 2 sing red)", "(content sing) (layer 2)")
        answered("(send-layer 2 state red)", "(content state standby)")
        answered("(send-layer 2 facts red initial-fact)", "For a total of 1 fact.")
        answered("(send-layer 1 suspend red)", "(content never) (layer 1)")
        check_equal(members(domain)["red"]["state"], "standby", "who does not let be suspended")
        answered("(send-layer 1 dispose red)", "(performative agree)")
        wait_for(lambda: members(domain).get("red", {"state": "absent"})["state"] == "absent", 10, "red's absence")


def test_a_file_beside_the_rules_replaces_one_of_the_library():
    """By its name; the rule file itself never does, and other files of the library stay."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        (out / "gohome.clp").write_text("(deffunction stay () not-today)\n")
        broker_start(processes, domain)
        robot_start(processes, domain, "red", "(deffunction mine () (stay))", out)
        done = muster("do", "red", "(mine)", "--domain", domain)
        check("not-today" in done.stdout, f"{done.stdout} {done.stderr}")
        check("declaration" in muster("do", "red", "(gohome 1 2)", "--domain", domain).stdout,
              "the library's file is not there")
        check_equal(muster("do", "red", "(wander)", "--domain", domain).returncode, 0, "wander")
        robot_start(processes, domain, "wander", "(deffunction wander () hardly)", out)
        check("hardly" in muster("do", "wander", "(wander)", "--domain", domain).stdout,
              "the rule file comes last")


def test_a_robot_lives_through_events():
    rules = """
    (defrule lives (declare (salience 50)) (event ?what) => (send blue I ?what))
    (deffacts beginning (goal stay))
    """
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        robot_start(processes, domain, "red", rules, out)
        robot_start(processes, domain, "blue", "(defrule wait (never) (mail (from red)) =>)", out)
        processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots", "red", "--robots",
                        "blue", "--free", "--domain", domain)

        def heard(what):
            wait_for(lambda: f"(content I {what})" in facts_of(domain, "blue"), 20, what)

        # What happened before it ran is a fact, too, when it begins to run.
        check_equal(muster("do", "red", "(run)", "--domain", domain).returncode, 0, "start")
        heard("on-create")
        heard("on-run")
        check_equal(muster("do", "red", "(group-leave nowhere)", "--domain", domain).returncode, 0,
                    "a change")
        wait_for(lambda: "(event refused group-leave nowhere " in facts_of(domain, "red"), 10,
                 "the broker's refusal")
        check_equal(muster("do", "blue", "(send-layer 1 dispose red)", "--domain", domain).returncode,
                    0, "dispose")
        heard("on-dispose")
