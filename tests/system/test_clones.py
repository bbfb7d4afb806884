# SPDX-License-Identifier: Apache-2.0
"""New agents while a lock step goes on: clones and those that are launched, and their end."""
import json
import subprocess

from support import (MUSTER, ROOT, Processes, check, check_equal, folder, members, muster, new_domain,
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
hosts: [north, south]
robots:
  - {{name: red, host: north, rules: red.clp}}
  - {{name: blue, rules: red.clp}}
"""


def team_write(out, rules="", more="", duration=4):
    """An experiment in a folder."""
    (out / "red.clp").write_text(RULES + rules)
    file = out / "t.yaml"
    file.write_text(TEAM.format(root=ROOT, duration=duration) + more)
    return file


def run_twice(out, file):
    """Two runs with one hash.  @return what the robots of one said, and its summary"""
    said, hashes, summary = "", set(), None
    for i in range(2):
        done = muster("run", file, "--out", out / str(i), "--domain", new_domain())
        check_equal(done.returncode, 0, f"the run: {done.stderr}")
        summary = json.loads((out / str(i) / "summary.json").read_text())
        hashes.add(summary["hash"])
        said = done.stdout + done.stderr
    check_equal(len(hashes), 1, "hashes")
    return said, summary


def test_rules_and_commands_clone():
    """Two want one name in the same step: the first in order of name gets it, wherever it lives."""
    with folder() as out:
        said, summary = run_twice(out, team_write(
            out, "(defrule one (position ?t $?) (test (= ?t 1.0)) => (clone c_1 south))",
            'observer:\n  - {at: 2, do: red, line: "(clone c_2 south)"}\n'
            '  - {at: 2.5, do: blue, line: "(clone c_2 north)"}\n'
            '  - {at: 3, do: red, line: "(clone c_3 nowhere)"}\n'))
        for line in ("red: refused red c_1 name-taken", "blue: refused blue c_2 name-taken",
                     "red: refused red c_3 unknown-host"):
            check(line in said, f"{line} is missing: {said}")
        red = next(r for r in summary["robots"] if r["name"] == "red")
        # blue's 39 beats, and what each clone makes of red's and blue's, for 2.8 and for 1.8 s
        check(red["mail_received"] > 39 + 2 * 27 + 2 * 17, f"red has had {red['mail_received']} mails")
        check_equal((summary["mail"]["lost"], summary["mail"]["duplicated"]), (0, 0), "mail")


class Live:
    """A run at five times real time in which somebody has a hand."""

    def __init__(self, processes, out, file, *words):
        self.domain, self.out = new_domain(), out
        self.run = processes.start(MUSTER, "run", file, "--quiet", "--rate", 5, "--out", out / "run",
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

    def refused(self, why, *words):
        done = self.muster(*words)
        check_equal((done.returncode, why in done.stdout + done.stderr), (8, True),
                    f"muster {' '.join(map(str, words))}: {done.stdout} {done.stderr}")

    def verify(self):
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
        live = Live(processes, out, team_write(out, duration=30))
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
        live.refused("name-taken", "clone", "blue", "c_2", "south")
        live.refused("name-taken", "launch", "c_1", "north", "--rules", rules)
        rules.write_text("(defrule broken (a) => (nonsense))")
        live.refused("nonsense", "launch", "c_3", "north", "--rules", rules)
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
