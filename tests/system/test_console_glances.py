# SPDX-License-Identifier: Apache-2.0
"""Lines that only look: answered between two steps, and the run is the one in which nobody looked."""
import json
import signal
import subprocess
import threading
import time

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, experiment_run,
                     folder, members, muster, new_domain, wait_for)
from test_console import FOLLOWER, answer, console, piped, state_of, team
from test_trust import records

# What a mind has come to goes out as mail, and so into the hash: the number of the next fact, of the
# next name that is made up, and the next random number.
TOLD = "(send observer (fact-index (assert (last))) (gensym) (random 1 1000000))"
EXPERIMENT = f"""name: looked
world: {ROOT}/worlds/arena.world
duration: DURATION
robots:
  - {{name: red, rules: {FOLLOWER}}}
  - {{name: blue, rules: {FOLLOWER}}}
observer:
  - {{at: 0, do: red, line: "(wander)"}}
  - {{at: 0, do: blue, line: "(follow red)"}}
  - {{at: 10, do: [red, blue], line: "{TOLD}"}}
  - {{at: LATE, do: [red, blue], line: "{TOLD}"}}
"""
SPINS = """
(deffunction spin (?n) (loop-for-count ?n (bind ?x 1)))
(defrule endless (position ?t $?) => (spin 3000000))
"""
TEXT = """
(defglobal ?*text* = "0123456789abcdef")
(deffunction grow () (loop-for-count 12 (bind ?*text* (str-cat ?*text* ?*text*))) TRUE)
"""


LOOKS = {"red": "(matches safe-following)", "observer": "(inspect robots)"}


class Person(threading.Thread):
    """Asks on a console, one line after the other, for as long as it lives."""

    def __init__(self, domain, *lines):
        super().__init__()
        self.lines, self.answers = lines, 0
        self.process = subprocess.Popen([MUSTER, "console", "red", "--domain", str(domain)],
                                        stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True)

    def run(self):
        try:
            while self.process.poll() is None:
                for line in self.lines + ("(my-name)",):
                    self.process.stdin.write(line + "\n")
                self.process.stdin.flush()
                for said in self.process.stdout:
                    if said == "red\n":
                        break
                self.answers += 1
        except BrokenPipeError:
            pass

    def end(self):
        self.process.terminate()
        self.join(10)
        self.process.wait(30)
        self.process.stdout.close()


def looked_run(out, file, whom, *words):
    """A run in which somebody looks all the time; gives its summary, and how often they looked."""
    domain = new_domain()
    with Processes() as processes:
        run = processes.start(MUSTER, "run", file, "--quiet", "--out", out, "--domain", domain, *words)
        wait_for(lambda: console(domain, "red", "(facts)").returncode == 0, 20, "an answer")
        people = [Person(domain, "(facts)", "(agenda)", "?*mate*"), Person(domain, "(rules)")]
        for person in people:
            person.start()
        looks = 0
        while run.poll() is None:
            done = muster("do", whom, LOOKS[whom], "--domain", domain)
            looks += done.returncode == 0 and "red: " in done.stdout
        for person in people:
            person.end()
        check_equal(run.returncode, 0, "the run")
    return json.loads((out / "summary.json").read_text()), looks + sum(p.answers for p in people)


def settled(summary):
    """The observer is outside of the run, and acknowledges what it is told by the clock."""
    mail = dict(summary["mail"])
    return {**summary, "mail": {**mail, "waiting": 0, "delivered": mail["delivered"] + mail["waiting"]}}


def test_a_run_that_is_looked_at_is_the_same_run():
    for rate, duration, whom in ((0, 600, "red"), (10, 60, "observer")):
        with folder() as out:
            (out / "t.yaml").write_text(EXPERIMENT.replace("DURATION", str(duration))
                                        .replace("LATE", str(duration - 5)))
            looked, looks = looked_run(out / "looked", out / "t.yaml", whom, "--rate", rate)
            check(looks > 10, f"{looks} looks at rate {rate}")
            done, alone = experiment_run(out / "alone", file=out / "t.yaml")
            check_equal(done.returncode, 0, done.stderr)
            # What is said to the observer is mail: that it looks then is not.
            for key in ("hash", "robots") + (("mail",) if whom == "red" else ()):
                check_equal(settled(looked)[key], settled(alone)[key], f"{key} at rate {rate}, {looks} looks")
            check(alone["robots"][0]["mail_sent"] > 2, "red told what it had come to")
            done = muster("verify", out / "looked" / "run.mcap", timeout=120)
            check_equal(done.returncode, 0, done.stdout + done.stderr)


def test_who_looks_in_free_running_is_answered_too():
    with folder() as out:
        (out / "t.yaml").write_text(EXPERIMENT.replace("DURATION", "12").replace("LATE", "11"))
        looked, looks = looked_run(out / "looked", out / "t.yaml", "red", "--free")
        check_equal(looked["hash"], "none", "the hash")
        check(looks > 10, f"{looks} looks")


def test_lines_are_done_in_their_order():
    lines, want = "", []
    for i in range(20):
        lines += f"?*mate*\n(bind ?*mate* robot-{i})\n?*mate*\n(my-name)\n"
        want += ["nil" if i == 0 else f"robot-{i - 1}"] + [f"robot-{i}"] * 2 + ["red"]
    with team("red") as (domain, _):
        done = piped(domain, "red", lines)
        check_equal((done.returncode, done.stdout.splitlines()), (0, want), "answers in order")


def test_a_word_that_rules_have_taken_goes_the_long_way():
    with folder() as out:
        (out / "t.clp").write_text("(defmethod my-name ((?x SYMBOL)) (assert (named ?x)) ?x)\n"
                                   "(deffunction here () 1)\n")
        with team("red", rules=out / "t.clp") as (domain, _):
            check_equal(answer(domain, "red", "(my-name)"), "red\n", "the engine's own")
            check_equal(answer(domain, "red", "(my-name me)"), "me\n", "the rules'")
            check("(named me)" in answer(domain, "red", "(facts)"), "which changed something")


def test_who_may_not_direct_may_not_look():
    with folder() as out:
        policy, audit = out / "team.policy", out / "audit.jsonl"
        policy.write_text("allow operator direct all\ndeny operator direct blue\n")
        domain = new_domain()
        with Processes() as processes:
            broker_start(processes, domain, "--policy", policy, "--audit", audit)
            for name in ("red", "blue"):
                processes.start(MUSTER, "robot", name, "--rules", FOLLOWER, "--domain", domain)
            wait_for(lambda: {"red", "blue"} <= set(members(domain)), 10, "robots")
            for name, code in (("red", 0), ("blue", 6)):
                check_equal(console(domain, name, "(facts)").returncode, code, f"console {name}")
                done = muster("do", name, "(facts)", "--domain", domain)
                check_equal(done.returncode, code, f"do {name}: {done.stderr}")
            done = muster("do", "red", "(facts)", "--json", "--domain", domain)
            said = json.loads(done.stdout)
            check_equal((said["from"], said["performative"]), ("red", "inform"), "as JSON")
            check("f-0" in said["content"], said["content"])
            done = muster("do", "red", "(facts nowhere)", "--domain", domain)
            check_equal(done.returncode, 8, f"a look that fails: {done.stdout}")
            wait_for(lambda: len(records(audit)) == 6, 5, "records")
            check_equal([(r["receiver"], r["performative"], r["line"], r["allowed"])
                         for r in records(audit)],
                        [("red", "glance", "(facts)", True)] * 2 +
                        [("blue", "do", "(facts)", False)] * 2 +
                        [("red", "glance", "(facts)", True),
                         ("red", "glance", "(facts nowhere)", True)], "the audit")


def test_a_mind_at_work_is_looked_at_when_it_is_through():
    with folder() as out:
        (out / "t.clp").write_text(TEXT)
        domain = new_domain()
        with Processes() as processes:
            broker_start(processes, domain)
            processes.start(MUSTER, "robot", "red", "--rules", out / "t.clp", "--domain", domain)
            wait_for(lambda: "red" in members(domain), 10, "red")
            answer(domain, "red", "(grow)")
            at_work = [processes.start(
                MUSTER, "console", "red", "--wait", 30, "--domain", domain, "-c",
                "(loop-for-count 20000 (str-length (str-cat ?*text* x)))") for _ in range(3)]
            wait_for(lambda: members(domain)["red"].get("reason"), 10, "it is busy")
            done = console(domain, "red", "(my-name)", "--wait", 30)
            check_equal((done.returncode, done.stdout), (0, "red\n"), done.stderr)
            check("[red is busy since " in done.stderr, f"why it takes so long: {done.stderr}")
            check_equal([line.wait(30) for line in at_work], [0, 0, 0], "the lines before")
        (out / "t.clp").write_text(SPINS)
        with team("red", rules=out / "t.clp", rate=0) as (domain, _):
            answer(domain, "red", "(run)")
            for _ in range(2):  # a guard stops the rule in each step
                done = console(domain, "red", "(facts)", "--wait", 30)  # which may say that it is busy
                check_equal(done.returncode, 0, done.stderr)
                check("(position " in done.stdout, f"between two steps: {done.stdout}")


def test_the_next_life_answers():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        red = processes.start(MUSTER, "robot", "red", "--rules", FOLLOWER, "--domain", domain)
        wait_for(lambda: "red" in members(domain), 10, "red")
        red.send_signal(signal.SIGSTOP)
        waits = processes.start(MUSTER, "console", "red", "--wait", 30, "-c", "(my-name)", "--domain",
                                domain, stdout=subprocess.PIPE, text=True)
        time.sleep(0.3)  # it has asked, most likely; if not, it waits all the same
        red.kill()
        red.wait()
        wait_for(lambda: state_of(domain, "red") == "absent", 10, "red is absent")
        processes.start(MUSTER, "robot", "red", "--rules", FOLLOWER, "--domain", domain)
        check_equal(waits.communicate(timeout=30)[0], "red\n", "the answer")
        check_equal(waits.returncode, 0, "the console")
