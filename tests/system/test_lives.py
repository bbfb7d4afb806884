# SPDX-License-Identifier: Apache-2.0
"""Agents that leave and come again in one process: nothing that they said is lost."""
import signal
import subprocess
import time

from support import MUSTER, Processes, check, members, new_domain, program, wait_for


def broker_start(processes, domain):
    broker = processes.start(MUSTER, "broker", "main", "--store", "none", "--domain", domain)
    wait_for(lambda: members(domain), 10, "the broker")
    return broker


def all_came(done):
    some, of, most = done.splitlines()[-1].split()
    check(of == "of" and some == most and int(most) > 0, done)


def lives(word):
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        done = subprocess.run([program("mail_lives"), str(domain), word], capture_output=True, text=True, timeout=150)
        all_came(done.stdout + done.stderr)


def test_each_life_in_one_place_is_accepted():
    lives("again")


def test_first_words_of_the_next_life():
    lives("words")


def test_what_is_said_when_a_process_is_closed():
    lives("close")


def test_last_words_wait_for_a_broker_that_is_stopped():
    domain = new_domain()
    with Processes() as processes:
        broker = broker_start(processes, domain)
        crowd = processes.start(program("mail_lives"), domain, "crowd", stdin=subprocess.PIPE,
                                stdout=subprocess.PIPE, text=True)
        check(crowd.stdout.readline() == "ready\n", "the crowd is there")
        broker.send_signal(signal.SIGSTOP)
        crowd.stdin.write("\n")
        crowd.stdin.flush()
        time.sleep(0.3)
        broker.send_signal(signal.SIGCONT)
        done, _ = crowd.communicate(timeout=60)
        all_came(done)
