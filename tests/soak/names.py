#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Names come and go: 200,000, 100 a second, at three brokers of which one has a store and is killed on
the way.  Half of the agents are disposed of, half are killed.  Then the brokers are filled: one more
name is refused with the reason, and all others are served.  `make soak-names`, or
tests/soak/names.py [COUNT [RATE [EXPIRY_S]]].
"""
import pathlib
import signal
import sys
import time

TESTS = pathlib.Path(__file__).resolve().parent.parent
sys.path[:0] = [str(TESTS / "support" / "system"), str(TESTS / "system")]
from support import MUSTER, ROOT, Processes, check, check_equal, folder, muster  # noqa: E402
from support import new_domain, program, wait_for  # noqa: E402

BROKERS, NAMES, CROWD = ("main", "east", "west"), 16384, 4096
PATIENCE_S = 60  # for a process until all its names are confirmed


class Soak:
    """Three brokers, and processes of RATE agents, one a second."""

    def __init__(self, processes, out, rate, expiry_s):
        self.processes, self.out, self.rate, self.expiry_s = processes, out, rate, expiry_s
        self.domain = new_domain()
        self.brokers = {name: self.broker_start(name) for name in BROKERS}
        self.crowds, self.served, self.slowest_s = [], 0, 0.0

    def broker_start(self, name):
        store = ["--store", self.out / "store.db"] if name == "main" else []
        broker = self.processes.start(MUSTER, "broker", name, "--domain", self.domain,
                                      "--name-expiry", self.expiry_s, *store)
        wait_for(lambda: self.run("ps", "--broker", name).returncode == 0, 30, f"broker {name}")
        return broker

    def run(self, *words):
        return muster(*words, "--domain", self.domain)

    def broker_kill(self):
        self.brokers["main"].kill()
        self.brokers["main"].wait()
        time.sleep(2)
        self.brokers["main"] = self.broker_start("main")

    def crowd_start(self, prefix, count, broker, disposes):
        said = self.out / prefix
        with said.open("w") as file:
            process = self.processes.start(program("crowd"), self.domain, count, prefix, broker,
                                           *["dispose"][:disposes], stdout=file, stderr=file)
        self.crowds.append((process, said, time.monotonic(), disposes))

    def crowds_look(self):
        """Those that are confirmed end: by themselves, or they are killed."""
        left = []
        for crowd in self.crowds:
            process, said, began, disposes = crowd
            if "all confirmed" not in said.read_text() or (disposes and process.poll() is None):
                check(time.monotonic() - began < PATIENCE_S, f"{said.name}: {said.read_text()}")
                left.append(crowd)
                continue
            self.slowest_s = max(self.slowest_s, time.monotonic() - began)
            self.served += self.rate
            process.kill()
            process.wait()
            self.processes.started.remove(process)
            said.unlink()
        self.crowds = left

    def go(self, count):
        rounds = count // self.rate
        began = time.monotonic()
        for i in range(rounds):
            if i == rounds // 2:
                self.broker_kill()
            self.crowd_start(f"n{i}-", self.rate, BROKERS[i % 3], i % 2)
            while time.monotonic() < began + i + 1:
                self.crowds_look()
                time.sleep(0.05)
        while self.crowds:
            self.crowds_look()
            time.sleep(0.05)
        check_equal(self.served, rounds * self.rate, "names that were confirmed")
        print(f"  {self.served} names in {time.monotonic() - began:.0f} s; a process waited at most "
              f"{self.slowest_s:.1f} s", flush=True)

    def known(self, broker):
        lines = self.run("ps", "--broker", broker).stdout.splitlines()
        return sum(line[:1] == "c" and "-" in line.split()[0] for line in lines)

    def fill(self):
        began = time.monotonic()
        for i in range(NAMES // CROWD):
            self.crowd_start(f"c{i}-", CROWD, BROKERS[i % 3], False)
        # Names of killed agents make room when they are old enough, and the others ask again.
        wait_for(lambda: all("all confirmed" in said.read_text() for _, said, _, _ in self.crowds),
                 self.expiry_s + 2 * PATIENCE_S, "16,384 at once")
        for name in BROKERS:
            wait_for(lambda: self.known(name) == NAMES, self.expiry_s + PATIENCE_S,
                     f"{name} knows all: {self.known(name)}")
        print(f"  {NAMES} at once after {time.monotonic() - began:.0f} s", flush=True)
        done = self.run("robot", "more", "--rules", ROOT / "rules/follower.clp")
        check(done.returncode != 0 and "the white pages are full" in done.stderr, done.stderr)
        for i in range(NAMES // CROWD):
            done = self.run("send", f"c{i}-7", "tell", "hello")
            check_equal(done.returncode, 0, f"the others are served: {done.stderr}")


def main():
    count, rate, expiry_s = (list(map(int, sys.argv[1:])) + [200000, 100, 60][len(sys.argv) - 1:])
    with folder() as out, Processes() as processes:
        soak = Soak(processes, out, rate, expiry_s)
        soak.go(count)
        soak.fill()
        for name, broker in soak.brokers.items():
            check(broker.poll() is None, f"broker {name} lives")
            broker.send_signal(signal.SIGTERM)
    print("names: ok")


if __name__ == "__main__":
    main()
