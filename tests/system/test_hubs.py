# SPDX-License-Identifier: Apache-2.0
"""Several brokers: which one an agent is with, and what happens when that is silent."""
import json
import signal
import subprocess

from netns import Hosts
from support import (MUSTER, ROOT, Processes, check, check_equal, folder, muster, new_domain,
                     program, wait_for, whole_lines)


def brokers_start(processes, domain, *names):
    started = []
    for name in names:
        started.append(processes.start(MUSTER, "broker", name, "--domain", domain))
        wait_for(lambda n=name: pages(domain, n), 10, f"broker {name}")
    return started


def pages(domain, broker):
    """The white pages of one broker, by name; None: it does not answer."""
    done = muster("ps", "--json", "--domain", domain, "--broker", broker)
    if done.returncode != 0:
        return None
    return {m["name"]: m for m in map(json.loads, done.stdout.splitlines())}


def lives_at(domain, broker, name):
    member = (pages(domain, broker) or {}).get(name)
    return member is not None and (member["state"], member["broker"]) == ("running", broker)


def broker_of(domain):
    """Who answers an agent that does not care."""
    done = muster("lookup", "broker", "--json", "--domain", domain)
    return json.loads(done.stdout)["broker"] if done.returncode == 0 else None


def receiver_start(processes, domain, record):
    return processes.start(program("mail_receiver"), domain, "rx", record)


def contents(record):
    return [line.split(" ", 2)[2] for line in whole_lines(record)]


def test_four_brokers_live_on_a_host():
    domain = new_domain()
    with Processes() as processes:
        brokers_start(processes, domain, "a", "b", "c", "d")
        done = muster("broker", "e", "--domain", domain)
        check_equal(done.returncode, 4, "a fifth broker")
        check("as many brokers" in done.stderr, done.stderr)
        check_equal(broker_of(domain), "a", "the first one of this host")
        for name in "abcd":
            check_equal(pages(domain, name)["broker"]["broker"], name, "who answers")
        done = muster("ps", "--domain", domain, "--broker", "nobody", timeout=60)
        check_equal(done.returncode, 4, "a broker that is not there")
        check("muster broker nobody" in done.stderr, done.stderr)


def test_of_two_brokers_with_one_name_the_earlier_one_stays():
    domain = new_domain()
    with Processes() as processes:
        first, second = brokers_start(processes, domain, "a", "b")
        for name in ("a", "b"):
            done = muster("broker", name, "--domain", domain)
            check_equal(done.returncode, 4, f"a second {name}")
            check("already" in done.stderr and name in done.stderr, done.stderr)
        check(first.poll() is None and second.poll() is None, "the first ones live")
        check_equal(broker_of(domain), "a", "who answers")


def test_agents_leave_a_broker_that_is_killed_and_stay_when_it_is_back():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        first, _ = brokers_start(processes, domain, "a", "b")
        receiver_start(processes, domain, out / "rx")
        wait_for(lambda: lives_at(domain, "a", "rx"), 10, "rx at a")
        first.kill()
        wait_for(lambda: lives_at(domain, "b", "rx"), 10, "rx at b")
        check_equal(muster("send", "rx", "one", "--domain", domain).returncode, 0, "mail")
        brokers_start(processes, domain, "a")
        check_equal(muster("send", "rx", "two", "--domain", domain, "--broker", "b").returncode, 0,
                    "mail")
        check(lives_at(domain, "b", "rx"), "rx has stayed at b")
        wait_for(lambda: (pages(domain, "a").get("rx") or {}).get("broker") == "b", 10,
                 "a knows that rx has not gone back to it")
        wait_for(lambda: contents(out / "rx") == ["one", "two"], 5, "each mail once")


def test_a_broker_that_was_stopped_lets_its_agents_go():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        first, _ = brokers_start(processes, domain, "a", "b")
        receiver_start(processes, domain, out / "rx")
        wait_for(lambda: lives_at(domain, "a", "rx"), 10, "rx at a")
        first.send_signal(signal.SIGSTOP)
        wait_for(lambda: lives_at(domain, "b", "rx"), 10, "rx at b")
        first.send_signal(signal.SIGCONT)
        wait_for(lambda: (pages(domain, "a") or {}).get("rx", {}).get("broker") == "b", 10,
                 "a knows that rx is elsewhere")
        check_equal(pages(domain, "b")["rx"]["broker"], "b", "rx has stayed at b")
        check_equal(muster("send", "rx", "x", "--domain", domain, "--broker", "b").stdout.strip(),
                    "delivered", "mail")
        wait_for(lambda: contents(out / "rx") == ["x"], 5, "the mail once")


def test_a_lone_broker_that_was_stopped_keeps_its_agents():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        lone, = brokers_start(processes, domain, "a")
        receiver_start(processes, domain, out / "rx")
        wait_for(lambda: lives_at(domain, "a", "rx"), 10, "rx at a")
        lone.send_signal(signal.SIGSTOP)
        check_equal(muster("ps", "--domain", domain, timeout=60).returncode, 4, "nobody answers")
        lone.send_signal(signal.SIGCONT)
        wait_for(lambda: lives_at(domain, "a", "rx"), 10, "rx at a")
        check_equal(muster("send", "rx", "x", "--domain", domain).returncode, 0, "mail")
        wait_for(lambda: contents(out / "rx") == ["x"], 5, "the mail once")


EXPERIMENT = """
world: {root}/worlds/arena.world
duration: 2
brokers: [a, b]
robots:
  - {{name: red, rules: {root}/rules/follower.clp}}
  - {{name: blue, rules: {root}/rules/follower.clp{broker}}}
"""


def test_an_experiment_has_two_brokers():
    with folder() as out:
        file = out / "two.yaml"

        def run(broker, *words):
            file.write_text(EXPERIMENT.format(root=ROOT, broker=broker))
            return muster("run", file, "--out", out / "report", "--quiet", *words)

        plain = run("")
        check_equal(plain.returncode, 0, f"lock step with the first broker: {plain.stderr}")
        apart = run(", broker: b")
        check_equal(apart.returncode, 3, "two brokers in lock step")
        check("two.yaml:7:" in apart.stderr and "--free" in apart.stderr, apart.stderr)
        free = run(", broker: b", "--free")
        check_equal(free.returncode, 0, f"free running: {free.stderr}")
        unknown = run(", broker: c", "--free")
        check_equal(unknown.returncode, 3, "a broker that the file does not name")
        check("brokers" in unknown.stderr, unknown.stderr)


def test_two_hosts_find_each_other():
    domain = new_domain()
    with Hosts() as hosts, folder() as out, Processes() as processes:
        def on(host, *words):
            return hosts.on(host, MUSTER, *words, "--domain", domain, "--interface",
                            hosts.addresses[host], "--peer", ",".join(hosts.addresses))

        def run_on(host, *words):
            return subprocess.run(on(host, *words), capture_output=True, text=True, timeout=60)

        with open(out / "a.log", "w") as log:
            processes.start(*on(0, "broker", "a", "--verbose"), stderr=log)
        wait_for(lambda: run_on(1, "ps").returncode == 0, 10, "a's broker answers b's host")

        robot = processes.start(*on(1, "robot", "red", "--rules", ROOT / "rules/follower.clp"))
        wait_for(lambda: "red" in run_on(1, "ps").stdout, 10, "a robot on the other host")

        with open(out / "b.log", "w") as log:
            processes.start(*on(1, "broker", "b", "--verbose"), stderr=log)
        for log, other in (("a.log", "b"), ("b.log", "a")):
            wait_for(lambda: f"broker-met name={other}" in (out / log).read_text(), 10,
                     f"{other} in {log}")
        check(robot.poll() is None, "the robot lives")

        hosts.cut()
        wait_for(lambda: "broker-lost name=b" in (out / "a.log").read_text(), 15, "the cut at a")
        wait_for(lambda: "red" in run_on(1, "ps", "--broker", "b").stdout, 15,
                 "the robot goes to the broker on its side")
        hosts.mend()
        wait_for(lambda: (out / "a.log").read_text().count("broker-met name=b") > 1, 20,
                 "b is back at a")
