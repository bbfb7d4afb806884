#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Some hundred kills of controllers, resolvers and brokers at random instants, in lock step and in free
running.  Every run ends well, everybody is there once after each kill, runs with a checkpoint each
step have the hash of the run in which nobody died, and no mail that was acknowledged is missing where
docs/crashes.md says so.  `make soak-crash`, or tests/soak/crash.py SEED.
"""
import pathlib
import random
import statistics
import sys
import time

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "support" / "system"), str(TESTS / "system")]
from support import (COUNTS, ROOT, SENDS, Processes, check, check_equal, experiment_run,  # noqa: E402
                     folder, members, muster, preload, wait_for)
from test_crash import EACH_STEP, RESTART, Run, crew_file  # noqa: E402

MANY = ("--set", "restarts=100")
TEAM = ("red", "blue", "green", "yellow")

NEAR = """
(defglobal ?*n* = 0)
(defrule speak (position $?) => (setSpeed 200 ?*n*) (send near:2 n ?*n*) (update-sensors))
(defrule hears (declare (salience 9)) (message n $?) => (bind ?*n* (+ ?*n* 1)))
"""


class Soak:
    def __init__(self, seed, processes, out):
        self.dice, self.processes, self.out = random.Random(seed), processes, out
        self.kills, self.runs, self.back_s = 0, 0, []

    def run(self, *words, **kwargs):
        self.runs += 1
        return Run(self.processes, self.folder(), *RESTART, *MANY, *words, **kwargs)

    def folder(self):
        path = self.out / str(self.runs)
        path.mkdir()
        return path

    def kill(self, run, process, agents):
        """Kills one at a random instant, and waits until its agents are there again, once each."""
        time.sleep(self.dice.uniform(0, 0.7))
        began = time.monotonic()
        pid = run.kill(process)
        self.kills += 1
        if agents:
            wait_for(lambda: self.lives(run, agents, pid), 30, f"{agents} again")
            self.back_s.append(time.monotonic() - began)

    @staticmethod
    def lives(run, agents, pid):
        """@return whether all of them live in that process; the pages name nobody twice"""
        done = muster("ps", "--json", "--domain", run.domain)
        if done.returncode != 0:
            return False
        pages = members(run.domain)
        return all(pages.get(a, {}).get("pid") == pid and pages[a]["state"] in ("standby", "running") for a in agents)

    def kills_change_nothing(self):
        """In lock step, with a checkpoint each step."""
        words = ("--set", "duration=60")
        done, calm = experiment_run(self.folder_named("calm"), *words)
        check_equal(done.returncode, 0, done.stderr)
        for rate in ("10", "20", "0", "0", "10", "20"):
            long = ("--set", "duration=600") if rate == "0" else words
            run = self.run("--rate", rate, *EACH_STEP, *long)
            run.reach("red", 1)
            for _ in range(4):
                name = self.dice.choice(TEAM)
                self.kill(run, name, (name,))
            crashed = run.end()
            wanted = calm["hash"] if rate != "0" else self.long_hash()
            check_equal(crashed["hash"], wanted, f"the hash at rate {rate}; {run.said.read_text()}")

    def between_two_packets(self):
        """In lock step, with a checkpoint each step: each life ends behind a packet of its own."""
        words = ("--set", "duration=60")
        done, calm = experiment_run(self.folder_named("calm60"), *words)
        check_equal(done.returncode, 0, done.stderr)
        for _ in range(6):
            lives = self.folder_named(f"lives{self.runs}")
            lives.mkdir()
            for name in TEAM:
                (lives / name).write_text("".join(f"{self.dice.randrange(150, 600)}\n" for _ in range(3)))
            run = self.run(*EACH_STEP, *words, env={"LD_PRELOAD": preload("dies_sending"), "DIES_FOLDER": str(lives)})
            crashed = run.end()
            self.kills += sum(r["count"] for r in crashed["restarts"])
            check_equal(crashed["hash"], calm["hash"], f"the hash; {run.said.read_text()}")

    def long_hash(self):
        if not hasattr(self, "_long"):
            done, summary = experiment_run(self.folder_named("long"), "--set", "duration=600")
            check_equal(done.returncode, 0, done.stderr)
            self._long = summary["hash"]
        return self._long

    def folder_named(self, name):
        return self.out / name

    def crews(self):
        for _ in range(2):
            run = self.run("--rate", "4", "--set", "checkpoint=1", file=crew_file(self.folder_named("."), ""))
            run.reach("w_0", 1)
            for _ in range(3):
                self.kill(run, "w", ())
                wait_for(lambda: all(members(run.domain).get(f"w_{i}", {}).get("state") == "running"
                                     for i in range(4)), 30, "all of w")
            summary = run.end()
            # Each kill loses a second at most, of which the rules fire anew.
            check(all(r["rule_firings"] >= 300 - 3 * 11 for r in summary["robots"]), f"{summary['robots']}")

    def resolvers(self):
        path = self.out / "near.yaml"
        (self.out / "near.clp").write_text(NEAR)
        path.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 60\nresolvers: [near]\nrobots:\n"
                        "  - {name: red, rules: near.clp}\n  - {name: blue, rules: near.clp}\n")
        _, calm = experiment_run(self.folder_named("calm-near"), file=path)
        for _ in range(3):
            run = self.run("--rate", "10", *EACH_STEP, file=path)
            run.reach("red", 1)
            for name in ("near", "red", "near", "blue", "near"):
                self.kill(run, name, () if name == "near" else (name,))
            crashed = run.end()
            check_equal(crashed["hash"], calm["hash"], f"the hash; {run.said.read_text()}")
            check_equal(crashed["mail"]["lost"], 0, "lost mail")

    def freely(self):
        """Whoever acknowledges mail has it on disk."""
        path = self.out / "mail.yaml"
        (self.out / "counts.clp").write_text(COUNTS)
        (self.out / "sends.clp").write_text(SENDS)
        path.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 25\nrobots:\n"
                        "  - {name: red, rules: counts.clp}\n  - {name: blue, rules: sends.clp}\n")
        for brokers in (False, True):
            run = self.run("--free", "--set", "checkpoint=0.001", file=path)
            run.reach("red", 1)
            for i in range(6):
                broker = brokers and i % 2
                self.kill(run, "main" if broker else "red", () if broker else ("red",))
            done = wait_for(lambda: self.asked(run, "?*last*"), 10, "an answer of red")
            wrong = self.asked(run, "?*wrong*")
            check(int(done) > 20, f"red has had {done} mails only")
            if not brokers:
                check_equal(wrong, "0", "mails that are missing, or came twice")
            run.end()

    @staticmethod
    def asked(run, line):
        done = muster("do", "red", line, "--domain", run.domain)
        return done.stdout.split(": ", 1)[1].strip() if done.returncode == 0 else None


def main():
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else random.randrange(1 << 30)
    print(f"seed {seed}", flush=True)
    began = time.monotonic()
    with folder() as out, Processes() as processes:
        soak = Soak(seed, processes, out)
        for part in (soak.kills_change_nothing, soak.between_two_packets, soak.crews, soak.resolvers, soak.freely):
            part()
            print(f"{part.__name__}: {soak.kills} kills so far, {time.monotonic() - began:.0f} s", flush=True)
    print(f"{soak.kills} kills in {soak.runs} runs, {time.monotonic() - began:.0f} s; from a kill to the white pages "
          f"{statistics.median(soak.back_s):.1f} s (median), {max(soak.back_s):.1f} s at most")


if __name__ == "__main__":
    main()
