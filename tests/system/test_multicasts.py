# SPDX-License-Identifier: Apache-2.0
"""Mail for many processes goes out once: who hears it, whatever becomes of them and of the broker."""
import contextlib
import os
import signal
import subprocess

from support import (MUSTER, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, observer_environment, program, wait_for, whole_lines)

CROWD = tuple(f"r{i}" for i in range(8))


def receiver_start(processes, domain, out, name, *words, **kwargs):
    return processes.start(program("mail_receiver"), domain, name, out / name, *words, **kwargs)


def crowd_start(processes, domain, out, names=CROWD, broker="main"):
    """Processes by name, all of them known to the broker."""
    started = {name: receiver_start(processes, domain, out, name, broker) for name in names}
    wait_for(lambda: set(names) <= set(members(domain)), 20, "the crowd is there")
    return started


def caller_start(processes, domain, to, count, broker="main", name="tx"):
    """Somebody who tells one thing after the other: what waits in boxes is handed out in heaps, and
    each to one process."""
    return processes.start(program("mail_caller"), domain, name, to, count, 2, broker)


def heard(out, name, sender="tx"):
    """The numbers in the mails of a sender to a receiver, in the order in which they came."""
    words = [line.split() for line in whole_lines(out / name)]
    return [int(line[3]) for line in words if line[1:3] == [sender, "count"]]


def multicasts(domain, broker="main"):
    done = muster("lookup", "broker.delivery", "--domain", domain, "--broker", broker)
    found = [line.split()[1] for line in done.stdout.splitlines() if line.split()[0] == "multicasts"]
    check_equal(len(found), 1, f"the counter: {done.stdout}{done.stderr}")
    return int(found[0])


def all_heard(out, names, count, sender="tx"):
    """Expects that each hears every mail of a sender once, and in order."""
    try:
        wait_for(lambda: all(heard(out, name, sender)[-1:] == [count] for name in names), 30,
                 "the last")
    finally:
        for name in names:
            got = heard(out, name, sender)
            check(got == list(range(1, count + 1)),
                  f"{name} heard {len(got)} of {count}, {len(set(got))} different: {oddities(got)}")


def oddities(numbers):
    """The first few places at which a row is not one."""
    pairs = list(zip([0, *numbers], numbers))
    return [pair for pair in pairs if pair[1] != pair[0] + 1][:5]


def test_a_crowd_hears_broadcasts():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--store", "none")
        crowd_start(processes, domain, out)
        before = multicasts(domain)
        caller_start(processes, domain, "all", 500)
        all_heard(out, CROWD, 500)
        between = multicasts(domain)
        check(between > before, f"{between - before} multicasts of broadcasts")
        caller_start(processes, domain, ",".join(CROWD), 500, name="ty")
        all_heard(out, CROWD, 500, "ty")
        check(multicasts(domain) > between, "multicasts of mail to several names")


def test_few_have_none():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--store", "none")
        crowd_start(processes, domain, out, CROWD[:2])
        caller_start(processes, domain, "all", 200)
        all_heard(out, CROWD[:2], 200)
        check_equal(multicasts(domain), 0, "multicasts to two")


def test_one_that_is_stopped_is_in_nobodys_way():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--store", "none")
        crowd = crowd_start(processes, domain, out)
        caller_start(processes, domain, ",".join(CROWD), 2000)
        for name in ("r0", "r5"):
            had = len(heard(out, name))
            wait_for(lambda: len(heard(out, name)) > had + 200, 20, "mail comes")
            crowd[name].send_signal(signal.SIGSTOP)
            os.waitid(os.P_PID, crowd[name].pid, os.WSTOPPED)
            had = len(heard(out, name))
            wait_for(lambda: all(len(heard(out, other)) > had + 400 for other in CROWD
                                 if other != name), 20, "the others go on hearing")
            check(len(heard(out, name)) <= had + 1, "it is stopped")
            crowd[name].send_signal(signal.SIGCONT)
        all_heard(out, CROWD, 2000)
        check(multicasts(domain) > 0, "multicasts")


def test_one_that_is_stopped_until_it_is_missed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--store", "none")
        crowd = crowd_start(processes, domain, out)
        caller_start(processes, domain, ",".join(CROWD), 3000)
        wait_for(lambda: len(heard(out, "r0")) > 200, 20, "mail comes")
        crowd["r0"].send_signal(signal.SIGSTOP)
        wait_for(lambda: members(domain)["r0"]["state"] == "absent", 20, "it is missed")
        had = len(heard(out, "r1"))
        wait_for(lambda: len(heard(out, "r1")) > had + 300, 20, "mail waits for it")
        crowd["r0"].send_signal(signal.SIGCONT)
        wait_for(lambda: members(domain)["r0"]["state"] == "running", 20, "it is back")
        all_heard(out, CROWD, 3000)


def test_a_broker_that_is_killed_amid_them_is_back():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        store = ("--store", out / "store.db")
        first = broker_start(processes, domain, *store)
        crowd_start(processes, domain, out)
        caller_start(processes, domain, ",".join(CROWD), 2000)
        for _ in range(2):
            had = {name: len(heard(out, name)) for name in CROWD}
            wait_for(lambda: all(len(heard(out, name)) > had[name] + 300 for name in CROWD), 20,
                     "mail comes to all: what waits for one that is not back would die with the broker")
            check(len(heard(out, "r0")) < 1900, "it is killed amid them")
            first.kill()
            first.wait()
            first = processes.start(MUSTER, "broker", "main", "--domain", domain, *store)
        all_heard(out, CROWD, 2000)
        check(multicasts(domain) > 0, "multicasts of the last life")


MANY = 12000  # a broker is killed twice before all of them are through


def told_by_a_broker_that_is_killed(processes, out, level, seconds):
    """The sender of mail to all of the crowd, as fast as it goes: some are far ahead of others."""
    domain = new_domain()
    store = ("--store", out / "store.db")
    broker = broker_start(processes, domain, *store)
    crowd_start(processes, domain, out)
    with open(out / "other-words", "w") as others:
        sender = processes.start(program("mail_sender"), domain, "tx", ",".join(CROWD), MANY, seconds,
                                 level, stderr=others)
    for _ in range(2):
        had = len(heard(out, "r0"))
        wait_for(lambda: len(heard(out, "r0")) > had + 600, 20, "mail comes")
        broker.kill()
        broker.wait()
        broker = processes.start(MUSTER, "broker", "main", "--domain", domain, *store)
    return sender


def test_a_broker_that_is_killed_loses_no_durable_mail_to_many():
    with folder() as out, Processes() as processes:
        sender = told_by_a_broker_that_is_killed(processes, out, "logged", 600)
        all_heard(out, CROWD, MANY)
        with contextlib.suppress(subprocess.TimeoutExpired):
            sender.wait(5)  # some last words it may hear twice, or not: they died with a broker
        check_equal((out / "other-words").read_text(), "", "no mail had another end than delivered")


def test_a_broker_that_is_killed_repeats_no_mail_to_many():
    with folder() as out, Processes() as processes:
        sender = told_by_a_broker_that_is_killed(processes, out, "ram", 6)
        sender.wait(60)  # what waited in the memory of a broker is gone with that
        for name in CROWD:
            got = heard(out, name)
            check(got == sorted(set(got)), f"{name}, in order and none twice: {oddities(got)}")


def test_one_that_comes_and_goes():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--store", "none")
        crowd_start(processes, domain, out)
        caller_start(processes, domain, "all", 2000)
        for end in (signal.SIGKILL, signal.SIGTERM, signal.SIGKILL):
            had = len(heard(out, "guest"))
            guest = receiver_start(processes, domain, out, "guest")
            wait_for(lambda: len(heard(out, "guest")) > had + 50, 20, "the guest hears, too")
            guest.send_signal(end)
            guest.wait()
        all_heard(out, CROWD, 2000)
        got = heard(out, "guest")
        check(got == sorted(set(got)), f"the guest, in order and none twice: {oddities(got)}")
        check(multicasts(domain) > 0, "multicasts")


def test_only_who_serves_most_has_multicasts():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        for name in ("a", "b"):
            processes.start(MUSTER, "broker", name, "--domain", domain, "--store", "none")
            wait_for(lambda: muster("ps", "--domain", domain, "--broker", name).returncode == 0, 10,
                     f"broker {name}")
        there = ("s0", "s1", "s2", "s3")
        crowd_start(processes, domain, out, CROWD, "a")
        crowd_start(processes, domain, out, there, "b")
        names = CROWD + there
        for sender, name in (("tx", "a"), ("ty", "b")):
            caller_start(processes, domain, ",".join(names), 600, name, sender)
        for sender in ("tx", "ty"):
            all_heard(out, names, 600, sender)
        check(multicasts(domain, "a") > 0, "multicasts of a")
        check_equal(multicasts(domain, "b"), 0, "of b, whose would wake the others, too")


def test_one_whose_dds_has_a_configuration_of_its_own():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--store", "none")
        crowd_start(processes, domain, out)
        receiver_start(processes, domain, out, "lone", env=observer_environment())
        wait_for(lambda: "lone" in members(domain), 20, "it is there, too")
        names = (*CROWD, "lone")
        caller_start(processes, domain, ",".join(names), 600)
        all_heard(out, names, 600)
        check(multicasts(domain) > 0, "multicasts")
