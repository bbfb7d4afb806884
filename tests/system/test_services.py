# SPDX-License-Identifier: Apache-2.0
"""The yellow pages from the command line."""
import json

from support import (Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for)


def service(domain, *words):
    return muster("service", *words, "--domain", domain)


def found(domain, *query):
    done = service(domain, "find", *query, "--json")
    check_equal(done.returncode, 0, done.stderr)
    return [(o["service"], o["agent"]) for o in map(json.loads, done.stdout.splitlines())]


def team_start(processes, domain, out, *names):
    started = [processes.start(program("mail_receiver"), domain, name, out / name)
               for name in names]
    wait_for(lambda: set(names) <= set(members(domain)), 10, f"{names}")
    return started


def test_services_are_added_found_and_removed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        team_start(processes, domain, out, "ann", "bob")
        for words in (("mapper", "role=scout", "battery=0.8", "x=1", "y=1", "--as", "ann"),
                      ("mapper", "role=cook", "battery=0.3", "x=9", "y=9", "--as", "bob"),
                      ("gripper", "--as", "bob")):
            done = service(domain, "add", *words)
            check_equal((done.returncode, done.stderr), (0, ""), f"{words}")
        check_equal(found(domain, "mapper"), [("mapper", "ann"), ("mapper", "bob")], "by name")
        check_equal(found(domain, "mapper", "role=scout"), [("mapper", "ann")], "by a word")
        check_equal(found(domain, "mapper battery<0.5"), [("mapper", "bob")], "by a number")
        check_equal(found(domain, "*", "near=0,0,2"), [("mapper", "ann")], "by a place")
        check_equal(found(domain, "cook"), [], "nobody")
        done = service(domain, "list", "--json")
        check_equal(json.loads(done.stdout.splitlines()[1]),
                    {"service": "mapper", "agent": "ann", "state": "running", "attributes":
                     {"role": "scout", "battery": "0.8", "x": "1", "y": "1"}}, "an object")
        check_equal(service(domain, "list").stdout.split("\n")[1].split(),
                    ["gripper", "bob", "running"], "a table")
        check_equal(service(domain, "remove", "mapper", "--as", "ann").returncode, 0, "remove")
        check_equal(found(domain, "mapper"), [("mapper", "bob")], "one is left")
        done = service(domain, "remove", "mapper", "--as", "ann")
        check_equal(done.returncode, 7, "it is offered no more")
        check("not-offered" in done.stderr, done.stderr)


def test_a_service_is_shown_while_its_agent_is_there_and_its_lease_lasts():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        agent = team_start(processes, domain, out, "ann")[0]
        service(domain, "add", "mapper", "--as", "ann")
        service(domain, "add", "brief", "--as", "ann", "--lease", "0.5")
        wait_for(lambda: found(domain, "*") == [("mapper", "ann")], 10, "the end of the lease")
        agent.terminate()
        agent.wait()
        wait_for(lambda: found(domain, "*") == [], 10, "the end of the agent")
        done = service(domain, "add", "gripper", "--as", "ann")
        check_equal(done.returncode, 0, "an offer of who is absent")
        check("only while ann is there" in done.stderr, done.stderr)
        done = service(domain, "add", "clock")
        check("only while operator is there" in done.stderr, done.stderr)
        team_start(processes, domain, out, "ann")
        wait_for(lambda: {("gripper", "ann"), ("mapper", "ann")} <= set(found(domain, "*")), 10,
                 "what ann offers, with ann")


def test_what_is_no_service_is_refused_with_what_is_right():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        for name in ("a b", "*", '"a"', "", "a\nb", "x" * 32, "x" * 10000):
            for words in (("add", name), ("remove", name), ("add", "mapper", "--as", name)):
                done = service(domain, *words)
                check_equal(done.returncode, 2, f"{words}: {done.stderr}")
                check("[A-Za-z_]" in done.stderr and len(done.stderr) < 300, done.stderr)
        for attributes in (["role"], ["=1"], ["a=1", "a=2"], ["a="], ["a=\n"], ["1=a"],
                           ["a=" + "x" * 64], [f"k{i}=xxxxxxxxxx" for i in range(20)]):
            done = service(domain, "add", "mapper", *attributes)
            check_equal(done.returncode, 2, f"{attributes}: {done.stderr}")
            check("KEY=VALUE" in done.stderr, done.stderr)
        for query in (["a b"], ["mapper", "x>"], ["1st"], [""], ["mapper", "near=1"],
                      ["mapper"] + ["a=1"] * 17, ["x" * 10000]):
            done = service(domain, "find", *query)
            check_equal(done.returncode, 2, f"{query}: {done.stderr}")
            check("role=scout" in done.stderr, done.stderr)
        for words in ((), ("find",), ("add",), ("list", "more"), ("add", "m", "--lease", "-1"),
                      ("add", "m", "--lease", "nan"), ("remove", "m", "n")):
            check_equal(service(domain, *words).returncode, 2, f"{words}")
        check_equal(muster("service", "list", "--domain", new_domain()).returncode, 4, "no broker")
