# SPDX-License-Identifier: Apache-2.0
"""Several brokers, one name space: whoever is asked knows everybody, and mail crosses."""
import json
import os
import pathlib
import subprocess
import time

from actors import Actor
from netns import Hosts
from support import (FOLLOW, MUSTER, ROOT, Processes, check, check_equal, experiment_run, folder, muster,
                     new_domain, program, wait_for, whole_lines)

BROKERS = ("a", "b")
CUT_S = int(os.environ.get("CUT_S", "1"))  # how long a link stays cut; longer in a soak


def pages(domain, broker):
    """The white pages of one broker, by name; empty when it does not answer."""
    done = muster("ps", "--json", "--domain", domain, "--broker", broker)
    lines = done.stdout.splitlines() if done.returncode == 0 else []
    return {m["name"]: m for m in map(json.loads, lines)}


def home(domain, broker, name):
    """Where an agent that is there lives, by the word of one broker."""
    member = pages(domain, broker).get(name)
    return member["broker"] if member and member["state"] == "running" else None


def broker_start(processes, domain, name, *words):
    p = processes.start(MUSTER, "broker", name, "--domain", domain, *words)
    wait_for(lambda: pages(domain, name), 10, f"broker {name}")
    return p


def receiver_start(processes, domain, name, out, broker, *words):
    return processes.start(program("mail_receiver"), domain, name, out / name, broker, *words)


def heard(out, name):
    return [line.split(" ", 2)[2] for line in whole_lines(out / name)]


def team_start(processes, domain, out, *words):
    """red at a, blue at b, and both are known everywhere."""
    brokers = [broker_start(processes, domain, name, *words) for name in BROKERS]
    receiver_start(processes, domain, "red", out, "a")
    receiver_start(processes, domain, "blue", out, "b")
    for broker in BROKERS:
        wait_for(lambda: (home(domain, broker, "red"), home(domain, broker, "blue")) == BROKERS, 10,
                 f"everybody is known to {broker}")
    return brokers


def counter(domain, broker, name):
    done = muster("lookup", "broker.mail", "--domain", domain, "--broker", broker)
    found = [line.split()[1] for line in done.stdout.splitlines() if line.split()[0] == name]
    return int(found[0]) if found else -1


def do(domain, broker, *words):
    done = muster(*words, "--domain", domain, "--broker", broker)
    check_equal(done.returncode, 0, f"{words} at {broker}: {done.stderr}")
    return done.stdout


def test_what_a_broker_may_be_called():
    domain = new_domain()
    for name in ("a b", "", "1a", "x" * 10000, "all", "robots", "special", "observer", "operator",
                 "broker", "broker.x"):
        done = muster("broker", name, "--domain", domain)
        want = "is reserved" if name[:1] in "arsob" and " " not in name and name else "must match"
        check_equal(done.returncode, 2, f"{name[:20]}: {done.stderr}")
        check(want in done.stderr and len(done.stderr) < 300, done.stderr)
    done = muster("broker", "main", "--store", "", "--domain", domain)
    check_equal(done.returncode, 2, "no file")
    check("expected a file, or none" in done.stderr, done.stderr)


def test_a_namesake_gives_way_to_a_broker_that_was_restarted():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = ("--store", out / "store.db")
        first = broker_start(processes, domain, "main", *store)
        first.terminate()
        first.wait(30)
        again = broker_start(processes, domain, "main", *store)
        later = processes.start(MUSTER, "broker", "main", "--domain", domain, "--store", "none")
        check_equal(later.wait(15), 4, "the later one gives way")
        check(again.poll() is None, "the one that was restarted stays")


def test_whichever_broker_is_asked():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        team_start(processes, domain, out)
        for broker in BROKERS:
            do(domain, broker, "send", "red,blue", f"names {broker}")
            do(domain, broker, "broadcast", f"all {broker}")
        want = sorted(f"{what} {broker}" for what in ("names", "all") for broker in BROKERS)
        for name in ("red", "blue"):
            wait_for(lambda: sorted(heard(out, name)) == want, 10, f"{name}, each mail once")
        for broker in BROKERS:
            done = muster("send", "nobody", "x", "--domain", domain, "--broker", broker)
            check_equal(done.returncode, 7, "no such name")


def scout_start(processes, domain, name, out, attributes, broker):
    return processes.start(program("pages_agent"), domain, name, out / name, attributes, broker)


def noted(out, name, line):
    wait_for(lambda: line in whole_lines(out / name), 10, f"{name} to note: {line}")


def test_groups_and_services_are_common():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        first = broker_start(processes, domain, "a", "--store", out / "a.db")
        broker_start(processes, domain, "b")
        scout_start(processes, domain, "seeker", out, "-", "b")
        scout_start(processes, domain, "mapper", out, "role=scout x=3 y=4", "a")
        noted(out, "seeker", "came mapper mapper [role=scout x=3 y=4] found some")
        for name in ("seeker", "mapper"):
            noted(out, name, "members mapper seeker")
        for broker in BROKERS:
            do(domain, broker, "send", "group:scouts", f"hello {broker}")
        for name in ("seeker", "mapper"):
            for broker in BROKERS:
                noted(out, name, f"mail operator hello {broker}")
        do(domain, "b", "send", "mapper", "gold")  # it tells the group
        noted(out, "seeker", "mail mapper gold")

        first.kill()
        wait_for(lambda: home(domain, "b", "mapper") == "b", 10, "the mapper goes to b")
        scout_start(processes, domain, "finder", out, "-", "b")
        noted(out, "finder", "came mapper mapper [role=scout x=3 y=4] found some")
        do(domain, "b", "send", "group:scouts", "still a group")
        for name in ("seeker", "mapper"):
            noted(out, name, "mail operator still a group")
        text = (out / "mapper").read_text()
        check_equal(text.count("hello a") + text.count("hello b"), 2, "each mail once")


def test_the_policy_of_an_agents_own_broker_decides():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        policy, audit = out / "b.policy", out / "audit"
        policy.write_text("allow operator direct green\n")
        broker_start(processes, domain, "a")
        broker_start(processes, domain, "b", "--policy", policy, "--audit", audit)
        for name in ("blue", "green"):
            receiver_start(processes, domain, name, out, "b")
            wait_for(lambda n=name: home(domain, "a", n) == "b", 10, f"{name} is known")
        muster("suspend", "green", "--domain", domain, "--broker", "b")
        for broker in BROKERS:
            for words, code in (("group join scouts --as blue", 6), ("group join scouts --as green", 0),
                                ("service add mapper x=1 --as blue", 6),
                                ("service add mapper x=1 --as green", 0),
                                ("group leave scouts --as green", 0),
                                ("group leave scouts --as green", 7),
                                ("service remove mapper --as green", 0)):
                done = muster(*words.split(), "--domain", domain, "--broker", broker)
                check_equal(done.returncode, code, f"{words} at {broker}: {done.stderr}")
        records = [json.loads(line) for line in whole_lines(audit)]
        check_equal([r["allowed"] for r in records].count(False), 4, "the audit of b has all")


def test_many_mails_keep_their_order():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        team_start(processes, domain, out)
        sent = subprocess.run([program("mail_sender"), str(domain), "tx", "blue", "2000", "30",
                               "ram", "a"], capture_output=True, text=True, timeout=60)
        check_equal((sent.returncode, sent.stdout.strip()), (0, "delivered 2000"), sent.stderr)
        check_equal(heard(out, "blue"), [f"count {n + 1}" for n in range(2000)], "what blue heard")


def test_a_sender_and_all_brokers_begin_anew():
    """Without a store all count from 1 again; who took the first mails takes the new ones, too."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        blue = Actor(processes, domain, out / "blue", "b")
        blue.tell("join", "blue", 0)
        for life in ("first", "second"):
            brokers = [broker_start(processes, domain, name, "--store", "none") for name in BROKERS]
            red = Actor(processes, domain, out / f"{life} red", "a")
            red.join("red")
            wait_for(lambda: home(domain, "a", "blue") == "b", 20, "blue is known to a")
            red.send("red", "blue", 20)
            wait_for(lambda: red.settled("red"), 20, f"all mail of the {life} has an answer")
            check_equal(red.sent("red"), list(range(1, 21)), "their numbers")
            for process in (red.process, *brokers):
                process.kill()
                process.wait()
        check_equal(blue.taken("blue", "red"), 2 * list(range(1, 21)), "what blue took")


def test_durable_mail_of_a_dead_broker_comes_when_it_is_back():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = ["--store", out / "a.db"]
        first = broker_start(processes, domain, "a", *store)
        broker_start(processes, domain, "b", "--store", out / "b.db")
        late = receiver_start(processes, domain, "late", out, "a")
        wait_for(lambda: home(domain, "b", "late") == "a", 10, "late is known at b")
        late.kill()
        wait_for(lambda: pages(domain, "a")["late"]["state"] == "absent", 10, "late is absent")
        sender = processes.start(program("mail_storer"), domain, "tx", "late", 20, "logged",
                                 out / "receipts")
        wait_for(lambda: "stored" in (out / "receipts").read_text()
                 if (out / "receipts").exists() else False, 10, "the mail is stored")
        check_equal(sender.wait(60), 0, "the sender")
        first.kill()
        (out / "late").unlink()
        receiver_start(processes, domain, "late", out, "b")
        wait_for(lambda: home(domain, "b", "late") == "b", 10, "late comes back at b")
        check_equal(heard(out, "late"), [], "the mail lies in a")
        broker_start(processes, domain, "a", *store)
        wait_for(lambda: len(heard(out, "late")) == 20, 10, "all of it crosses")
        check_equal(len(set(heard(out, "late"))), 20, "each once")


def test_what_a_broker_has_taken_over_is_in_its_store():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = ["--store", out / "b.db"]
        broker_start(processes, domain, "a", "--store", out / "a.db")
        second = broker_start(processes, domain, "b", *store)
        for name in ("blue", "green"):
            receiver_start(processes, domain, name, out, "b")
            wait_for(lambda: home(domain, "a", name) == "b", 10, f"{name} is known at a")
        do(domain, "b", "suspend", "blue,green")
        wait_for(lambda: pages(domain, "a")["green"]["state"] == "suspended", 10, "they sleep")
        sender = processes.start(program("mail_storer"), domain, "tx", "blue,green", 20, "logged",
                                 out / "receipts")
        check_equal(sender.wait(60), 0, "the sender")
        wait_for(lambda: counter(domain, "b", "waiting") == 40, 10, "the mail is at b")
        second.kill()
        second.wait()
        broker_start(processes, domain, "b", *store)
        wait_for(lambda: counter(domain, "b", "waiting") + counter(domain, "a", "waiting") >= 40,
                 10, "the mail is back")
        do(domain, "a", "resume", "blue,green")
        for name in ("blue", "green"):
            wait_for(lambda: heard(out, name) == [f"count {n + 1}" for n in range(20)], 10,
                     f"what {name} heard: {heard(out, name)}")


def test_a_second_broker_changes_nothing_in_a_lock_step():
    with folder() as out:
        file = out / "two.yaml"
        text = pathlib.Path(FOLLOW).read_text(encoding="utf-8").replace("../", f"{ROOT}/")
        file.write_text(text.split("expect:")[0])
        done, alone = experiment_run(out / "one", file=file)
        check_equal(done.returncode, 0, done.stderr)
        file.write_text(file.read_text() + "brokers: [main, second]\n")
        done, beside = experiment_run(out / "two", file=file)
        check_equal(done.returncode, 0, done.stderr)
        check_equal(beside["hash"], alone["hash"], "the hash")


class Sides:
    """Two hosts with a broker each, that know of each other."""

    def __init__(self, hosts, domain, out, processes):
        self.hosts, self.domain, self.out, self.processes = hosts, domain, out, processes

    def words(self, host):
        return [self.hosts.addresses[host], ",".join(self.hosts.addresses)]

    def muster(self, host, *words):
        interface, peers = self.words(host)
        return self.hosts.on(host, MUSTER, *words, "--domain", self.domain, "--interface",
                             interface, "--peer", peers)

    def run(self, host, *words):
        return subprocess.run(self.muster(host, *words, "--broker", BROKERS[host]),
                              capture_output=True, text=True, timeout=30)

    def start(self, host, name, *words):
        return self.processes.start(*self.hosts.on(host, program(name), self.domain, *words),
                                    BROKERS[host], *self.words(host))

    def lives(self, host, name):
        done = self.run(host, "ps", "--json")
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        return [m["broker"] for m in lines if m["name"] == name and m["state"] == "running"]


def brokers_apart(sides):
    for host, name in enumerate(BROKERS):
        sides.processes.start(*sides.muster(host, "broker", name))
        wait_for(lambda: sides.run(host, "ps").returncode == 0, 10, f"broker {name}")
    sides.start(0, "mail_receiver", "red", sides.out / "red")
    sides.start(1, "mail_receiver", "blue", sides.out / "blue")
    for host in (0, 1):
        wait_for(lambda: sides.lives(host, "red") + sides.lives(host, "blue") == ["a", "b"], 15,
                 "everybody is known everywhere")


def test_the_link_between_two_brokers_is_cut_and_mended():
    domain = new_domain()
    with Hosts() as hosts, folder() as out, Processes() as processes:
        sides = Sides(hosts, domain, out, processes)
        brokers_apart(sides)
        def flood(name, count):
            return [sides.start(host, "mail_sender", f"{name}{host}", to, count, 60 + CUT_S, "ram")
                    for host, to in ((0, "blue"), (1, "red"))]

        senders = flood("early", 8000)
        wait_for(lambda: len(heard(out, "blue")) > 50, 10, "mail crosses")
        hosts.part()
        wait_for(lambda: not sides.lives(0, "blue") and not sides.lives(1, "red"), 15, "the cut")
        senders += flood("late", 2000)
        for host, name in ((0, "red"), (1, "blue")):
            done = sides.run(host, "send", name, "near")
            check_equal(done.returncode, 0, f"mail on one side: {done.stderr}")
            wait_for(lambda: "near" in heard(out, name), 10, "it is served meanwhile")
        sides.start(0, "mail_receiver", "green", out / "green.a")
        wait_for(lambda: sides.lives(0, "green") == ["a"], 10, "green at a")
        sides.start(1, "mail_receiver", "green", out / "green.b")
        wait_for(lambda: sides.lives(1, "green") == ["b"], 10, "another green at b")
        time.sleep(CUT_S)
        check(senders[2].poll() is None and senders[3].poll() is None, "mail waits")
        hosts.rejoin()
        for name in ("red", "blue"):
            wait_for(lambda: len(heard(out, name)) >= 10001, 40, f"all mail to {name}")
            lines = [line.split(" ", 2) for line in whole_lines(out / name)]
            for sender, count in (("early", 8000), ("late", 2000)):
                got = [line[2] for line in lines if line[1].startswith(sender)]
                check(got == [f"count {n + 1}" for n in range(count)],
                      f"{name} heard {len(got)} of {count} mails, {len(set(got))} different")
        for host in (0, 1):
            wait_for(lambda: sides.lives(host, "green") == ["a"], 10, "green is the earlier one")
        if CUT_S < 8:  # so long DDS keeps what it has sent: receipts, too
            for p in senders:
                check_equal(p.wait(60), 0, "every mail has been answered for")
