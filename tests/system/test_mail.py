# SPDX-License-Identifier: Apache-2.0
"""Mail by name between processes that come, go and are killed."""
import os
import signal
import subprocess

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for, whole_lines)

MAILS = 20000
KILLS = 20


def receiver_start(processes, domain, record):
    return processes.start(program("mail_receiver"), domain, "receiver", record)


def test_receiver_killed_again_and_again_misses_nothing_and_gets_nothing_twice():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        record = out / "record"
        broker_start(processes, domain)
        receiver = receiver_start(processes, domain, record)
        wait_for(lambda: "receiver" in members(domain), 10, "the receiver in the white pages")
        sender = processes.start(program("mail_sender"), domain, "sender", "receiver", MAILS, 120,
                                 stdout=subprocess.PIPE)
        for kill in range(1, KILLS + 1):
            # By progress, not by time: each life takes its share of the mail.
            share = MAILS * kill // (KILLS + 1)
            wait_for(lambda: len(whole_lines(record)) >= share, 30, f"{share} mails taken")
            receiver.kill()
            receiver.wait()
            receiver = receiver_start(processes, domain, record)
        output, _ = sender.communicate(timeout=60)
        check_equal(output.decode().strip(), f"delivered {MAILS}", "the sender's receipts")
        counts = [int(line.split()[3]) for line in whole_lines(record)]
        check_equal(len(set(counts)), MAILS, "different mails at the receiver")
        check_equal(len(counts), MAILS, "mails at the receiver, duplicates and all")
        check_equal(counts, sorted(counts), "their order")


def test_mail_for_an_absent_agent_waits_and_comes_in_order():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        receiver = receiver_start(processes, domain, out / "record")
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        receiver.terminate()
        receiver.wait()
        check_equal(members(domain)["receiver"]["state"], "absent", "state after leaving")
        for word in ("one", "two", "three"):
            done = muster("send", "receiver", word, "--domain", domain)
            check_equal((done.returncode, done.stdout.strip()), (0, "stored"), "receipt")
        receiver_start(processes, domain, out / "record")
        lines = wait_for(lambda: len(whole_lines(out / "record")) == 3 and
                         whole_lines(out / "record"), 5, "three mails")
        check_equal([line.split()[2] for line in lines], ["one", "two", "three"], "their order")


def test_receipts_and_exit_codes():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        receiver_start(processes, domain, out / "record")
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        done = muster("send", "receiver", "hello", "--domain", domain)
        check_equal((done.returncode, done.stdout.strip()), (0, "delivered"), "a live receiver")
        done = muster("send", "nobody", "hello", "--domain", domain)
        check_equal(done.returncode, 7, "a name that was never registered")
        check("unknown-name" in done.stderr, done.stderr)
        done = muster("start", "receiver", "--as", "stranger", "--domain", domain)
        check_equal(done.returncode, 6, "a directive of a stranger")
        done = muster("lookup", "nobody", "--domain", domain)
        check_equal(done.returncode, 7, "looking up nobody")
        done = muster("lookup", "broker", "--json", "--domain", domain)
        check_equal(done.returncode, 0, "looking up the broker")
        check('"kind":"special"' in done.stdout.replace(" ", ""), done.stdout)


def test_broadcast_reaches_the_active_and_not_the_absent():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        for name in ("one", "two", "gone"):
            processes.start(program("mail_receiver"), domain, name, out / name)
        wait_for(lambda: {"one", "two", "gone"} <= set(members(domain)), 5, "three receivers")
        processes.started[-1].terminate()
        processes.started[-1].wait()
        wait_for(lambda: members(domain)["gone"]["state"] == "absent", 5, "one that has left")
        check_equal(muster("broadcast", "hello", "--domain", domain).returncode, 0, "broadcast")
        for name in ("one", "two"):
            wait_for(lambda: whole_lines(out / name), 5, f"the mail of {name}")
        processes.start(program("mail_receiver"), domain, "gone", out / "gone")
        wait_for(lambda: members(domain)["gone"]["state"] == "running", 5, "one that is back")
        check_equal(whole_lines(out / "gone"), [], "mail of who was absent")


def test_a_question_for_facts_is_answered_by_the_rules_engine():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        processes.start(MUSTER, "robot", "red", "--rules", ROOT / "rules/follower.clp", "--domain",
                        domain)
        wait_for(lambda: "red" in members(domain), 10, "the robot in the white pages")
        done = subprocess.run([program("ask"), str(domain), "red", "2", "facts"], timeout=30,
                              capture_output=True, text=True)
        check_equal(done.returncode, 0, f"an answer: {done.stderr}")
        check(done.stdout.startswith('2 red talk inform: "f-0 '), done.stdout)
        check("(initial-fact)" in done.stdout, done.stdout)


def test_a_name_that_is_held_is_refused():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        receiver_start(processes, domain, out / "record")
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        done = muster("send", "receiver", "x", "--as", "receiver", "--domain", domain)
        check_equal(done.returncode, 6, "a second holder of the name")
        check("held" in done.stderr, done.stderr)
        done = muster("send", "receiver", "x", "--as", "all", "--domain", domain)
        check(done.returncode in (2, 6), f"a reserved name: {done.returncode}")


def test_a_stopped_receiver_is_absent_and_comes_back():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        receiver = receiver_start(processes, domain, out / "record")
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        os.kill(receiver.pid, signal.SIGSTOP)
        wait_for(lambda: members(domain)["receiver"]["state"] == "absent", 5, "absence")
        done = muster("send", "receiver", "later", "--domain", domain)
        check_equal((done.returncode, done.stdout.strip()), (0, "stored"), "receipt")
        os.kill(receiver.pid, signal.SIGCONT)
        wait_for(lambda: whole_lines(out / "record"), 5, "the mail that waited")
        wait_for(lambda: members(domain)["receiver"]["state"] == "running", 5, "presence")


def test_a_broker_that_is_killed_is_replaced_and_agents_register_by_themselves():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain)
        receiver_start(processes, domain, out / "record")
        wait_for(lambda: "receiver" in members(domain), 5, "the receiver in the white pages")
        check_equal(muster("send", "receiver", "before", "--domain", domain).returncode, 0, "mail")
        broker.kill()
        broker.wait()
        broker_start(processes, domain)
        wait_for(lambda: "receiver" in members(domain), 15, "the receiver, by itself")
        done = muster("send", "receiver", "after", "--domain", domain)
        check_equal((done.returncode, done.stdout.strip()), (0, "delivered"), "receipt")
        check_equal([line.split()[2] for line in whole_lines(out / "record")],
                    ["before", "after"], "the receiver's mail")


CROWD = 200


def crowd_states(domain):
    return {m["state"] for name, m in members(domain).items() if name.startswith("c")}


def test_a_process_of_many_agents_is_stopped_continued_and_killed():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        crowd = processes.start(program("crowd"), domain, CROWD, stdout=subprocess.PIPE)
        check_equal(crowd.stdout.readline().decode().strip(), "all confirmed", "registrations")
        check_equal(crowd_states(domain), {"running"}, "states of all")
        crowd.send_signal(signal.SIGSTOP)
        wait_for(lambda: crowd_states(domain) == {"absent"}, 10, "all are absent")
        crowd.send_signal(signal.SIGCONT)
        wait_for(lambda: crowd_states(domain) == {"running"}, 10, "all are back")
        crowd.kill()
        wait_for(lambda: crowd_states(domain) == {"absent"}, 10, "all are gone")
        check_equal(len([n for n in members(domain) if n.startswith("c")]), CROWD, "names")
