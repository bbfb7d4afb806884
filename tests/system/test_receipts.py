# SPDX-License-Identifier: Apache-2.0
"""The last word on a mail is the last, whatever becomes of the broker that said it."""
import signal

from actors import Actor
from support import (MUSTER, Processes, broker_start, check_equal, folder, members, muster,
                     new_domain, wait_for)


def broker_again(processes, domain, broker, store="none"):
    broker.kill()
    broker.wait()
    return processes.start(MUSTER, "broker", "main", "--domain", domain, "--store", store)


def test_what_a_box_refused_stays_refused():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain, "--store", "none")
        rx, slow, tx = (Actor(processes, domain, out / name) for name in ("rx", "slow", "tx"))
        rx.join("rx", 0, 0, 5)
        slow.join("slow")
        tx.join("tx")
        rx.tell("state", "rx", "suspended")
        wait_for(lambda: members(domain)["rx"]["state"] == "suspended", 20, "it is suspended")
        tx.send("tx", "rx", 5)
        wait_for(lambda: len(tx.told("tx")) == 5, 20, "it is full")
        slow.process.send_signal(signal.SIGSTOP)
        tx.send("tx", "slow", 1)  # keeps what comes behind it in the outbox
        tx.send("tx", "rx", 10)
        wait_for(lambda: len(tx.told("tx")) == 15, 20, "the others are refused")
        check_equal(set(map(tuple, list(tx.told("tx").values())[5:])), {("box-full",)}, "told")
        rx.tell("state", "rx", "running")
        broker_again(processes, domain, broker)
        slow.process.send_signal(signal.SIGCONT)
        wait_for(lambda: slow.taken("slow", "tx"), 20, "mail for whom was stopped")
        wait_for(lambda: "rx" in members(domain), 20, "the new broker knows it")
        tx.send("tx", "rx", 1)
        wait_for(lambda: 17 in rx.taken("rx", "tx"), 20, "a later mail")
        taken = rx.taken("rx", "tx")
        check_equal([n for n in taken if 6 < n < 17], [], "taken of what was refused")
        check_equal(sorted(set(taken)), taken, "each once, and in order")
        told = tx.told("tx")
        check_equal([told[n] for n in range(7, 17)], [["box-full"]] * 10, "one word on each")


def waiting(domain):
    """How many mails wait in boxes."""
    done = muster("lookup", "broker.mail", "--domain", domain)
    words = [line.split() for line in done.stdout.splitlines()]
    return sum(int(w[1]) for w in words if w[0] == "waiting")


def test_mail_of_all_levels_stays_in_order():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain, "--store", out / "main.db")
        rx, tx = (Actor(processes, domain, out / name) for name in ("rx", "tx"))
        rx.join("rx")
        tx.join("tx")
        for _ in range(2):
            rx.process.send_signal(signal.SIGSTOP)
            tx.send("tx", "rx", 300, 0, "rrrls", "012")
            wait_for(lambda: waiting(domain) == 300, 20, "the broker has them")
            durable = [int(line[0]) for line in tx.lines("S", "tx") if line[2] != "r"]
            broker = broker_again(processes, domain, broker, out / "main.db")
            wait_for(lambda: all(tx.told("tx").get(n) for n in durable), 20, "they are safe")
            rx.process.send_signal(signal.SIGCONT)
            wait_for(lambda: tx.settled("tx"), 20, "all answered")
        taken = [(int(line[2]), line[3]) for line in rx.lines("M", "rx")]
        check_equal(sorted(n for n, _ in taken), tx.sent("tx"), "each once")
        for priority in ("-1", "0", "1"):
            numbers = [n for n, p in taken if p == priority]
            check_equal(numbers, sorted(numbers), f"in order, of priority {priority}")
