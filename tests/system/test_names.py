# SPDX-License-Identifier: Apache-2.0
"""Names end: those of agents that were disposed of at once; a full broker refuses new ones alone."""
import signal

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for)


def run(domain, *words):
    return muster(*words, "--domain", domain)


def state(domain, name):
    return members(domain).get(name, {}).get("state")


def is_unknown(domain, name):
    """Mail for the name is answered: no agent has it."""
    done = run(domain, "send", name, "tell", "42", "--wait", 5)
    return done.returncode == 7 and f"to {name}: unknown-name" in done.stderr


def lines_of(domain, name):
    """The groups and services of an agent."""
    lines = [f"group {group}" for group in ("scouts",)
             if name in run(domain, "group", "members", group).stdout.split()]
    return lines + [line for line in run(domain, "service", "find", "*").stdout.splitlines()
                    if name in line]


def agent_start(processes, domain, name, record, *attributes):
    process = processes.start(program("pages_agent"), domain, name, record, *attributes)
    wait_for(lambda: state(domain, name) == "running", 10, f"{name} is there")
    return process


def ends_at_once(processes, domain, out):
    """ann, in a group and with a service, is disposed of while a mail waits for her name."""
    agent = agent_start(processes, domain, "ann", out / "first", "role=scout")
    wait_for(lambda: len(lines_of(domain, "ann")) == 2, 10, "a group and a service")
    check_equal(run(domain, "suspend", "ann").returncode, 0, "suspend")
    wait_for(lambda: state(domain, "ann") == "suspended", 10, "it is suspended")
    check_equal(run(domain, "send", "ann", "tell", "waits", "--level", "logged").returncode, 0, "mail")
    check_equal(run(domain, "dispose", "ann").returncode, 0, "dispose")
    wait_for(lambda: is_unknown(domain, "ann"), 2, "its name has ended")
    check_equal(lines_of(domain, "ann"), [], "what it had")
    agent.kill()


def inherits_nothing(processes, domain, out):
    """The next ann, a plain one, has only what is said to it."""
    processes.start(program("mail_receiver"), domain, "ann", out / "next")
    wait_for(lambda: state(domain, "ann") == "running", 10, "the next one")
    check_equal(run(domain, "send", "ann", "tell", "new").returncode, 0, "mail")
    wait_for(lambda: "new" in (out / "next").read_text(), 10, "its mail")
    check("waits" not in (out / "next").read_text(), (out / "next").read_text())
    check_equal(lines_of(domain, "ann"), [], "groups and services")


def test_a_name_ends_with_its_agent():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain, "--store", out / "store.db")
        ends_at_once(processes, domain, out)
        inherits_nothing(processes, domain, out)


def test_a_name_that_has_ended_is_unknown_after_a_restart():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain, "--store", out / "store.db")
        processes.start(program("mail_answerer"), domain, "bob")
        wait_for(lambda: state(domain, "bob") == "running", 10, "bob")
        ends_at_once(processes, domain, out)
        broker.send_signal(signal.SIGKILL)
        broker.wait()
        broker_start(processes, domain, "--store", out / "store.db")
        wait_for(lambda: state(domain, "bob") == "running", 10, "bob is back")
        check(is_unknown(domain, "ann"), "no agent has the name")
        check_equal(state(domain, "ann"), None, "nor has it a line")
        inherits_nothing(processes, domain, out)


def test_a_peer_ends_it_too():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        processes.start(MUSTER, "broker", "west", "--domain", domain)
        wait_for(lambda: run(domain, "ps", "--broker", "west").returncode == 0, 10, "another broker")
        processes.start(program("pages_agent"), domain, "ann", out / "first", "role=scout", "west")
        wait_for(lambda: len(lines_of(domain, "ann")) == 2, 10, "an agent at the other broker")
        check_equal(run(domain, "dispose", "ann").returncode, 0, "dispose, from beyond")
        for broker in ("main", "west"):
            wait_for(lambda: is_unknown(domain, "ann"), 5, f"unknown at {broker}")
        check_equal(lines_of(domain, "ann"), [], "what it had")
        wait_for(lambda: state(domain, "ann") is None, 10, "its line goes")


def test_a_full_broker_refuses_new_names_alone():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain, "--names", 3)
        for name in ("ann", "bob", "cid"):
            processes.start(program("mail_answerer"), domain, name)
        wait_for(lambda: {"ann", "bob", "cid"} <= set(members(domain)), 10, "three")
        done = run(domain, "robot", "dan", "--rules", ROOT / "rules/follower.clp")
        check(done.returncode != 0 and "the white pages are full" in done.stderr, done.stderr)
        processes.start(program("mail_answerer"), domain, "eve")
        for name in ("ann", "bob", "cid"):
            done = run(domain, "send", name, "tell", "42", "--wait", 10)
            check_equal((done.returncode, done.stdout), (0, f"{name}: 42\n"), done.stderr)
        check_equal(state(domain, "eve"), None, "there is no room")
        check_equal(run(domain, "dispose", "bob").returncode, 0, "dispose")
        wait_for(lambda: state(domain, "eve") == "running", 15, "eve asks again, and has bob's room")
