# SPDX-License-Identifier: Apache-2.0
"""What handlers of mail may do: take long, let agents join and leave, and stop the process."""
import signal
import time

from support import (MUSTER, Processes, broker_start, check_equal, folder, members, muster,
                     new_domain, program, wait_for)


def agent_start(processes, domain, name="ann"):
    p = processes.start(program("mail_handler"), domain, name)
    wait_for(lambda: name in members(domain), 10, f"{name} in the white pages")
    return p


def told(domain, name, *words, wait_s=20):
    """What an agent answers."""
    done = muster("send", name, *words, "--wait", wait_s, "--domain", domain)
    check_equal(done.returncode, 0, f"{words}: {done.stderr}")
    who, _, answer = done.stdout.rstrip("\n").partition(": ")
    check_equal(who, name, "who answers")
    return answer


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
        check_equal(set(answers), {"ann: done"}, "the answers")


def test_who_joins_leaves_and_stops_in_a_handler():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        p = agent_start(processes, domain)
        check_equal(told(domain, "ann", "join bob"), "joined", "bob joins")
        wait_for(lambda: "bob" in members(domain), 10, "bob in the white pages")
        check_equal(told(domain, "bob", "greet"), "done", "he handles mail, too")
        check_equal(told(domain, "ann", "leave"), "done", "he leaves")
        wait_for(lambda: members(domain)["bob"]["state"] == "absent", 10, "bob is gone")
        check_equal(told(domain, "ann", "greet"), "done", "ann goes on")
        check_equal(told(domain, "ann", "stop"), "done", "ann has heard it")
        check_equal(p.wait(10), 0, "the process ends")
        wait_for(lambda: members(domain)["ann"]["state"] == "absent", 10, "ann is gone")


def test_a_handler_that_takes_long():
    """What the process misses meanwhile comes when it is done, and the agent is there again."""
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        agent_start(processes, domain)
        check_equal(told(domain, "ann", "work 2500"), "done", "after more than its lease")
        wait_for(lambda: members(domain)["ann"]["state"] == "running", 10, "ann is there")
        check_equal(told(domain, "ann", "greet"), "done", "ann answers")


def test_brokers_that_are_killed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker = broker_start(processes, domain, "--store", out / "store")
        agent_start(processes, domain)
        for _ in range(4):
            check_equal(told(domain, "ann", "greet"), "done", "ann answers")
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
        check_equal(told(domain, "ann", "greet"), "done", "ann answers")


def test_a_process_that_is_stopped_goes_on():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        p = agent_start(processes, domain)
        for _ in range(3):
            p.send_signal(signal.SIGSTOP)
            time.sleep(1.5)
            p.send_signal(signal.SIGCONT)
            check_equal(told(domain, "ann", "greet"), "done", "ann answers")
