# SPDX-License-Identifier: Apache-2.0
"""Waiting for others: muster wait, programs that come before their broker, runs that live and have
ended."""
import os

from support import (FOLLOW, MUSTER, Processes, broker_start, check, check_equal, folder, muster,
                     new_domain, wait_for)


def test_wait_returns_when_all_are_there():
    domain = new_domain()
    with Processes() as processes:
        waiting = processes.start(MUSTER, "wait", "red", "--hosts", 2, "--timeout", 60, "--domain",
                                  domain)
        broker_start(processes, domain, "--store", "none")
        check_equal(muster("wait", "--broker", "--domain", domain).returncode, 0, "a broker")
        check_equal(muster("wait", "--broker", "main", "--domain", domain).returncode, 0, "main")
        processes.start(MUSTER, "host", "north", "--domain", domain)
        check_equal(muster("wait", "--hosts", 1, "--domain", domain).returncode, 0, "a host")
        done = muster("wait", "red", "--hosts", 2, "--timeout", "2", "--domain", domain)
        check_equal((done.returncode, done.stderr),
                    (124, "muster wait: not there after 2 s: 1 of 2 hosts, red\n"), "too early")
        check(waiting.poll() is None, "it waits")
        processes.start(MUSTER, "host", "south", "--domain", domain)
        check_equal(muster("wait", "--hosts", 2, "--domain", domain).returncode, 0, "two hosts")
        check_equal(muster("launch", "red", "south", "--rules", "rules/follower.clp", "--domain",
                           domain).returncode, 0, "red")
        check_equal(waiting.wait(30), 0, "all are there")


def test_wait_for_a_run():
    domain = new_domain()
    with Processes() as processes, folder() as out:
        waiting = processes.start(MUSTER, "wait", "--run", "red", "--domain", domain)
        processes.start(MUSTER, "run", FOLLOW, "--rate", 1, "--duration", 60, "--quiet", "--out",
                        out / "r", "--domain", domain)
        check_equal(waiting.wait(30), 0, "the run has begun")


def test_wait_for_a_service():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain, "--store", "none")
        done = muster("wait", "--service", "map hz>=1", "--timeout", "2", "--domain", domain)
        check_equal((done.returncode, done.stderr),
                    (124, "muster wait: not there after 2 s: the service map hz>=1\n"), "nobody")
        processes.start(MUSTER, "robot", "red", "--rules", "rules/follower.clp", "--service",
                        "map hz=2", "--domain", domain)
        check_equal(muster("wait", "--service", "map hz>=1", "--domain", domain).returncode, 0, "red")
    check_equal(muster("wait", "--service", "a>=").returncode, 2, "no query")


def test_wait_ends_without_anybody():
    for words, missing in ((("--broker",), "no broker answers"), (("red",), "no broker answers"),
                           (("--broker", "west"), "no broker named west answers")):
        done = muster("wait", *words, "--timeout", "0.2", "--domain", new_domain())
        check_equal(done.returncode, 124, done.stderr)
        check(missing in done.stderr, done.stderr)
    check_equal(muster("wait").returncode, 2, "nobody is named")


def test_who_comes_before_the_broker_waits_for_it():
    domain = new_domain()
    with Processes() as processes, folder() as out:
        with open(out / "said", "w") as said:
            processes.start(MUSTER, "robot", "red", "--rules", "rules/follower.clp", "--domain",
                            domain, "--wait-broker", 60, stderr=said)
        wait_for(lambda: f"waits for a broker in domain {domain}" in (out / "said").read_text(), 20,
                 "what it waits for")
        broker_start(processes, domain, "--store", "none")
        check_equal(muster("wait", "red", "--domain", domain).returncode, 0, "red")


def test_runs_that_live_and_have_ended():
    with Processes() as processes, folder() as out:
        (out / "runs").mkdir(mode=0o700)
        env = {**os.environ, "XDG_RUNTIME_DIR": str(out / "runs"), "MUSTER_STORE": "none"}
        env.pop("MUSTER_DOMAIN", None)
        domain = new_domain()
        run = processes.start(MUSTER, "run", FOLLOW, "--rate", 1, "--quiet", "--out", out / "r",
                              "--domain", domain, env=env)
        wait_for(lambda: f"--domain {domain}  follow" in muster(env=env).stdout, 20, "a line of it")
        check("muster ps" in muster(env=env).stdout, "what to try")
        other = ("--domain", new_domain())
        done = muster("ps", *other, "--wait-broker", "0.2", env=env)
        check(f"runs that live:\n  --domain {domain}  follow\n" in done.stderr, done.stderr)
        run.terminate()
        run.wait(30)
        check(f"--domain {domain} " not in muster(env=env).stdout, "it lives no more")
        for words, has in ((("--domain", domain), True), ((), True), (other, False)):
            done = muster("ps", *words, "--wait-broker", "0.2", env=env)
            check_equal(done.returncode, 4, done.stderr)
            check_equal(("the run follow ended " in done.stderr, str(out / "r") in done.stderr),
                        (has, has), done.stderr)


def test_who_asks_for_one_of_several_runs_says_which():
    with Processes() as processes, folder() as out:
        (out / "runs").mkdir(mode=0o700)
        env = {**os.environ, "XDG_RUNTIME_DIR": str(out / "runs"), "MUSTER_STORE": "none"}
        env.pop("MUSTER_DOMAIN", None)
        domains = [new_domain(), new_domain()]
        for domain in domains:
            processes.start(MUSTER, "run", FOLLOW, "--rate", 1, "--quiet", "--out", out / str(domain),
                            "--domain", domain, env=env)
            check_equal(muster("wait", "--run", "--domain", domain, env=env).returncode, 0, "a run")
        for words in (("ps",), ("web", "--port", 0), ("top", "--once"), ("do", "red", "(now)"),
                      ("world", "reset"), ("wait", "red"), ("send", "red", "hello")):
            done = muster(*words, env=env, timeout=20)
            check_equal(done.returncode, 10, f"{words}: {done.stderr}")
            check(all(f"--domain {domain}  follow" in done.stderr for domain in domains), done.stderr)


def test_a_folder_that_is_not_there_is_passed_over():
    with folder() as out:
        env = {**os.environ, "XDG_RUNTIME_DIR": str(out / "none"), "MUSTER_STORE": "none"}
        done = muster("run", FOLLOW, "--duration", "0.1", "--quiet", "--out", out / "r", "--domain",
                      new_domain(), env=env)
        check_equal(done.returncode, 0, done.stderr)


def test_a_folder_that_others_may_write_to_is_refused():
    with folder() as out:
        (out / "muster").mkdir()
        (out / "muster").chmod(0o777)
        other = f"/tmp/muster-{os.getuid()}"
        env = {**os.environ, "XDG_RUNTIME_DIR": str(out), "MUSTER_STORE": "none"}
        done = muster("run", FOLLOW, "--duration", "0.1", "--quiet", "--out", out / "r", "--domain",
                      new_domain(), env=env)
        check_equal(done.returncode, 0, f"{other} stands in for it: {done.stderr}")
