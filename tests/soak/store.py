#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A hundred kills of the broker at random instants, and of the receiver alone and with it.

Durable mail of three senders is all there, in order within a priority, and once.  What was in one
window may come twice when the receiver dies that took it from an earlier life of the broker: never
when it dies alone, before that.  Groups and services stand in the next life as they were answered
for.  `make soak-store`, or tests/soak/store.py SEED; some three minutes, at most ten.
"""
import contextlib
import pathlib
import random
import shutil
import sqlite3
import sys
import time

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "support" / "system"), str(TESTS / "system")]
from support import Processes, broker_start, check, check_equal, folder, members  # noqa: E402
from support import new_domain, program, wait_for, whole_lines  # noqa: E402
from test_store import broker_again, kill, receipts, receiver_start  # noqa: E402

# Three senders may have 8,192 mails each in a box, however slow its receiver is.
RUNS, KILLS, MAILS, CHANGES, SECONDS_MAX = 10, 10, 8000, 1000000, 540
SENDERS = (("plain", "logged", ()), ("mixed", "logged", ("mixed",)), ("synced", "synced", ()))
CHANGERS = ("one", "other")
WINDOW = 200 + 8  # MU_WINDOW_MAX, and directives beyond it


class Team:
    """A broker with a store, a receiver with a record, three senders, two changers of pages."""

    def __init__(self, processes, out, dice):
        self.processes, self.out, self.dice, self.domain = processes, out, dice, new_domain()
        self.store = out / "store.db"
        self.both = self.alone = self.broker_deaths = self.lost_memories = 0
        self.broker = broker_start(processes, self.domain, "--store", self.store)
        self.receiver = receiver_start(processes, self.domain, out)
        wait_for(lambda: "receiver" in members(self.domain), 10, "the receiver in the white pages")
        self.senders = [
            processes.start(program("mail_storer"), self.domain, name, "receiver", MAILS, level,
                            out / f"receipts-{name}", *more) for name, level, more in SENDERS]
        self.changers = [
            processes.start(program("pages_changer"), self.domain, name, out / f"pages-{name}",
                            CHANGES, dice.randrange(1 << 30)) for name in CHANGERS]

    def record(self):
        return whole_lines(self.out / "record")

    def progress(self):
        return sum(len(receipts(self.out / f"receipts-{name}")[0]) for name, *_ in SENDERS)

    def changes(self, name, word):
        return whole_lines(self.out / f"pages-{name}").count(word)

    def receiver_again(self):
        self.receiver = receiver_start(self.processes, self.domain, self.out)

    def kill_receiver(self):
        """Alone: its next life has taken mail before anybody else dies."""
        self.lost_memories += self.broker_deaths > 0
        kill(self.receiver)
        had = len(self.record())
        self.receiver_again()
        wait_for(lambda: len(self.record()) > had or had >= MAILS * len(SENDERS), 30,
                 "mail at the receiver's next life")
        self.alone += 1

    def kill_broker(self, with_receiver):
        kill(self.broker)
        self.broker_deaths += 1
        if with_receiver:
            kill(self.receiver)
            self.receiver_again()
            self.both += 1
            self.lost_memories += 1
        time.sleep(self.dice.choice((0, 0, 0.3, 1.5)))
        self.broker = broker_again(self.processes, self.domain, self.store)

    def lives(self, receiver_lives):
        """Whoever lives at a turn may die; the receiver alone also before the broker's first death."""
        total = MAILS * len(SENDERS)
        for turn in range(2 + KILLS):
            at = total * (turn + self.dice.random()) / (3 + KILLS)
            watch = self.dice.choice((self.progress, lambda: len(self.record())))
            wait_for(lambda: watch() >= at, 60, f"mail {at:.0f} of life {turn}")
            if turn < 2 or (not receiver_lives and self.dice.random() < 0.4):
                self.kill_receiver()
            if turn >= 2:
                self.kill_broker(not receiver_lives and self.dice.random() < 0.3)

    def end(self):
        for sender in self.senders:
            wait_for(lambda: sender.poll() is not None, 60, f"the end of {sender.args[2]}")
            check_equal(sender.returncode, 0, f"the end of {sender.args[2]}")
            check_equal(receipts(self.out / f"receipts-{sender.args[2]}")[1], [],
                        f"other receipts of {sender.args[2]}")
        wait_for(lambda: len(set(line.split(" ", 1)[1] for line in self.record())) >=
                 MAILS * len(SENDERS), 30, "all mails at the receiver")
        self.kill_broker(False)
        for name in CHANGERS:
            had = self.changes(name, "changed")
            wait_for(lambda: self.changes(name, "changed") > had + 100, 30, f"changes of {name}")
        wait_for(lambda: self.rows() == 0, 30, "the receiver's acknowledgements in the store")
        self.broker.terminate()
        self.broker.wait()

    def rows(self):
        """Mails in the store, from a copy: the broker keeps it to itself."""
        with folder() as copy:
            for path in self.out.glob("store.db*"):
                shutil.copy(path, copy)
            try:
                with contextlib.closing(sqlite3.connect(copy / "store.db")) as db:
                    return db.execute("SELECT count(*) FROM mails").fetchone()[0]
            except sqlite3.DatabaseError:
                return None  # caught in the middle of a checkpoint

    def check_mail(self):
        taken = {name: [] for name, *_ in SENDERS}
        for line in self.record():
            taken[line.split()[1]].append(int(line.split()[3]))
        twice = 0
        for name, _, more in SENDERS:
            good, bad = receipts(self.out / f"receipts-{name}")
            check_equal((len(good), bad), (MAILS, []), f"mails of {name} answered for")
            once = list(dict.fromkeys(taken[name]))
            twice += len(taken[name]) - len(once)
            check_equal(sorted(once), list(range(1, MAILS + 1)), f"what came of {name}")
            for rest in range(3 if more else 1):
                kept = [n for n in once if not more or n % 3 == rest]
                check_equal(kept, sorted(kept), f"the order of {name}, {rest}")
        check(twice <= self.lost_memories * WINDOW,
              f"{twice} came twice, the receiver's memory was lost {self.lost_memories} times")
        return twice

    def check_pages(self):
        for name in CHANGERS:
            lines = whole_lines(self.out / f"pages-{name}")
            check_equal([line for line in lines if line not in ("changed", "round")], [],
                        f"lines of {name}")
        return sum(self.changes(name, "changed") for name in CHANGERS)

    def check_store(self):
        with contextlib.closing(sqlite3.connect(self.store)) as db:
            check_equal(db.execute("SELECT count(*) FROM mails").fetchone()[0], 0, "rows left")
            check_equal(db.execute("PRAGMA integrity_check").fetchone()[0], "ok", "the file")


def run_once(out, seed, receiver_lives):
    with Processes() as processes:
        team = Team(processes, out, random.Random(seed))
        team.lives(receiver_lives)
        team.end()
    twice = team.check_mail()
    changes = team.check_pages()
    team.check_store()
    return (f"{team.broker_deaths} deaths of the broker, {team.alone} of the receiver alone, {team.both} of "
            f"both; {MAILS * len(SENDERS)} mails, {twice} of them twice; {changes} changes")


def main():
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else random.randrange(1 << 30)
    print(f"seed {seed}", flush=True)
    passed = failed = 0
    until = time.monotonic() + SECONDS_MAX
    for run in range(RUNS):
        if time.monotonic() > until:
            print(f"  {RUNS - run} runs left out: the time is over")
            break
        with folder() as out:
            try:
                print(f"  run {run}: {run_once(out, seed + run, run % 2 == 0)}", flush=True)
                passed += 1
            except AssertionError as why:
                print(f"  run {run}: {str(why)[:2000]}", flush=True)
                failed += 1
    print(f"{passed} passed, {failed} failed")
    return failed > 0


if __name__ == "__main__":
    sys.exit(main())
