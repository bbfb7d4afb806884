# SPDX-License-Identifier: Apache-2.0
"""Consoles: on a terminal, from a pipe, one line; breakpoints, what is watched, several at once."""
import contextlib
import signal
import subprocess
import time

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, members,
                     muster, new_domain, wait_for)
from terminal import Terminal

WORLD = ROOT / "worlds" / "arena.world"
FOLLOWER = ROOT / "rules" / "follower.clp"
# Fires once a step, whatever it sees, and says so.
TICKER = """
(defglobal ?*ticks* = 0)
(defrule tick "counts"
  (position ?time $?)
  =>
  (bind ?*ticks* (+ ?*ticks* 1)))
"""


@contextlib.contextmanager
def team(*names, rules=FOLLOWER, rate=10, policy=None):
    """Robots in a world that moves, in a domain of their own."""
    domain = new_domain()
    with Processes() as processes:
        words = ("--policy", policy) if policy else ()
        broker_start(processes, domain, *words)
        for name in names:
            processes.start(MUSTER, "robot", name, "--rules", rules, "--domain", domain)
        wait_for(lambda: set(names) <= set(members(domain)), 10, f"{names}")
        robots = (word for name in names for word in ("--robots", name))
        processes.start(MUSTER, "sim", WORLD, *robots, "--rate", rate, "--duration", 3000,
                        "--domain", domain)
        wait_for(lambda: "position" in console(domain, names[0], "(facts)").stdout, 15, "steps")
        yield domain, processes


def console(domain, name, line, *words):
    return muster("console", name, "-c", line, "--domain", domain, *words)


def answer(domain, name, line):
    done = console(domain, name, line)
    check_equal((done.returncode, done.stderr), (0, ""), f"{line} in {name}")
    return done.stdout


def piped(domain, name, text, *words):
    return subprocess.run([MUSTER, "console", name, "--domain", str(domain), *map(str, words)],
                          input=text, capture_output=True, text=True, timeout=60)


def terminal(domain, name, **env):
    return Terminal(MUSTER, "console", name, "--domain", domain, env=env)


def state_of(domain, name):
    return members(domain)[name]["state"]


# --- one line ------------------------------------------------------------------------------------


def test_one_line_and_exit_codes():
    with folder() as out:
        policy = out / "team.policy"
        policy.write_text("allow operator direct all\ndeny operator direct blue\n")
        with team("red", "blue", policy=policy) as (domain, _):
            check_equal(answer(domain, "red", "(+ 1 2)"), "3\n", "an answer")
            check_equal(console(domain, "red", "(+ 1 2)", "-c", "(+ 2 2)").stdout, "3\n4\n", "two lines")
            check_equal(answer(domain, "red", '(str-cat "a" b) red ?*mate*'), '"ab"\nred\nnil\n',
                        "three forms")
            for name, line, want, words in (
                    ("red", "(nonsense)", 8, ""), ("blue", "(facts)", 6, "refused"),
                    ("green", "(facts)", 7, "no such agent"), ("red", "(facts", 2, "never closed"),
                    ("red", "facts)", 2, "')' too many"), ("2red", "(facts)", 2, "no name")):
                done = console(domain, name, line)
                check_equal(done.returncode, want, f"{line} in {name}: {done.stderr}")
                check(words in done.stderr, done.stderr)
            check("Missing function declaration" in console(domain, "red", "(nonsense)").stdout,
                  "what CLIPS said")
            check_equal(muster("console").returncode, 2, "no name")
    domain = new_domain()
    check_equal(console(domain, "red", "(facts)").returncode, 4, "no broker")


def test_an_absent_robot_has_no_console():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        robot = processes.start(MUSTER, "robot", "red", "--rules", FOLLOWER, "--domain", domain)
        wait_for(lambda: "red" in members(domain), 10, "red")
        robot.send_signal(signal.SIGKILL)
        robot.wait()
        wait_for(lambda: state_of(domain, "red") == "absent", 10, "red is absent")
        done = console(domain, "red", "(facts)")
        check_equal(done.returncode, 7, done.stderr)
        check("absent" in done.stderr, done.stderr)


def test_long_answers_are_whole_and_in_order():
    with team("red") as (domain, _):
        answer(domain, "red", "(run)")
        done = piped(domain, "red", "(loop-for-count (?i 1 1000) do (assert (reading ?i of 1000)))"
                                    "\n(facts)\n")
        check_equal((done.returncode, done.stderr), (0, ""), "a thousand facts")
        numbers = [int(line.split("(reading ")[1].split()[0])
                   for line in done.stdout.splitlines() if "(reading" in line]
        check_equal(numbers, list(range(1, 1001)), "facts in order")
        check("For a total of 10" in done.stdout, done.stdout[-100:])
        done = piped(domain, "red", "(loop-for-count 30000 do (printout t abcdefghi crlf))\n(+ 1 1)\n",
                     "--wait", 20)
        check_equal(done.returncode, 0, done.stderr)
        check("longer than 256 KiB" in done.stdout and done.stdout.endswith("2\n"),
              done.stdout[-200:])


def test_a_thousand_lines_of_rules_go_in_at_once():
    text = "".join(f"; rule {i}\n(defrule rule-{i} \"a (note\"\n  (nothing {i})\n  (n ?x&~{i})\n"
                   f"  =>\n  (printout t \"{i})\" crlf))\n\n" for i in range(150))
    check(text.count("\n") > 1000, "a thousand lines")
    with team("red") as (domain, _):
        done = piped(domain, "red", text)
        check_equal((done.returncode, done.stdout, done.stderr), (0, "", ""), "rules")
        rules = answer(domain, "red", "(rules)")
        check_equal(rules.count("rule-"), 150, "rules that are there")
        done = piped(domain, "red", "(+ 1 1)\n)\n(defrule open")
        check_equal((done.returncode, done.stdout), (8, "2\n"), "mistakes")
        check("too many" in done.stderr and "never closed" in done.stderr, done.stderr)


# --- on a terminal -------------------------------------------------------------------------------


def test_a_person_works_with_a_robot():
    with folder() as out, team("red") as (domain, _), \
            terminal(domain, "red", XDG_STATE_HOME=str(out)) as t:
        t.wait_for("red standby> ")
        t.do("(run)", "red running> ")
        t.do("(wander)", "<Fact-")
        t.do("(facts)", "(goal safe-wander)")
        t.do("(defrule shy \"two", "... ")
        t.do("  lines\" (never) => (stay))", "red running> ")
        t.do("(ppdefrule shy)", '"two')
        t.do("(suspend)", "red suspended> ")
        before = answer(domain, "red", "(position)")
        t.do("(bind ?*mate* blue)", "blue")
        t.do("(assert (never))", "<Fact-")
        t.do("(agenda)", "shy: f-")
        t.do("(matches shy)", "Matches for Pattern 1")
        t.do("(undefrule shy)", "red suspended> ")
        check_equal(answer(domain, "red", "(position)"), before, "a suspended mind keeps still")
        t.do("(step 2)", "red suspended> ")
        t.do("(resume)", "red running> ")
        t.do("(nonsense)", "Missing function declaration")
        check("\x1b[31m" in t.raw.decode(), "failures have a colour on a terminal")
        t.type("(exit)\r")
        check_equal(t.end(), 0, "the person leaves")
        check("(wander)" in (out / "muster" / "console_history").read_text().replace("\\040", " "),
              "the history is kept")
    with team("red") as (domain, _), terminal(domain, "red", NO_COLOR="1", HOME="/") as t:
        t.wait_for("red standby> ")
        t.do("(nonsense)", "Missing function declaration")
        t.do('(format t "%c[31mbold%n" 27)', "?[31mbold")
        with Terminal(MUSTER, "do", "red", '(format t "%c[31mbold%n" 27)', "--domain",
                      domain) as one:
            one.wait_for("?[31mbold")
            check("\x1b[31m" not in one.raw.decode(), "an answer steers no terminal")
        check("\x1b[31m" not in t.raw.decode(), "no colour is wanted")
        t.type("\x04")
        check_equal(t.end(), 0, "the end of input")


def test_words_are_completed_and_history_comes_back():
    with folder() as out, team("red") as (domain, _), \
            terminal(domain, "red", XDG_STATE_HOME=str(out)) as t:
        t.wait_for("red standby> ")
        t.do("(defrule extraordinary (rarity ?x) => (printout t ?x crlf))", "red standby> ")
        since = len(t.text)
        t.type("(ppdefrule extraord\t")
        t.wait_for("extraordinary", since=since)
        t.do(")", "(rarity ?x)")
        since = len(t.text)
        t.type("(get-strat\t")
        t.wait_for("get-strategy", since=since)
        t.do(")", "depth")
        t.do("(assert (rarit\ty 1))".replace("\ty", "\t"), "<Fact-")
        t.do("(+ 40 2)", "42\n")
        since = len(t.text)
        t.type("\x1b[A\r")  # the line before
        t.wait_for("42\n", since=since)
        since = len(t.text)
        t.type("(se\t\t")  # many
        t.wait_for("set-strategy", since=since)
        since = len(t.text)
        t.type("\x03")
        t.wait_for("\nred standby> ", since=t.wait_for("^C", since=since))
        t.do("(+ 1 2)", "3\n")


def test_a_thousand_lines_are_pasted():
    text = "".join(f"(defrule rule-{i}\n  (nothing {i})\n  (n ?x&~{i})\n  ; (not this)\n  =>\n"
                   f"  (printout t {i} crlf))\n\n" for i in range(150))
    with folder() as out, team("red") as (domain, _), \
            terminal(domain, "red", XDG_STATE_HOME=str(out)) as t:
        t.wait_for("red standby> ")
        t.type(text.replace("\n", "\r"))
        t.do("(str-cat pasted - all)", '"pasted-all"', 60)
        check_equal(answer(domain, "red", "(rules)").count("rule-"), 150, "rules that are there")


def test_an_interrupt_ends_the_wait_for_a_robot_that_hangs():
    """Also when more lines are typed than can be under way."""
    with folder() as out, team("red") as (domain, processes), \
            terminal(domain, "red", XDG_STATE_HOME=str(out)) as t:
        t.wait_for("red standby> ")
        red = processes.started[1]
        red.send_signal(signal.SIGSTOP)
        since = len(t.text)
        t.type("(+ 1 1)" * 100 + "\r")
        t.wait_for("(+ 1 1)\n", since=since)
        time.sleep(0.5)  # it waits for room
        t.type("\x03")
        t.wait_for("^C\nred standby> ", since=since)
        red.send_signal(signal.SIGCONT)
        t.do("(str-cat it goes on)", "itgoeson")


# --- breakpoints and what is watched -------------------------------------------------------------


def test_a_break_stops_the_robot_before_its_rule():
    with folder() as out:
        rules = out / "ticker.clp"
        rules.write_text(TICKER)
        with team("red", "blue", rules=rules) as (domain, _), terminal(domain, "red") as t:
            t.wait_for("red standby> ")
            answer(domain, "blue", "(run)")
            t.do("(break tick)", "red standby> ")
            t.do("(run)", "break: tick is about to fire; suspended")
            t.wait_for("red suspended> ")
            check_equal(answer(domain, "red", "?*ticks*"), "0\n", "before it fires")
            ticks = int(answer(domain, "blue", "?*ticks*"))
            wait_for(lambda: int(answer(domain, "blue", "?*ticks*")) > ticks, 10,
                     "the world goes on")
            t.do("(continue)", "break: tick is about to fire; suspended")
            check_equal(answer(domain, "red", "?*ticks*"), "1\n", "once, and it stops again")
            t.do("(step 1)", "red suspended> ")
            wait_for(lambda: answer(domain, "red", "?*ticks*") == "2\n", 10, "one rule")
            t.do("(remove-break tick)", "red suspended> ")
            t.do("(resume)", "red running> ")
            wait_for(lambda: int(answer(domain, "red", "?*ticks*")) > 4, 10, "it runs")


def test_what_is_watched_is_shown_to_all_who_look():
    with team("red") as (domain, _), terminal(domain, "red") as one, \
            terminal(domain, "red") as two:
        one.wait_for("red standby> ")
        two.wait_for("red standby> ")
        one.do("(defrule hear (declare (salience 50)) (said ?x) => (printout t \"heard \" ?x crlf))", "> ")
        one.do("(run)", "red running> ")
        one.do("(watch rules)", "> ")
        two.do("(assert (said 17))", "<Fact-")
        one.wait_for("hear: f-")
        one.wait_for("heard 17")
        two.wait_for("heard 17")
        two.do("(watch activations)", "==> Activation")
        two.do("(unwatch all)", "> ")
        two.do("(watch facts)", "==> f-")
        one.wait_for("==> f-")
        one.do("(unwatch all)", "> ")
        two.type("(exit)\r")
        check_equal(two.end(), 0, "one leaves")
        one.do("(assert (said 18))", "heard 18")


def test_a_console_that_does_not_read_holds_up_nothing():
    with folder() as out:
        rules = out / "ticker.clp"
        rules.write_text(TICKER)
        with team("red", rules=rules, rate=100) as (domain, processes):
            answer(domain, "red", "(run)")
            said, errors = out / "said", out / "errors"
            with said.open("w") as to, errors.open("w") as errors_to:
                watcher = processes.start(MUSTER, "console", "red", "-c", "(watch facts)",
                                          "--watch", 60, "--domain", domain, stdout=to,
                                          stderr=errors_to)
            wait_for(lambda: "==>" in said.read_text(), 10, "it watches")
            watcher.send_signal(signal.SIGSTOP)
            # far more than the pieces that it has room for
            ticks = int(answer(domain, "red", "?*ticks*"))
            wait_for(lambda: int(answer(domain, "red", "?*ticks*")) > ticks + 3000, 60,
                     "red goes on")
            watcher.send_signal(signal.SIGCONT)
            wait_for(lambda: "came faster than this console reads" in errors.read_text(), 10,
                     "what is lost is counted")


def test_nine_consoles_on_one_robot():
    with team("red") as (domain, processes):
        for _ in range(8):
            killed = processes.start(MUSTER, "console", "red", "-c", "(my-name)", "--watch", 60,
                                     "--domain", domain, stdout=subprocess.PIPE, text=True)
            check_equal(killed.stdout.readline(), "red\n", "a console")
            killed.kill()
            killed.wait()
        done = console(domain, "red", "(watch facts)", "--watch", 1)
        check("==> f-" in done.stdout, f"the ninth sees: {done.stdout} {done.stderr}")




# --- the observer --------------------------------------------------------------------------------


@contextlib.contextmanager
def run_of(experiment, *words):
    """A run that lives on, in a domain of its own."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        processes.start(MUSTER, "run", experiment, "--domain", domain, "--out", out, "--rate", 20,
                        "--duration", 3000, *words)
        wait_for(lambda: console(domain, "observer", "(agents)").returncode == 0, 20, "a run")
        yield domain


def test_the_observer_commands_all_and_each_answers():
    with run_of(ROOT / "experiments" / "follow.yaml") as domain:
        done = console(domain, "observer", "(you-do red wander)")
        check_equal(done.returncode, 0, done.stderr)
        check(done.stdout.startswith("red: done: <Fact-"), done.stdout)
        check("blue: done:" in console(domain, "observer", "(you-do blue follow red)").stdout,
              "blue follows")
        check("(goal follow)" in answer(domain, "blue", "(facts)"), "blue's goal")
        check_equal(answer(domain, "blue", "?*mate*"), "red\n", "blue's mate")
        answer(domain, "red", "(follow green)")
        check_equal(answer(domain, "red", "?*mate*"), "green\n", "in red's own console")
        answer(domain, "observer", "(you-do red follow green)")
        team = ["blue", "green", "red", "yellow"]
        for line, said in (("(suspend robots)", "done"), ("(resume all)", "done"),
                           ("(step (create$ red blue green yellow) 3)", "done")):
            lines = answer(domain, "observer", line).splitlines()
            check_equal(sorted(lines), [f"{name}: {said}" for name in team], line)
        wait_for(lambda: all(members(domain)[name]["state"] == "suspended" for name in team), 10,
                 "three rules, and they are suspended")
        check("(goal follow)" in answer(domain, "observer", "(inspect red)"), "red is inspected")
        check("For a total of" in answer(domain, "observer", "(inspect red (agenda))"), "by a line")
        done = console(domain, "observer", "(you-do (create$ red nobody) nonsense)")
        check_equal(done.returncode, 8, done.stdout)
        check("nobody: no such agent" in done.stdout and "red: failed:" in done.stdout,
              done.stdout)
        for line, said in (("(nonsense)", "expected one of"), ("(you-do red)", "expected (you-do"),
                           ("(suspend group:nobodies)", "no agent"), ("(suspend a.b/c)", "expected")):
            done = console(domain, "observer", line)
            check_equal(done.returncode, 8, line)
            check(said in done.stdout, done.stdout)
        done = muster("do", "observer", "(you-do red stay)", "--domain", domain)
        check("red: done" in done.stdout, f"without a console: {done.stdout} {done.stderr}")
        done = piped(domain, "observer", "(inspect (create$ red blue) (facts))\n(agents)\n" * 10)
        check_equal((done.returncode, done.stderr), (0, ""), "many lines at once")
        check_equal(done.stdout.count("\nyellow robot "), 10, "an answer for each")
        with terminal(domain, "observer") as t:
            t.wait_for("observer running> ")
            t.do("(resume robots)", "yellow: done")
            since = len(t.text)
            t.type("(you-\t")
            t.wait_for("you-do", since=since)
            t.do("red wander)", "red: done: ")
            t.do("(agents)", "yellow robot running")


def test_the_observer_reaches_groups_and_services_and_is_refused():
    with folder() as out:
        (out / "team.policy").write_text("allow operator direct all\nallow observer direct all\n"
                                         "deny observer direct late\n")
        (out / "t.clp").write_text("(deffunction hello () hi)\n")
        (out / "t.yaml").write_text(
            f"name: t\nworld: {WORLD}\nduration: 10\npolicy: team.policy\nrobots:\n"
            "  - {name: red, rules: t.clp, groups: [scouts], services: [mapper]}\n"
            "  - {name: green, rules: t.clp, groups: [scouts]}\n"
            "  - {name: blue, rules: t.clp}\n")
        with run_of(out / "t.yaml") as domain, Processes() as processes:
            for who in ("group:scouts", "scouts"):
                lines = answer(domain, "observer", f"(you-do {who} hello)").splitlines()
                check_equal(sorted(lines), ["green: done: hi", "red: done: hi"], who)
            check_equal(answer(domain, "observer", "(you-do service:mapper hello)"),
                        "red: done: hi\n", "a service")
            late = processes.start(MUSTER, "robot", "late", "--rules", out / "t.clp", "--domain",
                                   domain)
            wait_for(lambda: "late" in members(domain), 10, "late")
            done = console(domain, "observer", "(you-do robots hello)")
            check_equal((done.returncode, sorted(done.stdout.splitlines())),
                        (8, ["blue: done: hi", "green: done: hi",
                             "late: refused by the trust policy", "red: done: hi"]), "one refuses")
            late.kill()
            wait_for(lambda: state_of(domain, "late") == "absent", 10, "late is gone")
            done = console(domain, "observer", "(suspend late)")
            check_equal((done.returncode, done.stdout), (8, "late: absent\n"), "nobody is there")


def test_there_is_no_observer_without_a_run():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        check_equal(console(domain, "observer", "(agents)").returncode, 7, "no run")
