# SPDX-License-Identifier: Apache-2.0
"""New agents while a lock step goes on: clones and those that are launched, and their end."""
import json
import os
import pathlib
import signal
import subprocess
import time

from support import (MUSTER, ROOT, Processes, check, check_equal, child_of, experiment_run, folder, members, muster, new_domain,
                     wait_for)

# Says each step how many there were; who was cloned tells red each time that it hears of it.
RULES = """
(defglobal ?*n* = 0)
(defrule beat (position $?) => (bind ?*n* (+ ?*n* 1)) (broadcast beat ?*n*))
(defrule born (event on-clone) => (broadcast born (my-name)))
(defrule heard ?m <- (message beat ?n) => (retract ?m) (if (str-index "c_" (my-name)) then
  (send red heard ?n)))
(defrule refused (event refused clone ?who ?why) => (printout t "refused " (my-name) " " ?who " " ?why crlf))
"""
TEAM = """name: t
world: {root}/worlds/arena.world
duration: {duration}
{head}hosts: [north, south]
robots:
  - {{name: red, host: north, rules: red.clp}}
  - {{name: blue, rules: red.clp}}
"""


def team_write(out, rules="", more="", duration=4, head=""):
    """An experiment in a folder."""
    (out / "red.clp").write_text(RULES + rules)
    file = out / "t.yaml"
    file.write_text(TEAM.format(root=ROOT, duration=duration, head=head) + more)
    return file


def run_twice(out, file, code=0):
    """Two runs with one hash.  @return what the robots of one said, and its summary"""
    said, hashes, summary = "", set(), None
    for i in range(2):
        done = muster("run", file, "--out", out / str(i), "--domain", new_domain())
        check_equal(done.returncode, code, f"the run: {done.stderr}")
        summary = json.loads((out / str(i) / "summary.json").read_text())
        hashes.add(summary["hash"])
        said = done.stdout + done.stderr
    check_equal(len(hashes), 1, "hashes")
    return said, summary


def test_rules_and_commands_clone():
    """And launch.  Two want one name in the same step: the first in order of name gets it, wherever it
    lives."""
    with folder() as out:
        (out / "born.clp").write_text('(defrule born (event on-create) => (printout t "launched" crlf))')
        said, summary = run_twice(out, team_write(
            out, "(defrule one (position ?t $?) (test (= ?t 1.0)) => (clone c_1 south))",
            'observer:\n  - {at: 2, do: red, line: "(clone c_2 south)"}\n'
            '  - {at: 2.5, do: blue, line: "(clone c_2 north)"}\n'
            '  - {at: 3, do: red, line: "(clone c_3 nowhere)"}\n'
            '  - {at: 3, do: [north, south], launch: c_4, rules: born.clp}\n'), code=12)
        for line in ("c_4: launched", "south could not do c_4: name-taken", "red: refused red c_1 name-taken", "blue: refused blue c_2 name-taken",
                     "red: refused red c_3 unknown-host"):
            check(line in said, f"{line} is missing: {said}")
        red = next(r for r in summary["robots"] if r["name"] == "red")
        # blue's 39 beats, and what each clone makes of red's and blue's, for 2.8 and for 1.8 s
        check(red["mail_received"] > 39 + 2 * 27 + 2 * 17, f"red has had {red['mail_received']} mails")
        check_equal((summary["mail"]["lost"], summary["mail"]["duplicated"]), (0, 0), "mail")
        done = muster("verify", out / "0/run.mcap")
        check_equal((done.returncode, summary["hash"] in done.stdout), (0, True), done.stdout + done.stderr)


def test_without_a_body_in_free_running():
    """The same agent lives through the steps there, too."""
    with folder() as out:
        (out / "born.clp").write_text('(defrule born (event on-create) => (broadcast hello))\n'
                                      '(defrule heard (message beat ?n) => '
                                      '(printout t "heard " ?n crlf))')
        file = team_write(out, more="observer:\n  - {at: 0.5, do: south, launch: c_1, rules: born.clp}\n")
        with Processes() as processes, open(out / "said", "w+") as said:
            run = processes.start(MUSTER, "run", file, "--free", "--duration", 60, "--out", out / "run",
                                  "--domain", new_domain(), stdout=said, stderr=said)
            wait_for(lambda: "c_1: heard" in (out / "said").read_text(), 30, "what it heard")
            run.send_signal(signal.SIGINT)
            check_equal(run.wait(30), 130, (out / "said").read_text())


class Live:
    """A run at six times real time in which somebody has a hand."""

    def __init__(self, processes, out, file, *words):
        self.domain, self.out = new_domain(), out
        self.run = processes.start(MUSTER, "run", file, "--quiet", "--rate", 6, "--out", out / "run",
                                   "--domain", self.domain, *words, stderr=subprocess.PIPE, text=True)
        wait_for(lambda: muster("console", "observer", "-c", "(agents)", "--domain",
                                self.domain).returncode == 0, 15, "a run")
        wait_for(lambda: self.state("red") == "running", 10, "red")

    def state(self, name):
        return members(self.domain).get(name, {"state": None})["state"]

    def muster(self, *words):
        return muster(*words, "--domain", self.domain)

    def done(self, *words):
        done = self.muster(*words)
        check_equal(done.returncode, 0, f"muster {' '.join(map(str, words))}: {done.stdout} {done.stderr}")
        return done.stdout

    def refused(self, code, why, *words):
        done = self.muster(*words)
        check_equal((done.returncode, why in done.stdout + done.stderr), (code, True),
                    f"muster {' '.join(map(str, words))}: {done.stdout} {done.stderr}")

    def verify(self):
        """Awaits the end of the run, and does it again."""
        error = self.run.communicate(timeout=60)[1]
        check_equal(self.run.returncode, 0, f"the run: {error}")
        done = muster("verify", self.out / "run/run.mcap")
        check_equal(done.returncode, 0, f"verify: {done.stdout} {done.stderr}")
        summary = json.loads((self.out / "run/summary.json").read_text())
        check(f"hash   {summary['hash']}" in done.stdout, f"another hash: {done.stdout}")


def test_a_person_launches_clones_and_disposes():
    """What a person does is outside input, the rules of one that is launched with it; the run can be
    verified.  A name is free again when its agent is disposed of."""
    with folder() as out, Processes() as processes:
        live = Live(processes, out, team_write(out, duration=60))
        rules = out / "c_2.clp"
        rules.write_text('(extends "red.clp")\n(deffacts f (launched well))\n' +
                         "".join(f"(defrule r{i} (never {i}) => (printout t \"{'x' * 200}\" crlf))\n"
                                 for i in range(400)))
        text = (out / "red.clp").read_text() + rules.read_text().replace('(extends "red.clp")\n', "")
        rules.write_text(text)
        check_equal(live.done("clone", "red", "c_1", "south"), "c_1 at south\n", "the answer")
        check_equal(live.state("c_1"), "running", "its state")
        check_equal(live.done("launch", "c_2", "south", "--rules", rules, "--start", "--quiet"),
                    "south: c_2 at south\n", "the answer")
        check("(launched well)" in live.done("do", "c_2", "(facts)"), "its facts")
        check("(position" not in live.done("do", "c_1", "(facts)"), "it has no body")
        live.refused(6, "name-taken", "clone", "blue", "c_2", "south")
        live.refused(6, "name-taken", "launch", "c_1", "north", "--rules", rules)
        rules.write_text("(defrule broken (a) => (nonsense))")
        live.refused(8, "nonsense", "launch", "c_3", "north", "--rules", rules)
        check("c_3" not in members(live.domain), "who could not be made is in the pages")
        live.done("move", "c_1", "north")
        live.done("dispose", "c_1")
        wait_for(lambda: live.state("c_1") == "absent", 10, "the end of c_1")
        check_equal(live.done("clone", "blue", "c_1", "north"), "c_1 at north\n", "the name again")
        live.done("dispose", "blue")
        wait_for(lambda: live.state("blue") == "absent", 10, "the end of blue")
        check_equal(live.done("clone", "c_2", "blue", "south"), "blue at south\n", "a free body")
        x = "(nth$ 2 (position))"
        check("." in live.done("do", "blue", x), "it feels its body")
        live.verify()


# --- who dies ------------------------------------------------------------------------------------

RESTARTS = "on-crash: restart\ncheckpoint: 0.1\n"


def chaos_is_calm(out, file, chaos):
    """The same run with and without deaths: one hash.  @return what the second one said"""
    calm, wild = out / "calm", out / "wild"
    done, summary = experiment_run(calm, "--domain", new_domain(), file=file)
    check_equal(done.returncode, 0, f"the calm run: {done.stderr}")
    file.write_text(file.read_text() + chaos)
    done, wild_summary = experiment_run(wild, "--domain", new_domain(), file=file)
    check_equal(done.returncode, 0, f"the run with deaths: {done.stderr}")
    check_equal(wild_summary["hash"], summary["hash"], f"the hash; it said: {done.stderr}")
    return done.stderr


def test_who_was_disposed_of_stays_so():
    """One whose process dies afterwards; one that shares its process with one that lives on; and one that
    has moved on does not begin anew either."""
    with folder() as out:
        file = team_write(out, head=RESTARTS, more=(
            "  - {name: w, rules: red.clp, count: 2, processes: 1, body: pioneer, place: random}\n"
            "  - {name: yellow, rules: red.clp, body: pioneer, place: random}\n"
            "observer:\n  - {at: 1, do: blue, line: (dispose)}\n  - {at: 1.5, do: w_0, line: (dispose)}\n"
            "  - {at: 1.5, do: yellow, move: south}\n"))
        said = chaos_is_calm(out, file, "chaos:\n  - {at: 2, kill: blue}\n  - {at: 2, kill: w_0}\n  - {at: 2, kill: yellow}\n")
        check("blue was killed by signal 9" in said, said)


def test_a_host_with_clones_comes_back():
    with folder() as out:
        file = team_write(out, "(defrule one (position ?t $?) (test (= ?t 1.0)) => (clone c_1 south))",
                          head=RESTARTS)
        said = chaos_is_calm(out, file, "chaos:\n  - {at: 2, kill: south}\n  - {at: 2, kill: north}\n")
        check("south was killed by signal 9" in said, said)


# It is at work for a second or so before it wants to go, if it does that some thousand times.
MOVER = """
(defglobal ?*text* = "abcdefghijklmnop")
(deffunction grow () (loop-for-count 12 (bind ?*text* (str-cat ?*text* ?*text*))))
(defrule away (position ?t $?) (test (and (= ?t 2.0) (eq ?*my-name* %s))) =>
  (printout t "going" crlf) (grow) (loop-for-count %d (str-length (str-cat ?*text* x))) (bind ?*text* "") (moveTo south))
"""


def target_dies(out, checkpoint):
    """The host to which red moves has said that it is ready, and has the name; it is killed before it has
    lived through a step: the simulator stands still meanwhile.  If that has not sent the step to all the
    others by then, red waits for them, and the run gives up after five seconds.  @return the summary"""
    for _ in range(3):
        if target_dies_once(out, checkpoint):
            return json.loads((out / "run/summary.json").read_text())
    raise AssertionError("red came to south in none of three runs")


def target_dies_once(out, checkpoint):
    """@return whether it came to that"""
    file = team_write(out, MOVER % ("red", 2500), head=f"on-crash: restart\ncheckpoint: {checkpoint}\n")
    with Processes() as processes:
        domain = new_domain()
        run = processes.start(MUSTER, "run", file, "--rate", 5, "--out", out / "run", "--domain", domain,
                              stderr=subprocess.PIPE, text=True)
        south, simulator = child_of(run, "muster-host", "south"), child_of(run, "muster-sim")
        wait_for(lambda: "going" in run.stderr.readline(), 20, "red at work")
        os.kill(simulator, signal.SIGSTOP)
        try:
            wait_for(lambda: members(domain)["red"]["pid"] == south, 4, "red at south")
        except AssertionError:
            if run.poll() is None:
                raise
            return False
        os.kill(south, signal.SIGKILL)
        os.kill(simulator, signal.SIGCONT)
        error = run.communicate(timeout=60)[1]
        check_equal(run.returncode, 0, f"the run: {error}")
    return True


def is_idle(pid):
    """Whether a process computes nothing for a while, and does not wait for a processor either."""
    def look():
        fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()
        return fields[0], sum(map(int, fields[11:13]))
    before = look()
    time.sleep(0.2)
    after = look()
    return before[0] == after[0] == "S" and after[1] - before[1] <= 1


def source_dies(out, file, name, source):
    """An agent is handed in and its host, south, stopped, so that the clock waits for that; meanwhile the process
    that it leaves dies, and is let go of.  @return the summary, and what the run said"""
    with Processes() as processes:
        domain = new_domain()
        run = processes.start(MUSTER, "run", file, "--rate", 5, "--out", out / "run", "--domain", domain,
                              stderr=subprocess.PIPE, text=True)
        south, dies = child_of(run, "muster-host", "south"), child_of(run, *source)
        wait_for(lambda: f"{name}: going" in run.stderr.readline(), 20, f"{name} at work")
        time.sleep(0.1)  # south has answered this step long ago
        os.kill(south, signal.SIGSTOP)
        wait_for(lambda: is_idle(dies), 20, f"{name} handed in")
        os.kill(dies, signal.SIGKILL)
        time.sleep(1.5)  # so that it is missed, and let go of
        os.kill(south, signal.SIGCONT)
        error = run.communicate(timeout=60)[1]
        check_equal(run.returncode, 0, f"the run: {error}")
    return json.loads((out / "run/summary.json").read_text()), error


def test_a_source_dies_when_its_robot_has_been_handed_in():
    """The robot goes on, once, from its checkpoint."""
    with folder() as out:
        done, calm = experiment_run(out / "calm", "--domain", new_domain(), file=team_write(out, MOVER % ("blue", 1)))
        check_equal(done.returncode, 0, done.stderr)
        file = team_write(out, MOVER % ("blue", 2500), head=RESTARTS)
        summary, error = source_dies(out, file, "blue", ("muster-robot", "blue"))
        check_equal(summary["hash"], calm["hash"], f"the hash: {error}")


# A clone on north, which is told when it is time, and has no checkpoint.
GUEST = """
(defglobal ?*text* = "abcdefghijklmnop" ?*n* = 0)
(deffunction grow () (loop-for-count 12 (bind ?*text* (str-cat ?*text* ?*text*))))
(defrule one (position ?t $?) (test (= ?t 1.0)) => (clone c_1 north))
(defrule beat (position $?) => (bind ?*n* (+ ?*n* 1)) (broadcast beat ?*n*))
(defrule away (message beat 20) (test (eq (my-name) c_1)) => (printout t "going" crlf) (grow)
  (loop-for-count %d (str-length (str-cat ?*text* x))) (bind ?*text* "") (moveTo south))
(defrule heard (message beat 38) (test (eq (my-name) c_1)) => (printout t "hears 38" crlf))
"""


def test_a_source_dies_when_its_only_copy_has_been_handed_in():
    """Nobody else has the agent.  It goes on, once: at the target, or, when that has been silent for too long,
    on the host that it left, which has been started again."""
    with folder() as out:
        (out / "blue.clp").write_text(GUEST % 2500)
        (out / "t.yaml").write_text(f"name: t\nworld: {ROOT}/worlds/arena.world\nduration: 4\non-crash: restart\n"
                                    "checkpoint: 0\nhosts: [north, south]\n"
                                    "robots:\n  - {name: blue, rules: blue.clp}\n")
        _, error = source_dies(out, out / "t.yaml", "c_1", ("muster-host", "north"))
        check_equal(error.count("c_1: hears 38"), 1, f"its last words: {error}")


def test_a_target_dies_with_the_name():
    """It is started again, and the agent lives there, once: nobody writes checkpoints, but the broker has
    kept the capsule."""
    with folder() as out:
        done, calm = experiment_run(out / "calm", "--domain", new_domain(), file=team_write(out, MOVER % ("red", 1)))
        check_equal(done.returncode, 0, done.stderr)
        summary = target_dies(out, 0)
        check_equal(summary["restarts"], [{"process": "south", "count": 1}], "who was started again")
        check_equal(summary["hash"], calm["hash"], "the hash")
