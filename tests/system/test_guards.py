# SPDX-License-Identifier: Apache-2.0
"""Rules that would end or hold up their robot, on the real programs."""
import os
import pathlib
import re
import signal
import subprocess

from support import (MUSTER, ROOT, Processes, alive, broker_start, check, check_equal, child_of,
                     folder, members, muster, new_domain, wait_for)

RULES = """
(defglobal ?*big* = (create$))
(deffunction deep (?x) (deep (+ ?x 1)))
(defrule drives (position $?) => (setSpeed 200 0) (update-sensors))
(defrule endless (declare (salience 9)) (attack endless) (position $?) => (while TRUE do (bind ?x 1)))
(defrule runaway (declare (salience 9)) (attack runaway) ?f <- (turn ?n)
  => (retract ?f) (assert (turn (+ ?n 1))))
(defrule recursion (declare (salience 9)) (attack deep) (position $?) => (deep 1))
(defrule giant (declare (salience 9)) (attack giant) (position $?)
  => (bind ?*big* (create$ 1 2 3)) (while TRUE do (bind ?*big* (create$ ?*big* ?*big*))))
(defrule divides (declare (salience 9)) (attack div) (position $?)
  => (div -9223372036854775808 -1))
(defrule matches (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?)
  (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) (m ?) =>)
"""
MEMORY = "its rules are gone: memory"

# Facts that are compared with each other, in the engine alone, for hours.
HANGS = """
(defrule compares (m 1 ?x) (m ?k ?y) (m ? ?z) (n ?n&~?k ?) =>)
(defrule fills (position ?t $?) (test (= ?t 1.0))
  => (loop-for-count (?i 30000) (assert (n 1 ?i))) (loop-for-count (?i 100) (assert (m 1 ?i))))
"""
WHY = "rule fills has not come back from matching the patterns of rule compares"


class Arena:
    """A broker, the simulator out of lock step, and red, which drives."""

    def __init__(self, processes, out, *words):
        self.domain = new_domain()
        rules = out / "red.clp"
        rules.write_text(RULES)
        self.log = out / "red.log"
        broker_start(processes, self.domain)
        with open(self.log, "w") as log:
            self.red = processes.start(MUSTER, "robot", "red", "--rules", rules, "--domain",
                                       self.domain, *words, stderr=log)
        processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots", "red", "--free",
                        "--domain", self.domain)
        wait_for(lambda: "red" in members(self.domain), 10, "red in the white pages")
        self.do("(run)")
        wait_for(lambda: self.speed() > 100, 10, "red drives")

    def do(self, line, code=0):
        done = muster("do", "red", line, "--wait", "10", "--domain", self.domain)
        check_equal(done.returncode, code, f"{line}: {done.stdout} {done.stderr}")
        return done.stdout

    def speed(self):
        words = self.do("(position)").strip().strip('"\\n()').split()
        return float(words[-4]) if len(words) >= 7 else 0

    def line(self):
        return members(self.domain)["red"]

    def says(self, word):
        wait_for(lambda: word in self.log.read_text(), 10, f"'{word}' in red's log")


def test_rules_that_do_not_end_are_stopped_named_and_counted():
    with folder() as out, Processes() as processes:
        arena = Arena(processes, out, "--failures", "0")
        for attack, guard, rule in (("endless", "ticks", "endless"), ("deep", "depth", "recursion"),
                                    ("giant", "memory", "giant")):
            arena.do(f"(assert (attack {attack}))")
            arena.says(f"guard={guard} rules={rule}")
            # It answers meanwhile, and stands still: nobody has set its speed.
            check("2" in arena.do("(+ 1 1)"), "an answer")
            wait_for(lambda: abs(arena.speed()) < 1, 20, f"red stands still under {attack}")
            check(rule in arena.do("(failures)"), "it is counted")
            check_equal(arena.line()["state"], "running", "its state")
            arena.do("(do-for-all-facts ((?f attack)) TRUE (retract ?f))")
            arena.do("(bind ?*big* 0)")
            wait_for(lambda: arena.speed() > 100, 20, f"red drives on after {attack}")
        check(alive(arena.red.pid), "the process lives")


def test_rules_that_are_only_many_do_not_hold_up_the_others():
    """Each firing is fine; a step has room for so many, and the robot stays responsive."""
    with folder() as out, Processes() as processes:
        arena = Arena(processes, out)
        arena.do("(assert (attack runaway) (turn 0))")
        wait_for(lambda: abs(arena.speed()) < 1, 20, "red stands still")
        check_equal(arena.line()["state"], "running", "its state")
        check("turn" in arena.do("(facts)"), "it answers")
        arena.do("(do-for-all-facts ((?f attack)) TRUE (retract ?f))")
        wait_for(lambda: arena.speed() > 100, 20, "red drives on")


def test_a_rule_that_fails_too_often_suspends_its_robot():
    with folder() as out, Processes() as processes:
        arena = Arena(processes, out, "--failures", "5")
        arena.do("(assert (attack div))")
        line = wait_for(lambda: arena.line()["state"] == "suspended" and arena.line(), 20, "suspended")
        wait_for(lambda: "reason" in arena.line(), 10, "a reason in the white pages")
        check_equal(arena.line()["reason"], "rule divides failed 5 times", f"{line}")
        check("rule divides failed 5 times" in muster("ps", "--domain", arena.domain).stdout, "ps")
        arena.says("why=rule divides failed 5 times")
        check("(divides 5)" in arena.do("(failures)"), "a suspended robot answers")
        arena.do("(do-for-all-facts ((?f attack)) TRUE (retract ?f))")
        check_equal(muster("resume", "red", "--domain", arena.domain).returncode, 0, "resume")
        wait_for(lambda: arena.speed() > 100, 20, "red drives on")
        check("reason" not in arena.line(), f"the reason is gone: {arena.line()}")


def test_what_cannot_be_undone_ends_the_rules_and_not_the_process():
    with folder() as out, Processes() as processes:
        arena = Arena(processes, out)
        check("Missing function declaration" in arena.do("(exit)", 8), "exit")
        check("Missing function declaration" in arena.do('(system "true")', 8), "system")
        check("Missing function declaration" in arena.do('(open "x" f "w")', 8), "open")
        check("nested" in arena.do("(+ 1 " * 2000 + ")" * 2000, 8), "a deep expression")
        check("the rules are gone" in arena.do("(assert (m 1) (m 2))", 8), "2^28 matches")
        wait_for(lambda: arena.line()["state"] == "suspended", 20, "suspended")
        wait_for(lambda: arena.line().get("reason") == MEMORY, 10, "why")
        check("the rules are gone" in arena.do("(+ 1 1)", 8), "it still answers")
        check(alive(arena.red.pid), "the process lives")


def test_a_broken_mind_is_made_anew():
    with folder() as out, Processes() as processes:
        arena = Arena(processes, out, "--mend", "2", "--checkpoint", "0.2", "--folder", out)
        saved = out / "red.capsule"
        arena.do("(defrule heard (event on-arrive) => (assert (arrived)))")
        arena.do("(bind ?*big* 17)")
        wait_for(lambda: 'y"big" one i17' in saved.read_text(), 10, "a checkpoint")
        check("the rules are gone" in arena.do("(assert (m 1) (m 2))", 8), "2^28 matches")
        arena.says("mind-mended name=red of=checkpoint time=1")
        check("17" in arena.do("?*big*"), "a global is lost")
        wait_for(lambda: "(arrived)" in arena.do("(facts)"), 10, "that its rules hear of it")
        wait_for(lambda: arena.speed() > 100, 10, "that it drives on")
    with folder() as out, Processes() as processes:
        arena = Arena(processes, out, "--mend", "1")
        arena.do("(assert (m 1) (m 2))", 8)
        arena.says("mind-mended name=red of=rules time=1")
        wait_for(lambda: arena.speed() > 100, 10, "that it drives on")
        arena.do("(assert (m 1) (m 2))", 8)
        wait_for(lambda: arena.line().get("reason") == MEMORY, 10, "the end of it")


def test_a_file_with_a_deep_expression_is_refused_with_its_line():
    with folder() as out:
        deep = out / "deep.clp"
        deep.write_text("; one\n(defrule deep (x)\n => (printout t " + "(+ 1 " * 100000 + "0" +
                        ")" * 100000 + "))\n")
        done = muster("robot", "red", "--rules", deep, "--domain", new_domain())
        check_equal(done.returncode, 3, done.stderr)
        check("deep.clp:2" in done.stderr and "nested" in done.stderr, done.stderr)
        check(pathlib.Path(deep).exists(), "the file")


SLOW = """
(defglobal ?*text* = "0123456789abcdef")
(deffunction grow () (loop-for-count 12 (bind ?*text* (str-cat ?*text* ?*text*))) TRUE)
"""


def busy_once(processes, domain):
    """What is said of red while it works, or None where it was done before all was asked."""
    console = processes.start(MUSTER, "console", "red", "--wait", 20, "-c",
                              "(loop-for-count 40000 (str-length (str-cat ?*text* x)))", "--domain", domain,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    busy = wait_for(lambda: members(domain)["red"].get("reason"), 10, "a word in the white pages")
    looked_up = muster("lookup", "red", "--domain", domain).stdout
    asked = muster("do", "red", "(+ 1 1)", "--wait", 0.2, "--domain", domain)
    red = members(domain)["red"]
    said = console.communicate(timeout=60)[0]
    wait_for(lambda: "reason" not in members(domain)["red"], 30, "that it is not busy any more")
    return (busy, looked_up, asked, red, said) if red.get("reason") == busy else None


def test_who_is_busy_says_since_when():
    with folder() as out, Processes() as processes:
        domain = new_domain()
        (out / "red.clp").write_text(SLOW)
        broker_start(processes, domain)
        processes.start(MUSTER, "robot", "red", "--rules", out / "red.clp", "--domain", domain)
        wait_for(lambda: "red" in members(domain), 10, "red")
        muster("do", "red", "(grow)", "--domain", domain)
        busy, looked_up, asked, red, said = wait_for(lambda: busy_once(processes, domain), 60,
                                                     "that red works for longer than it takes to ask")
        check(re.fullmatch(r"busy since \d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ", busy), busy)
        check(busy in looked_up, "lookup")
        check_equal(asked.returncode, 124, asked.stderr)
        check(f"red is {busy}" in asked.stderr, asked.stderr)
        check_equal(red["state"], "standby", "its state meanwhile")
        check(f"[red is {busy}]" in said, "the console says nothing")


def hangs(out):
    """An experiment in which red's engine does not come back from the second second on."""
    (out / "hangs.clp").write_text(HANGS)
    file = out / "hangs.yaml"
    file.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 60\nrobots:\n"
                    f"  - {{name: red, rules: hangs.clp}}\n"
                    f"  - {{name: blue, rules: {ROOT}/rules/wander.clp}}\n")
    return file


def test_an_engine_that_does_not_come_back_ends_a_lock_step():
    with folder() as out:
        done = muster("run", hangs(out), "--out", out / "run", "--domain", new_domain())
        check_equal(done.returncode, 5, done.stderr)
        check(f"red: {WHY}" in done.stderr, done.stderr)


def test_an_engine_that_does_not_come_back_is_left_in_free_running():
    """And a robot obeys a signal while it does not."""
    with folder() as out, Processes() as processes:
        domain = new_domain()
        run = processes.start(MUSTER, "run", hangs(out), "--free", "--out", out / "run", "--domain",
                              domain, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
        wait_for(lambda: members(domain).get("red", {}).get("state") == "suspended", 20, "suspended")
        check_equal(members(domain)["red"]["reason"], "its rules are gone: time", "the reason")
        check_equal(muster("do", "red", "(+ 1 1)", "--domain", domain).stdout.strip(),
                    f"red: the rules are gone: {WHY}", "an answer")
        check_equal(members(domain)["blue"]["state"], "running", "blue")
        run.send_signal(signal.SIGINT)
        check_equal(run.wait(20), 130, "the run")
        check(f"red: {WHY}" in run.stderr.read(), "what it said")
    with folder() as out, Processes() as processes:
        domain = new_domain()
        run = processes.start(MUSTER, "run", hangs(out), "--free", "--out", out / "run", "--domain",
                              domain, "--quiet", stderr=subprocess.PIPE, text=True)
        wait_for(lambda: members(domain).get("red", {}).get("reason", "").startswith("busy"), 20,
                 "red at work")
        os.kill(child_of(run, "muster-robot", "red"), signal.SIGTERM)
        check_equal(run.wait(20), 5, "the run")
        check("red ended with exit code 130" in run.stderr.read(), "how it ended")
