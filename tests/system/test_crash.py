# SPDX-License-Identifier: Apache-2.0
"""Controllers that are killed, and started again from their checkpoints."""
import contextlib
import json
import os
import pathlib
import signal
import subprocess
import time

from support import (FOLLOW, MUSTER, ROOT, Processes, broker_start, check, check_equal, children_of, experiment_run,
                     folder, members, muster, new_domain, pair_run, preload, wait_for)

RESTART = ("--set", "on-crash=restart")
EACH_STEP = ("--set", "checkpoint=0.1")


def words_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_text().split("\0")
    except OSError:
        return []


class Run:
    """An experiment that goes on while the test does something to its processes."""

    def __init__(self, processes, out, *words, file=FOLLOW, env=None):
        self.out, self.domain = out / "run", new_domain()
        self.said = out / "said"
        with open(self.said, "w", encoding="utf-8") as said:
            self.process = processes.start(MUSTER, "run", file, "--quiet", "--out", self.out, "--domain", self.domain,
                                           *words, stderr=said, env={**os.environ, **(env or {})})

    def child(self, name):
        """The process id of the child that is started with this first word; None: there is none."""
        for pid in children_of(self.process.pid):
            if words_of(pid)[1:2] == [name]:
                return pid
        return None

    def saved_step(self, name):
        """The step that a robot's checkpoint is of; -1: there is none."""
        try:
            text = (self.out / "checkpoints" / f"{name}.capsule").read_text()
        except OSError:
            return -1
        return int(text.split(maxsplit=3)[2])

    def reach(self, name, step):
        wait_for(lambda: self.saved_step(name) >= step, 20, f"step {step} of {name}")

    def kill(self, name):
        """@return the process id of the successor"""
        pid = self.child(name)
        os.kill(pid, signal.SIGKILL)
        return wait_for(lambda: self.child(name) not in (None, pid) and self.child(name), 20, f"another {name}")

    def end(self, code=0):
        got = self.process.wait(60)
        check_equal(got, code, f"the exit code; it said: {self.said.read_text()}")
        summary = self.out / "summary.json"
        return json.loads(summary.read_text()) if summary.exists() else None


@contextlib.contextmanager
def run(*words, **kwargs):
    with folder() as out, Processes() as processes:
        yield Run(processes, out, *words, **kwargs)


def test_neither_a_kill_nor_a_stop_changes_the_run():
    words = ("--set", "duration=25")
    with folder() as out:
        done, summary = experiment_run(out / "calm", *words)
        check_equal(done.returncode, 0, done.stderr)
    with run("--rate", "5", *RESTART, *EACH_STEP, *words) as r:
        r.reach("red", 30)
        r.kill("red")
        r.reach("red", 100)
        blue = r.child("blue")
        os.kill(blue, signal.SIGSTOP)  # it is silent, and nobody takes its place
        time.sleep(1.2)
        os.kill(blue, signal.SIGCONT)
        crashed = r.end()
        said = r.said.read_text()
        check_equal(crashed["hash"], summary["hash"], "the hash")
        check_equal(crashed["restarts"], [{"process": "red", "count": 1}], f"restarts: {said}")
        check("red was killed by signal 9" in said and "red is started again in 0.5 s (1 of 5)" in said, said)
        check(crashed["robots"] == summary["robots"], "what the robots did")
        verified = muster("verify", r.out / "run.mcap")
        check_equal(verified.returncode, 0, f"verify: {verified.stdout}{verified.stderr}")


def test_who_has_come_back_keeps_the_answer_of_its_last_life():
    """It writes a checkpoint before it has a step.  If it dies then, the life after it says that answer."""
    with run(*RESTART, *EACH_STEP, "--set", "duration=2") as r, Processes() as processes:
        r.end()
        saved = r.out / "checkpoints" / "red.capsule"
        kept = saved.read_text().splitlines()[:3]
        check(kept[0] == "checkpoint 1 19" and kept[1].startswith("answer 1 "), f"step and answer: {kept}")
        written = saved.stat().st_mtime_ns
        domain = new_domain()
        broker_start(processes, domain)
        processes.start(MUSTER, "robot", "red", "--rules", ROOT / "rules/follower.clp", "--domain", domain,
                        "--checkpoint", "0.1", "--folder", saved.parent, "--restore")
        wait_for(lambda: saved.stat().st_mtime_ns != written, 20, "a checkpoint of the next life")
        check_equal(saved.read_text().splitlines()[:3], kept, "step and answer")


TALKS = """
(defglobal ?*heard* = 0)
(defrule speak (position $?) => (setSpeed 100 0) (broadcast here ?*heard*) (send nosuch n ?*heard*)
  (send near:3 near ?*heard*) (update-sensors))
(defrule comes-back (declare (salience 9)) ?e <- (event refused send $?) => (retract ?e) (setSpeed 50 5))
(defrule arrives (declare (salience 9)) ?e <- (event on-arrive) => (retract ?e) (bind ?*heard* 1000))
(defrule hears (declare (salience 9)) (message here $?) => (bind ?*heard* (+ ?*heard* 1)))
(defrule is-near (declare (salience 9)) (message near $?) => (bind ?*heard* (+ ?*heard* 7)))
"""


def test_who_dies_between_two_packets_has_said_all_or_nothing():
    """An answer to a step goes to the broker and to the simulator in a packet each.  What the broker
    says to its mail comes with the mail of the step, once, whoever lives then.  A resolver is shown
    the world of the step in which it was asked."""
    with folder() as out:
        (out / "talks.clp").write_text(TALKS)
        file = out / "team.yaml"
        file.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 60\nresolvers: [near]\nrobots:\n" + "".join(
            f"  - {{name: {name}, rules: talks.clp}}\n" for name in ("red", "blue", "green", "yellow")))
        done, calm = experiment_run(out / "calm", file=file)
        check_equal(done.returncode, 0, done.stderr)
        env = {"LD_PRELOAD": preload("dies_sending"), "DIES_FOLDER": str(out)}
        for lives in ({"red": (301, 302, 303), "blue": (304, 305, 306), "green": (307, 308, 309),
                       "yellow": (310, 311, 312)}, {"near": (301, 302, 303, 304, 305)}):
            for name, packets in lives.items():
                (out / name).write_text("".join(f"{n}\n" for n in packets))
            with run(*RESTART, *EACH_STEP, file=file, env=env) as r:
                crashed, said = r.end(), r.said.read_text()
            check_equal({s["process"].split(".")[-1]: s["count"] for s in crashed["restarts"]},
                        {name: len(packets) for name, packets in lives.items()}, f"restarts: {said}")
            check_equal(crashed["hash"], calm["hash"], f"the hash, as {list(lives)} died")
            for robot, other in zip(crashed["robots"], calm["robots"]):
                for count in ("rule_firings", "mail_sent"):
                    check_equal(robot[count], other[count], f"{count} of {robot['name']}, as {list(lives)} died")


def test_who_comes_back_by_itself_survives_chaos():
    with folder() as out:
        comes_back = "on-crash: restart\ncheckpoint: 0.1\n"
        chaos = "chaos:\n  - {at: 5, kill: red}\n  - {at: 10, kill: blue}\n"
        _, first = pair_run(out, "calm", comes_back, duration_s=20)
        done, second = pair_run(out, "wild", comes_back + chaos, duration_s=20)
        check_equal(done.returncode, 0, done.stderr)
        check_equal(second["hash"], first["hash"], "the hash")
        check_equal([s["process"] for s in second["restarts"]], ["red", "blue"], "who came back")


COUNTS = """
(defglobal ?*n* = 0)
(defrule count (position $?) => (bind ?*n* (+ ?*n* 1)) (setSpeed 50 0) (broadcast n ?*my-name* ?*n*) (update-sensors))
"""


def crew_file(out, more=""):
    (out / "count.clp").write_text(COUNTS)
    path = out / "crew.yaml"
    path.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 30\n{more}\nrobots:\n"
                    "  - {name: w, body: pioneer, place: random, count: 4, processes: 2, rules: count.clp}\n")
    return path


def test_the_robots_of_a_process_come_back_together():
    with folder() as out:
        with run("--rate", "5", *RESTART, "--set", "checkpoint=1", file=crew_file(out, "resolvers: [near]")) as r:
            r.reach("w_0", 20)
            r.kill("w")
            r.kill("near")
            r.reach("w_0", r.saved_step("w_0") + 20)
            pages = members(r.domain)
            alive = [m for m in pages.values() if m["name"].startswith("w_")]
            check_equal(sorted(m["name"] for m in alive), ["w_0", "w_1", "w_2", "w_3"], "the agents")
            check(all(m["state"] == "running" for m in alive), f"their states: {alive}")
            check_equal(len({m["pid"] for m in alive}), 2, "their processes")
            summary = r.end()
            check_equal([s["count"] for s in summary["restarts"]], [1, 1], "restarts")
            # A second was lost at most, and done again.
            check(all(r["rule_firings"] >= 290 for r in summary["robots"]), f"{summary['robots']}")


def test_in_free_running_a_broker_comes_back_too():
    with run("--free", *RESTART, *EACH_STEP, "--set", "duration=15") as r:
        r.reach("red", 10)
        r.kill("main")
        r.kill("red")
        wait_for(lambda: all(members(r.domain).get(name, {}).get("state") == "running"
                             for name in ("red", "blue", "green", "yellow")), 10, "everybody")
        summary = r.end()
        check_equal({s["process"]: s["count"] for s in summary["restarts"]}, {"broker": 1, "red": 1}, "restarts")


def test_who_dies_again_and_again_is_given_up():
    with run("--rate", "10", *RESTART, *EACH_STEP, "--set", "restarts=1") as r:
        r.reach("red", 10)
        r.kill("red")
        r.reach("red", r.saved_step("red") + 5)
        os.kill(r.child("red"), signal.SIGKILL)
        r.end(5)
        said = r.said.read_text()
        check("red has been started again 1 times: no more" in said, said)


def test_one_robot_may_not_die():
    with run("--rate", "10", *RESTART, *EACH_STEP, "--set", "robots.blue.on-crash=stop") as r:
        r.reach("red", 10)
        os.kill(r.child("blue"), signal.SIGKILL)
        r.end(5)
        check("started again" not in r.said.read_text(), "it was to end the run")


def test_without_checkpoints_a_robot_begins_anew():
    with run("--rate", "2", *RESTART, "--set", "checkpoint=0", "--set", "duration=15") as r:
        wait_for(lambda: members(r.domain).get("red", {}).get("state") == "running", 10, "red")
        r.kill("red")
        wait_for(lambda: members(r.domain)["red"]["state"] == "running"
                 and members(r.domain)["red"]["pid"] == r.child("red"), 10, "red again")
        r.end()


# --- without an experiment ----------------------------------------------------------------------


class Robot:
    """A robot with a broker alone, which nobody but the test starts again."""

    def __init__(self, processes, out, name="red"):
        self.processes, self.out, self.name, self.domain = processes, out, name, new_domain()
        (out / "red.clp").write_text('(defglobal ?*n* = 0 ?*got* = "")\n(deffacts f (kept 1.5))\n')
        broker_start(processes, self.domain)
        self.start()

    def start(self, *words):
        with open(self.out / "said", "a", encoding="utf-8") as said:
            self.process = self.processes.start(MUSTER, "robot", self.name, "--rules", self.out / "red.clp", "--domain",
                                                self.domain, "--checkpoint", 0.1, "--folder", self.out, *words,
                                                stderr=said)
        wait_for(lambda: self.page().get("pid") == self.process.pid and self.page()["state"] != "moving", 10, self.name)

    def page(self):
        return members(self.domain).get(self.name, {})

    def muster(self, *words):
        done = muster(*words, "--domain", self.domain)
        check_equal(done.returncode, 0, f"{words}: {done.stderr}")
        return done.stdout.strip()

    def ask(self, line):
        return self.muster("do", self.name, line).split(": ", 1)[1].strip()

    def saved(self, text):
        path = self.out / f"{self.name}.capsule"
        wait_for(lambda: path.exists() and text in path.read_text(), 10, f"{text} on disk")

    def die(self):
        self.process.kill()
        self.process.wait()
        wait_for(lambda: self.page()["state"] == "absent", 10, "its end")


@contextlib.contextmanager
def robot():
    with folder() as out, Processes() as processes:
        yield Robot(processes, out)


def test_a_robot_comes_back_as_it_was():
    with robot() as r:
        r.ask("(bind ?*n* 17)")
        r.saved('y"n" one i17')
        r.die()
        r.muster("send", "red", "are-you", "there")  # its mail waits
        (r.out / ".red.capsule").write_text("checkpoint 1 half a file")  # it died while it wrote one
        r.start("--restore")
        check_equal(r.page()["state"], "standby", "its state")
        check_equal(r.ask("?*n*"), "17", "a global")
        check("(kept 1.5)" in r.ask("(facts)"), "a fact is lost")
        wait_for(lambda: "(message are-you there)" in r.ask("(facts)"), 10, "the mail that waited")
        r.muster("start", "red")
        r.muster("suspend", "red")
        wait_for(lambda: r.page()["state"] == "suspended", 10, "its suspension")
        r.die()
        r.start("--restore")
        check_equal(r.page()["state"], "suspended", "its state")
        r.die()
        text = (r.out / "red.capsule").read_text()
        (r.out / "red.capsule").write_text(text[:-20] + "x" + text[-19:])
        r.start("--restore")
        check("checkpoint-refused" in (r.out / "said").read_text(), "a damaged file is not named")
        check_equal((r.page()["state"], r.ask("?*n*")), ("standby", "0"), "it began anew")
        for text, word in (("garbage\n", "checkpoint-refused"), (None, "checkpoint-missing")):
            r.die()
            (r.out / "red.capsule").unlink()
            if text:
                (r.out / "red.capsule").write_text(text)
            (r.out / "said").write_text("")
            r.start("--restore")
            check(word in (r.out / "said").read_text(), f"{word}: {(r.out / 'said').read_text()}")
        r.die()
        done = muster("do", "red", "(now)", "--wait", 1, "--domain", r.domain)
        check_equal((done.returncode, "red is absent" in done.stderr), (124, True), done.stderr)


def test_what_was_acknowledged_is_on_disk():
    """The file is written before the broker hears that a mail was taken, if the state has changed."""
    with robot() as r:
        for _ in range(2):
            r.muster("start", "red")
            r.process.kill()
            r.process.wait()
            wait_for(lambda: r.page()["state"] == "absent", 10, "its end")
            r.start("--restore")
            wait_for(lambda: r.page()["state"] == "running", 10, "that it runs")
            r.muster("suspend", "red")
            wait_for(lambda: r.page()["state"] == "suspended", 10, "its suspension")
            r.muster("resume", "red")


# Facts that are compared with each other, in the engine alone, for hours.
KILLS = ("(defrule compares (m 1 ?x) (m ?k ?y) (m ? ?z) (n ?n&~?k ?) =>) "
         "(loop-for-count (?i 30000) (assert (n 1 ?i))) (loop-for-count (?i 100) (assert (m 1 ?i)))")


def test_a_line_of_which_a_robot_has_died_twice_is_set_aside():
    with robot() as r, Processes() as processes:
        lines = r.out / "red.lines"
        sent = processes.start(MUSTER, "do", "red", KILLS, "--wait", 60, "--domain", r.domain,
                               stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        for lives in (0, 1):
            wait_for(lambda: lines.exists() and f" {lives} 1 (def" in lines.read_text(), 20,
                     "that it is at hand")
            r.die()
            r.start("--restore")
        out, _ = sent.communicate(timeout=60)
        check_equal((sent.returncode, "set aside" in out), (8, True), out)
        check("line-set-aside" in (r.out / "said").read_text(), "what the log says")
        check(KILLS[:40] in r.ask("(set-aside)"), r.ask("(set-aside)"))
        check_equal(r.ask("(+ 1 1)"), "2", "another line")
        r.die()
        r.start("--restore")
        check(KILLS[:40] in r.ask("(set-aside)"), "the next life knows it, too")
        check_equal([r.ask(f"(drop-aside {n})") for n in (2, 1, 1)], ["FALSE", "TRUE", "FALSE"], "drops")
        check_equal((r.ask("(set-aside)"), lines.exists()), ("()", False), "what is left")
