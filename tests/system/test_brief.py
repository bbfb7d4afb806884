# SPDX-License-Identifier: Apache-2.0
"""Agents whose handlers are brief: mail is handled in the thread that has received it."""
import signal
import time

from support import (MUSTER, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for)

WHERE = ("where it came", "woken")


def agent_start(processes, domain, name="ann"):
    p = processes.start(program("mail_brief"), domain, name)
    wait_for(lambda: name in members(domain), 10, f"{name} in the white pages")
    return p


def told(domain, name, *words, wait_s=20):
    """What an agent answers."""
    done = muster("send", name, *words, "--wait", wait_s, "--domain", domain)
    check_equal(done.returncode, 0, f"{words}: {done.stderr}")
    who, _, answer = done.stdout.rstrip("\n").partition(": ")
    check_equal(who, name, "who answers")
    return answer


def test_mail_is_handled_where_it_came():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        agent_start(processes, domain)
        answers = [told(domain, "ann", "where") for _ in range(20)]
        check(set(answers) <= set(WHERE), f"{answers}")
        # Now and then the thread that lends its turn has just looked itself.
        check(answers.count("where it came") >= 10, f"{answers}")


def test_one_handler_at_a_time():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        agent_start(processes, domain)
        senders = [processes.start(MUSTER, "send", "ann", "work", 20, "--wait", 30, "--domain", domain,
                                   stdout=(out / f"{i}").open("w")) for i in range(12)]
        for p in senders:
            check_equal(p.wait(60), 0, "an answer")
        answers = [(out / f"{i}").read_text().strip() for i in range(12)]
        check(set(answers) <= {f"ann: {where}" for where in WHERE}, f"{answers}")


def test_who_joins_leaves_and_stops_in_a_handler():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        p = agent_start(processes, domain)
        check_equal(told(domain, "ann", "join bob"), "joined", "bob joins")
        wait_for(lambda: "bob" in members(domain), 10, "bob in the white pages")
        check(told(domain, "bob", "where") in WHERE, "he handles mail, too")
        check(told(domain, "ann", "leave") in WHERE, "he leaves")
        wait_for(lambda: members(domain)["bob"]["state"] == "absent", 10, "bob is gone")
        check(told(domain, "ann", "where") in WHERE, "ann goes on")
        check(told(domain, "ann", "stop") in WHERE, "ann has heard it")
        check_equal(p.wait(10), 0, "the process ends")
        wait_for(lambda: members(domain)["ann"]["state"] == "absent", 10, "ann is gone")


def test_a_handler_that_takes_long():
    """What the process misses meanwhile comes when it is done, and the agent is there again."""
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        agent_start(processes, domain)
        check(told(domain, "ann", "work 2500") in WHERE, "after more than its lease")
        wait_for(lambda: members(domain)["ann"]["state"] == "running", 10, "ann is there")
        check(told(domain, "ann", "where") in WHERE, "ann answers")


def test_brokers_that_are_killed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain, "--store", out / "store")
        agent_start(processes, domain)
        for _ in range(4):
            check(told(domain, "ann", "where") in WHERE, "ann answers")
            broker.kill()
            broker.wait()
            broker = broker_start(processes, domain, "--store", out / "store")
            wait_for(lambda: members(domain).get("ann", {}).get("state") == "running", 20,
                     "ann is back by herself")
        # Another broker takes her over.
        processes.start(MUSTER, "broker", "second", "--domain", domain, "--store", "none")
        wait_for(lambda: muster("ps", "--domain", domain, "--broker", "second").returncode == 0, 10,
                 "the second broker")
        broker.kill()
        broker.wait()
        wait_for(lambda: members(domain).get("ann", {}).get("state") == "running", 20,
                 "ann is with the second broker")
        check(told(domain, "ann", "where") in WHERE, "ann answers")


def test_a_process_that_is_stopped_goes_on():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        p = agent_start(processes, domain)
        for _ in range(3):
            p.send_signal(signal.SIGSTOP)
            time.sleep(1.5)
            p.send_signal(signal.SIGCONT)
            check(told(domain, "ann", "where") in WHERE, "ann answers")
