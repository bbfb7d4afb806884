# SPDX-License-Identifier: Apache-2.0
"""Boxes that nobody empties, and a sender that floods them: everybody else's mail goes on."""
import os
import pathlib
import signal
import subprocess

from support import (MUSTER, Processes, check, check_equal, folder, members, muster, new_domain,
                     program, wait_for, whole_lines)

MAILS = 3000
FLOOD = 30000
# The store, the mail on its way through the network, and the broker itself.
BROKER_MB_MAX = 64 + 32 + 16


def broker_start(processes, domain, *options):
    p = processes.start(MUSTER, "broker", "main", "--domain", domain, *options)
    wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker that answers")
    return p


def resident_mb(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0]) / 1024


def receivers_start(processes, domain, out, *names):
    started = [processes.start(program("mail_receiver"), domain, name, out / name)
               for name in names]
    wait_for(lambda: set(names) <= set(members(domain)), 10, f"{names} in the white pages")
    return started


def bystanders_start(processes, domain):
    """Two pairs that have nothing to do with what else goes on."""
    return [processes.start(program("mail_sender"), domain, sender, receiver, MAILS, 60,
                            stdout=subprocess.PIPE)
            for sender, receiver in (("ann", "bob"), ("carl", "dora"))]


def bystanders_check(senders, out):
    for sender, receiver in zip(senders, ("bob", "dora")):
        output, _ = sender.communicate(timeout=70)
        check_equal(output.decode().strip(), f"delivered {MAILS}", f"receipts for {receiver}")
        counts = [int(line.split()[3]) for line in whole_lines(out / receiver)]
        check_equal(counts, list(range(1, MAILS + 1)), f"the mail of {receiver}, in order")


def flood(processes, domain, receiver, count, size):
    return processes.start(program("mail_flooder"), domain, "flooder", receiver, count, size,
                           stdout=subprocess.PIPE)


def flood_outcomes(flooder):
    output, _ = flooder.communicate(timeout=100)
    check_equal(flooder.returncode, 0, "the flooder has an answer for each mail")
    return {word: int(n) for word, n in (line.split() for line in output.decode().splitlines())}


def test_a_flood_to_a_suspended_receiver_hurts_nobody_else():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain)
        receivers_start(processes, domain, out, "lazy", "bob", "dora")
        check_equal(muster("suspend", "lazy", "--domain", domain).returncode, 0, "suspend")
        watcher = processes.start(program("event_watcher"), domain, stdout=subprocess.PIPE)
        check_equal(watcher.stdout.readline(), b"ready\n", "the event watcher")
        flooder = flood(processes, domain, "lazy", FLOOD, 100)
        senders = bystanders_start(processes, domain)
        bystanders_check(senders, out)
        told = flood_outcomes(flooder)
        # A lone sender's share of a box of 32768 is one half.
        check_equal((told["stored"], told["box-full"]), (16384, FLOOD - 16384), "the flooder")
        rss = resident_mb(broker.pid)
        check(rss < BROKER_MB_MAX, f"broker: {rss:.0f} MB")
        event = watcher.stdout.readline().decode().split()
        check_equal(event[:3], ["over-share", "lazy", "flooder"], "the event")
        done = muster("send", "lazy", "hello", "--domain", domain)
        check_equal((done.returncode, done.stdout.strip()), (0, "stored"), "another sender's mail")
        check_equal(whole_lines(out / "lazy"), [], "mail of a suspended agent")


def test_a_flood_of_large_mail_is_bounded_in_bytes():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain)
        receivers_start(processes, domain, out, "lazy", "bob", "dora")
        check_equal(muster("suspend", "lazy", "--domain", domain).returncode, 0, "suspend")
        before = resident_mb(broker.pid)
        flooder = flood(processes, domain, "lazy", 1500, 16384)
        senders = bystanders_start(processes, domain)
        bystanders_check(senders, out)
        told = flood_outcomes(flooder)
        check(900 < told["stored"] < 1024, f"half of a box's 32 MB: {told}")
        check_equal(told["stored"] + told["box-full"], 1500, "the flooder's answers")
        rss = resident_mb(broker.pid)
        check(rss < before + BROKER_MB_MAX, f"broker: {before:.0f} MB, then {rss:.0f} MB")


def test_a_stopped_receiver_hurts_nobody_else():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain)
        stopped = receivers_start(processes, domain, out, "stopped", "bob", "dora")[0]
        os.kill(stopped.pid, signal.SIGSTOP)
        flooder = flood(processes, domain, "stopped", FLOOD, 100)
        senders = bystanders_start(processes, domain)
        bystanders_check(senders, out)
        told = flood_outcomes(flooder)
        check_equal(told["box-full"], FLOOD - 16384, "the flooder")
        rss = resident_mb(broker.pid)
        check(rss < BROKER_MB_MAX, f"broker: {rss:.0f} MB")
        os.kill(stopped.pid, signal.SIGCONT)
        lines = wait_for(lambda: len(whole_lines(out / "stopped")) >= 16384 and
                         whole_lines(out / "stopped"), 30, "what had room in the box")
        numbers = [int(line.split()[0]) for line in lines]
        check_equal(numbers, list(range(1, 16385)), "its mail, in order")


def test_a_box_that_drops_keeps_the_youngest():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--box-mails", 5, "--box-policy", "drop-oldest")
        receivers_start(processes, domain, out, "lazy")
        check_equal(muster("suspend", "lazy", "--domain", domain).returncode, 0, "suspend")
        for i in range(8):
            done = muster("send", "lazy", f"m{i}", "--domain", domain)
            check_equal((done.returncode, done.stdout.strip()), (0, "stored"), f"mail {i}")
        check_equal(muster("resume", "lazy", "--domain", domain).returncode, 0, "resume")
        lines = wait_for(lambda: len(whole_lines(out / "lazy")) >= 5 and
                         whole_lines(out / "lazy"), 10, "the mail that was left")
        # A lone sender has all of so small a box, and pays with its own oldest mail.
        check_equal([line.split()[2] for line in lines], ["m3", "m4", "m5", "m6", "m7"], "mail")


def test_a_policy_that_does_not_exist():
    done = muster("broker", "main", "--box-policy", "sometimes")
    check_equal(done.returncode, 2, "exit code")
    check("drop-lowest" in done.stderr, done.stderr)
