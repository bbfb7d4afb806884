# SPDX-License-Identifier: Apache-2.0
"""Agents that do with mail what a test tells them, and what came of it: tests/programs/mail_actor.c."""
import subprocess

from support import program, wait_for

LAST_WORDS = ("delivered", "expired", "box-full", "unknown-name", "refused", "dropped", "no-store")


class Actor:
    """A process of agents."""

    def __init__(self, processes, domain, record, *words):
        self.record = record
        record.touch()
        self.process = subprocess.Popen([program("mail_actor"), str(domain), str(record), *words],
                                        stdin=subprocess.PIPE, stdout=subprocess.DEVNULL,
                                        stderr=subprocess.DEVNULL)
        processes.started.append(self.process)

    def tell(self, *words):
        self.process.stdin.write((" ".join(map(str, words)) + "\n").encode())
        self.process.stdin.flush()

    def lines(self, kind, name):
        text = self.record.read_text()
        words = (line.split() for line in text.splitlines())
        return [line[2:] for line in words if line[:2] == [kind, name]]

    def join(self, name, last=0, *limits):
        """Enters an agent, and waits until the broker has said yes."""
        self.tell("join", name, last, *limits)
        wait_for(lambda: ["1"] in self.lines("J", name), 20, f"{name} is there")

    def send(self, name, to, count, every_us=0, levels="r", priorities="1", ttl_ms=0):
        self.tell("send", name, to, count, every_us, levels, priorities, ttl_ms)

    def sent(self, name):
        """The numbers of its mails."""
        return [int(line[0]) for line in self.lines("S", name)]

    def taken(self, name, sender):
        """The numbers of a sender's mails, as they came."""
        return [int(line[2]) for line in self.lines("M", name) if line[1] == sender]

    def told(self, name):
        """What was said of each of its mails: a dictionary of lists of words."""
        words = {}
        for first, last, outcome in self.lines("R", name):
            for number in range(int(first), int(last) + 1):
                words.setdefault(number, []).append(outcome)
        return words

    def settled(self, name):
        """The last words alone, as told has them; None: of some of its mails there is none yet."""
        told = self.told(name)
        last = {n: [w for w in told.get(n, ()) if w in LAST_WORDS] for n in self.sent(name)}
        return last if all(last.values()) else None
