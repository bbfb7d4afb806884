#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Two hundred agents in twenty processes send each other mail while processes are killed, stopped
and started at random for a minute, and the broker is stopped for three seconds.  In the end every
mail of a surviving sender has an outcome, those delivered to a survivor came once and in order, and
nothing is left behind.  `make soak-churn`, or tests/soak/churn.py SEED.
"""
import collections
import pathlib
import random
import signal
import sys
import time

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "support" / "system"), str(TESTS / "system")]
from support import Processes, broker_start, check, check_equal, folder  # noqa: E402
from support import new_domain, program, wait_for, whole_lines  # noqa: E402
from test_garbage import resident_kb  # noqa: E402
from test_health import Watch  # noqa: E402

PROCESSES, AGENTS, SECONDS, BROKER_STOPPED_S, GROWTH_KB = 20, 10, 60, 3, 4096
SURVIVORS = 10  # of the processes: they are stopped, and never killed


class Crowd:
    """Processes of agents a0-0, a0-1, ...; each writes what it sent, heard of it, and took."""

    def __init__(self, processes, out, dice):
        self.processes, self.out, self.dice, self.domain = processes, out, dice, new_domain()
        self.broker = broker_start(processes, self.domain)
        self.lives = [0] * PROCESSES
        self.members = [self.start(i) for i in range(PROCESSES)]
        self.kills = self.stops = 0

    def record(self, index):
        return self.out / f"{index}.{self.lives[index]}"

    def start(self, index):
        return self.processes.start(program("churner"), self.domain, index, PROCESSES, AGENTS,
                                    self.record(index))

    def kill(self, index):
        self.members[index].kill()
        self.members[index].wait()
        self.lives[index] += 1
        time.sleep(self.dice.choice((0, 0.5, 2)))
        self.members[index] = self.start(index)
        self.kills += 1

    def stop(self, which, seconds):
        for process in which:
            process.send_signal(signal.SIGSTOP)
        time.sleep(seconds)
        for process in which:
            process.send_signal(signal.SIGCONT)
        self.stops += len(which)

    def churn(self):
        began = time.monotonic()
        halved = broker_stopped = False
        while (past := time.monotonic() - began) < SECONDS / 2:
            if past > SECONDS / 6 and not broker_stopped:
                broker_stopped = True
                self.stop([self.broker], BROKER_STOPPED_S)
            elif past > SECONDS / 4 and not halved:
                halved = True
                self.stop(self.members[::2], BROKER_STOPPED_S)
            elif self.dice.random() < 0.3:
                self.stop([self.dice.choice(self.members)], self.dice.choice((0.2, 1.5)))
            else:
                self.kill(self.dice.randrange(SURVIVORS, PROCESSES))
            time.sleep(self.dice.random() / 2)


def records_read(crowd):
    """What the survivors say: mails and outcomes, and what was taken by receiver and sender."""
    sent, outcomes = set(), {}
    survivors = {f"a{i}-{k}" for i in range(SURVIVORS) for k in range(AGENTS)}
    taken = collections.defaultdict(list)
    for index in range(SURVIVORS):
        for line in whole_lines(crowd.record(index)):
            word, one, other, text = line.split(" ", 3)
            if word == "sent":
                sent.add((one, int(other), text))
            elif word == "told":
                first, last, outcome = text.split()
                for seq in range(int(first), int(last) + 1):
                    outcomes[one, seq] = outcome
            elif word == "took" and other in survivors:
                taken[one, other].append(int(text))
    return sent, outcomes, taken, survivors


def mail_check(crowd):
    sent, outcomes, taken, survivors = records_read(crowd)
    silent = [mail for mail in sent if (mail[0], mail[1]) not in outcomes]
    check(not silent, f"{len(silent)} of {len(sent)} mails without an outcome: {silent[:5]}")
    for (receiver, sender), numbers in taken.items():
        check_equal(numbers, sorted(set(numbers)), f"what {receiver} took of {sender}")
    had = {(sender, number) for (_, sender), numbers in taken.items() for number in numbers}
    among = [mail for mail in sent if mail[2] in survivors]
    # Who had not come yet when the first mails went out was unknown then.
    lost = [mail for mail in among if (mail[0], mail[1]) not in had and
            outcomes[mail[0], mail[1]] != "unknown-name"]
    check(not lost, f"{len(lost)} of {len(among)} mails among survivors lost: "
          f"{[(mail, outcomes[mail[0], mail[1]]) for mail in lost[:5]]}")
    return len(sent), len(among), collections.Counter(outcomes.values())


def main():
    seed = int(sys.argv[1]) if len(sys.argv) > 1 else random.randrange(1 << 30)
    print(f"seed {seed}", flush=True)
    failed = 0
    with folder() as out, Processes() as processes:
        try:
            crowd = Crowd(processes, out, random.Random(seed))
            watch = Watch(processes, crowd.domain)
            wait_for(lambda: watch.look("status").get("agents", 0) >= PROCESSES * AGENTS, 30, "all")
            time.sleep(2)
            sizes = []
            for _ in range(3):  # buffers of the network grow to what the worst moment needs, and stay
                crowd.churn()
                time.sleep(2)
                sizes.append(resident_kb(crowd.broker))
            watch = Watch(processes, crowd.domain)  # the first one has ended
            wait_for(lambda: watch.look("status").get("agents") == PROCESSES * AGENTS, 30,
                     f"all are back: {watch.look('status')}")
            # The broker may not have heard yet that one of them is another one.
            wait_for(lambda: all(crowd.record(i).exists() for i in range(PROCESSES)), 30, "all have begun")
            for member in crowd.members:
                member.send_signal(signal.SIGUSR1)  # no more mail; what is under way comes to its end
            wait_for(lambda: all("done - - -" in whole_lines(crowd.record(i))
                                 for i in range(PROCESSES)), 30, "all mail has its outcome")
            wait_for(lambda: watch.look("status").get("waiting") == 0 and
                     watch.look("status").get("stored") == 0, 10,
                     f"nothing waits: {watch.look('status')}")
            mails, among, outcomes = mail_check(crowd)
            print(f"  {crowd.kills} kills, {crowd.stops} stops; {mails} mails of survivors, {among} "
                  f"to survivors: {dict(outcomes)}; broker {sizes} kB")
            growth = [after - before for before, after in zip(sizes, sizes[1:])]
            check(min(growth) < GROWTH_KB, f"the broker grew by {growth} kB")
        except AssertionError as why:
            print(f"  {str(why)[:2000]}")
            failed = 1
    print(f"{1 - failed} passed, {failed} failed")
    return failed


if __name__ == "__main__":
    sys.exit(main())
