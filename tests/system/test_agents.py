# SPDX-License-Identifier: Apache-2.0
"""Agents without a body: in a run with robots, in one without a simulator, and by hand."""
import json
import os
import re
import signal
import time

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, child_of, folder, members, muster,
                     new_domain, wait_for)
from test_web import Viewer, act, page_open, said_to

# Says each second which one it is, and what it hears.
CLOCK = """
(defrule begin (event on-run) => (every 1 "(strike)"))
(deffunction strike () (printout t "strikes " (round (now)) crlf) (broadcast strike (round (now))))
(defrule hear ?m <- (mail (from ?who) (content strike ?n)) => (retract ?m)
  (printout t "hears " ?who " " ?n crlf))
(defrule what (time 6.5) => (printout t (lookup (my-name)) crlf))
(defrule copy (event on-clone) => (printout t "is a copy" crlf))
"""
OFFICE = ROOT / "experiments/office.yaml"


def team_write(out, text, name="t", **rules):
    """An experiment in a folder, and its rule files."""
    for file, words in rules.items():
        (out / f"{file}.clp").write_text(words)
    path = out / f"{name}.yaml"
    path.write_text(text)
    return path


def run(out, file, *words):
    done = muster("run", file, "--out", out, "--domain", new_domain(), *words)
    check_equal(done.returncode, 0, f"the run: {done.stderr}")
    return done.stdout + done.stderr, json.loads((out / "summary.json").read_text())


def lines(said, who):
    """What one agent printed, in its order."""
    return [line.split(": ", 1)[1] for line in said.splitlines() if line.startswith(f"{who}: ")]


def answer(domain, who, line):
    done = muster("do", who, line, "--domain", domain)
    check_equal(done.returncode, 0, f"{line}: {done.stdout}{done.stderr}")
    return done.stdout


# --- without a simulator -------------------------------------------------------------------------


def test_the_number_of_processes_changes_nothing():
    with folder() as out:
        hashes = set()
        for processes in (1, 4, 20):
            file = out / f"{processes}.yaml"
            file.write_text(OFFICE.read_text().replace("processes: 4", f"processes: {processes}")
                            .replace("../rules", str(ROOT / "rules")))
            _, summary = run(out / str(processes), file)
            hashes.add(summary["hash"])
            check_equal(len(summary["agents"]), 21, "agents in summary.json")
            check_equal(summary["robots"], [], "robots")
        check_equal(len(hashes), 1, "hashes")


def test_a_recording_of_it_is_the_same_again():
    with folder() as out:
        done = muster("run", OFFICE, "--out", out / "r", "--duration", "20", "--domain", new_domain())
        check_equal(done.returncode, 1, f"it is cut short: {done.stderr}")
        summary = json.loads((out / "r/summary.json").read_text())
        done = muster("verify", out / "r/run.mcap")
        check_equal(done.returncode, 0, done.stdout + done.stderr)
        check(summary["hash"] in done.stdout, done.stdout)
        again = muster("report", out / "r")
        check_equal(json.loads((out / "r/summary.json").read_text())["agents"], summary["agents"],
                    f"agents of the report again: {again.stderr}")


def test_of_a_run_that_was_killed_the_report_has_their_numbers():
    with folder() as out, Processes() as processes:
        p = processes.start(MUSTER, "run", OFFICE, "--out", out / "r", "--rate", "20", "--domain", new_domain())
        wait_for(lambda: (out / "r/run.mcap").exists(), 20, "the run begins")
        time.sleep(2)
        p.kill()
        p.wait()
        wait_for(lambda: muster("report", out / "r").returncode in (0, 1), 10, "its processes are gone")
        boss = json.loads((out / "r/summary.json").read_text())["agents"][0]
        check_equal(boss["name"], "boss", "the first agent")
        check(all(boss[key] > 10 for key in ("mail_sent", "mail_received", "rule_firings")), boss)


def test_lock_step_and_free_running_have_one_order_of_events():
    """Of each agent by itself: one asks by timers, one answers what it hears."""
    asks = """
    (defglobal ?*n* = 0)
    (defrule begin (event on-run) => (after 0.5 first) (every 1 "(ask)"))
    (defrule first ?t <- (timeout first) => (retract ?t) (printout t "first" crlf))
    (deffunction ask () (bind ?*n* (+ ?*n* 1)) (printout t "asks " ?*n* crlf) (ask-one b what ?*n*)
      (after 0.5 waited ?*n*))
    (defrule heard ?m <- (mail (content that ?n)) => (retract ?m) (printout t "hears " ?n crlf))
    (defrule waited ?t <- (timeout waited ?n) => (retract ?t) (printout t "waited " ?n crlf))
    """
    answers = """
    (defrule asked ?m <- (mail (content what ?n)) => (printout t "asked " ?n crlf) (reply ?m that ?n)
      (retract ?m))
    """
    with folder() as out:
        text = ("simulator: none\nduration: 3.8\nagents:\n  - {name: a, rules: asks.clp}\n"
                "  - {name: b, rules: answers.clp}\n")
        file = team_write(out, text, asks=asks, answers=answers)
        lockstep, _ = run(out / "l", file)
        free, summary = run(out / "f", file, "--free")
        check_equal(summary["hash"], "none", "the hash of free running")
        for who in ("a", "b"):
            check(len(lines(lockstep, who)) >= 3, lockstep)
            check_equal(lines(free, who), lines(lockstep, who), f"what {who} lived through")


def test_the_clock_dies_and_the_run_says_so():
    with folder() as out, Processes() as processes:
        p = processes.start(MUSTER, "run", OFFICE, "--out", out / "r", "--rate", "1", "--domain", new_domain())
        clock = child_of(p, "muster-sim", "none")
        wait_for(lambda: (out / "r/run.csv").exists(), 20, "the run begins")
        time.sleep(1)
        os.kill(clock, signal.SIGKILL)
        check_equal(p.wait(30), 5, "the exit code")


# --- timers --------------------------------------------------------------------------------------


def strikes(said, who):
    return [int(line.split()[1]) for line in lines(said, who) if line.startswith("strikes")]


def test_timers_go_with_an_agent_that_moves_and_into_its_copy():
    with folder() as out:
        text = ("simulator: none\nduration: 8\nhosts: [north, south]\nagents:\n"
                "  - {name: a, host: north, rules: c.clp}\n  - {name: b, rules: c.clp}\n"
                "observer:\n  - {at: 2.5, do: a, move: south}\n  - {at: 4.5, do: b, line: (clone c south)}\n")
        file = team_write(out, text, c=CLOCK)
        said, one = run(out / "1", file)
        _, two = run(out / "2", file)
        check_equal(one["hash"], two["hash"], "hashes")
        check_equal(strikes(said, "a"), list(range(1, 8)), "the strikes of the one that moves")
        check_equal(strikes(said, "b"), list(range(1, 8)), "the strikes of the other")
        check_equal(strikes(said, "c"), [5, 6, 7], "the strikes of the copy")
        check("is a copy" in lines(said, "c"), said)
        for who in ("a", "c"):
            check(f"({who} agent running south)" in lines(said, who), f"what {who} is: {lines(said, who)}")


def test_timers_come_back_with_a_checkpoint():
    with folder() as out:
        text = ("simulator: none\nduration: 8\non-crash: restart\ncheckpoint: 0.1\nagents:\n"
                "  - {name: a, rules: c.clp}\n  - {name: b, rules: c.clp}\n"
                "chaos:\n  - {at: 3.5, kill: a}\n")
        said, summary = run(out / "r", team_write(out, text, c=CLOCK))
        check_equal([r["process"] for r in summary["restarts"]], ["a"], "restarts")
        check_equal(strikes(said.split("is started again")[1], "a"), [4, 5, 6, 7], "the strikes after the death")
        heard = [line for line in lines(said, "b") if line.startswith("hears a")]
        check_equal(heard, [f"hears a {n}" for n in range(1, 8)], "what the other heard")


def test_timers_outlive_reset():
    with folder() as out:
        text = ("simulator: none\nduration: 4\nagents:\n  - {name: a, rules: c.clp}\n"
                "observer:\n  - {at: 1.5, do: a, line: (reset)}\n")
        said, _ = run(out / "r", team_write(out, text, c=CLOCK))
        check_equal(strikes(said, "a"), [1, 2, 3], "strikes")


# --- beside robots -------------------------------------------------------------------------------


def test_they_are_no_robots_and_run_from_the_start():
    with folder() as out:
        text = (f"world: {ROOT}/worlds/arena.world\nduration: 5\n"
                "robots:\n  - {name: red, rules: r.clp}\n"
                "agents:\n  - {name: a, rules: r.clp}\n  - {name: s, rules: r.clp, standby: true}\n"
                "observer:\n  - {at: 1, do: robots, line: (assert (said robots))}\n"
                "  - {at: 2, do: all, line: (assert (said all))}\n"
                "  - {at: 3, do: s, line: (run)}\n")
        rules = ('(defrule runs (event on-run) => (printout t "runs " (round (* 10 (now))) crlf))\n'
                 '(defrule said (said ?what) => (printout t ?what crlf))\n'
                 '(defrule drives (time 4.0) => (setSpeed 100 0))\n')
        said, summary = run(out / "r", team_write(out, text, r=rules))
        check_equal(lines(said, "red")[:3], ["runs 0", "robots", "all"], "the robot")
        check_equal(lines(said, "a")[:2], ["runs 0", "all"], "the agent")
        check_equal(lines(said, "s")[:2], ["runs 30", "all"], "the one in standby")
        for who in ("a", "s"):
            check("Function setSpeed expected a body, and this agent has none" in lines(said, who)[2], said)
        check_equal(len(lines(said, "red")), 3, "a robot has a body")
        check_equal([r["name"] for r in summary["robots"]], ["red"], "robots of the summary")
        check_equal([r["name"] for r in summary["agents"]], ["a", "s"], "agents of the summary")


def test_why_names_the_mail_behind_what_it_did():
    with folder() as out:
        text = ("simulator: none\nduration: 4\nagents:\n  - {name: a, rules: a.clp}\n  - {name: b, rules: b.clp}\n")
        file = team_write(out, text, a='(defrule go (event on-run) => (after 1 "(send b please)"))',
                          b="(defrule obey ?m <- (mail (content please)) => (retract ?m) (assert (done it)))\n"
                            "(defrule say (done it) => (printout t (facts) crlf))")
        said, _ = run(out / "r", file)
        fact = re.search(r"f-(\d+) +\(done it\)", said)
        check(fact, said)
        done = muster("why", out / "r/run.mcap", "b", f"f-{fact[1]}@2")
        check_equal(done.returncode, 0, done.stderr)
        for word in ("obey", "please", "timer-calls"):
            check(word in done.stdout, f"{word} in {done.stdout}")


def test_a_policy_holds_for_them():
    with folder() as out:
        (out / "p.policy").write_text("allow observer direct all\nallow boss direct robots\n")
        text = (f"world: {ROOT}/worlds/arena.world\nduration: 3\npolicy: p.policy\n"
                "robots:\n  - {name: red, rules: r.clp}\n"
                "agents:\n  - {name: boss, rules: b.clp}\n  - {name: mob, rules: b.clp}\n")
        rules = ('(deffunction obey (?whom) (assert (obeys ?whom)))\n'
                 '(defrule obeys (obeys ?whom) => (printout t "obeys " ?whom crlf))\n')
        boss = ('(defrule command (event on-run) => (you-do red obey (my-name)))\n'
                '(defrule refused (event refused you-do red ?why) => (printout t "refused " ?why crlf))\n')
        said, _ = run(out / "r", team_write(out, text, r=rules, b=rules + boss))
        check_equal(lines(said, "red"), ["obeys boss"], "the robot")
        check_equal(lines(said, "mob"), ["refused refused"], "the one that the policy does not know")


def test_groups_and_services_of_an_experiment_are_theirs_too():
    """Also after a move to a host; a copy has neither."""
    with folder() as out:
        text = ("simulator: none\nduration: 5\nhosts: [north]\nagents:\n"
                "  - {name: a, rules: a.clp, groups: [choir], services: ['clock kind=sim']}\n"
                "  - {name: b, rules: b.clp}\n"
                "observer:\n  - {at: 1.5, do: a, move: north}\n  - {at: 2.5, do: a, line: (clone c north)}\n")
        asks = ('(defrule begin (event on-run) => (every 1 "(look)"))\n'
                '(deffunction look () (send group:choir sing (round (now)))\n'
                '  (printout t (find-service "clock kind=sim") " " (members choir) crlf))\n')
        file = team_write(out, text, b=asks, a='(defrule sings ?m <- (mail (content sing ?n)) => (retract ?m)\n'
                                               '  (printout t "sings " ?n crlf))\n'
                                               '(defrule copy (event on-clone) => (printout t "is a copy" crlf))\n')
        said, _ = run(out / "r", file)
        check_equal(lines(said, "b"), ["(a) (a)"] * 4, "what the other one finds")
        check_equal(lines(said, "a"), [f"sings {n}" for n in (1, 2, 3, 4)], "mail to its group")
        check_equal(lines(said, "c"), ["is a copy"], "the copy sings not")


# --- live ----------------------------------------------------------------------------------------


TICKER = """
(defglobal ?*ticks* = 0)
(defrule tick (time ?) => (bind ?*ticks* (+ ?*ticks* 1)))
"""


def test_console_page_and_top_of_a_run_without_a_simulator():
    with folder() as out, page_open() as (page, processes, domain):
        text = "simulator: none\nduration: 600\nagents:\n  - {name: a, rules: t.clp}\n  - {name: b, rules: t.clp}\n"
        processes.start(MUSTER, "run", team_write(out, text, t=TICKER), "--out", out / "r", "--rate", "1",
                        "--domain", domain)
        viewer = Viewer(page)
        number = viewer.next("hello")[1]["viewer"]
        shown = viewer.until("agents", lambda a: {"a", "b"} <= {line[0] for line in a["agents"]})
        check({"a", "b"} <= {line[0] for line in shown["agents"]}, shown)
        viewer.until("frame", lambda f: f["step"] > 5)
        check_equal(act(page, number, "/lines/a", "(+ 1 2)", 7).status, 202, "a line for the page's console")
        check_equal(said_to(viewer, 7), (True, "3\n"), "its answer")
        viewer.close()
        console = muster("console", "a", "-c", "(break tick)", "--domain", domain)
        check_equal(console.returncode, 0, console.stderr)
        wait_for(lambda: members(domain)["a"]["state"] == "suspended", 10, "the breakpoint")
        check_equal(members(domain)["b"]["state"], "running", "the other goes on")
        ticks = answer(domain, "a", "?*ticks*")
        answer(domain, "a", "(step 1)")
        wait_for(lambda: answer(domain, "a", "?*ticks*") != ticks, 10, "one rule")
        answer(domain, "a", "(remove-break tick)")
        answer(domain, "a", "(resume)")
        wait_for(lambda: members(domain)["a"]["state"] == "running", 10, "it runs again")
        top = muster("top", "--once", "--domain", domain)
        check_equal(top.returncode, 0, f"top: {top.stdout}{top.stderr}")
        check("0 robots, 2 agents" in top.stdout, top.stdout)
        rows = {line.split()[0]: line.split() for line in top.stdout.splitlines()[4:]}
        check_equal({name: row[1] for name, row in rows.items()}, {"a": "running", "b": "running"}, "rows of top")
        check(all(int(row[10]) > 5 for row in rows.values()), f"rules fired: {rows}")


def test_by_hand_without_a_simulator():
    """White and yellow pages, groups, timers, the wall's time."""
    with folder() as out, Processes() as processes:
        domain = new_domain()
        (out / "c.clp").write_text(CLOCK + TICKER)
        broker_start(processes, domain)
        for name, more in (("a", ()), ("b", ("--group", "g", "--service", "clock kind=wall")), ("s", ("--standby",))):
            processes.start(MUSTER, "agent", name, "--rules", out / "c.clp", "--domain", domain, *more)
        wait_for(lambda: {"a", "b", "s"} <= set(members(domain)), 10, "three agents")
        check_equal([members(domain)[n]["kind"] for n in ("a", "b", "s")], ["agent"] * 3, "kinds")
        check_equal([members(domain)[n]["state"] for n in ("a", "b", "s")], ["running", "running", "standby"], "states")
        check(" b " in muster("group", "members", "g", "--domain", domain).stdout, "the group")
        check("b" in muster("service", "find", "clock", "kind=wall", "--domain", domain).stdout, "the service")
        wait_for(lambda: int(answer(domain, "a", "?*ticks*").split()[-1]) > 10, 20, "its steps")
        now = float(answer(domain, "a", "(now)").split()[-1])
        check(abs(now - time.time()) < 60, f"the wall's time: {now}")
        check_equal(answer(domain, "s", "?*ticks*").split()[-1], "0", "the one in standby")
        check_equal(muster("start", "s", "--domain", domain).returncode, 0, "it is told to start")
        wait_for(lambda: int(answer(domain, "s", "?*ticks*").split()[-1]) > 3, 20, "it runs, too")
        done = muster("do", "a", "(position)", "--domain", domain)
        check("expected a body" in done.stdout + done.stderr, done.stdout + done.stderr)
        check_equal(muster("do", "robots", "(facts)", "--domain", domain).returncode, 7, "there are no robots")
