# SPDX-License-Identifier: Apache-2.0
"""muster doctor: a line for each thing that muster needs, with its cure."""
import json
import os
import resource
import subprocess

from support import (FOLLOW, MUSTER, Processes, Skip, check, check_equal, folder, muster, new_domain, wait_for)

CHECKS = ["domain", "interface", "loopback", "domains", "participants", "left processes", "configuration",
          "peers", "sockets", "open files", "processes", "receive buffer", "memory", "folder", "programs", "rules",
          "versions"]


def findings(*words, code=0, **kwargs):
    done = muster("doctor", "--json", *words, **kwargs)
    check_equal(done.returncode, code, done.stdout)
    check_equal(json.loads(done.stderr)["exit"] if code else done.stderr, code or "", "standard error")
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    check_equal([f["check"] for f in lines], CHECKS, "checks")
    for f in lines:
        check(f["state"] in ("ok", "warning", "wrong") and f["found"], f"{f}")
        check_equal("cure" in f, f["state"] != "ok", f"a cure of {f}")
    return {f["check"]: f for f in lines}


def test_a_machine_on_which_muster_runs():
    found = findings()
    check_equal(found["interface"]["found"], "127.0.0.1, loopback alone", "interface")
    check_equal((found["loopback"]["state"], found["programs"]["state"]), ("ok", "ok"), "ok")
    check("Cyclone DDS 0." in found["versions"]["found"], found["versions"])
    text = muster("doctor").stdout
    check(text.count("\n") >= len(CHECKS) and "ok       loopback" in text, text)


def test_where_values_come_from():
    domain = new_domain()
    found = findings("--domain", domain, "--peer", "10.0.0.1")
    check_equal((found["domain"]["found"], found["domain"]["from"]), (str(domain), "the option"), "domain")
    check_equal(found["peers"]["state"], "warning", "a peer, and loopback alone")
    environment = {**os.environ, "MUSTER_DOMAIN": str(domain), "CYCLONEDDS_URI": "<a/>"}
    found = findings(env=environment)
    check_equal(found["domain"]["from"], "MUSTER_DOMAIN", "domain")
    check_equal(found["configuration"]["cure"], "unset CYCLONEDDS_URI", "configuration")


def test_what_is_wrong_has_a_code_and_a_cure():
    found = findings("--interface", "10.9.9.9", code=11)
    check("no such IPv4 address" in found["interface"]["found"], found["interface"])
    few = findings(code=5, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (64, 64)))
    check_equal(few["open files"]["cure"], "ulimit -n 1024", "open files")
    found = findings(code=3, env={**os.environ, "MUSTER_RULES": "/nowhere"})
    check_equal((found["rules"]["state"], found["rules"]["from"]), ("wrong", "MUSTER_RULES"), "rules")
    found = findings("--local", "maybe", code=2)
    check("'maybe'" in found["sockets"]["found"], found["sockets"])
    text = muster("doctor", "--interface", "10.9.9.9")
    check_equal(text.returncode, 11, text.stdout)
    check("wrong    interface" in text.stdout and "cure: ip -4 -brief address" in text.stdout, text.stdout)


def test_a_device_that_is_down_is_named():
    alone = ["unshare", "--map-root-user", "--net"]
    if subprocess.run([*alone, "true"], capture_output=True).returncode != 0:
        raise Skip("no network namespaces here, as in a container without the right to make them")

    def there(*words):
        return subprocess.run([*alone, MUSTER, *words], capture_output=True, text=True, timeout=60)

    for words in (("ps", "--domain", 0), ("broker", "main", "--domain", 0, "--store", "none")):
        done = there(*map(str, words))
        check_equal(done.returncode, 11, f"{words}: {done.stderr}")
        check("the network device lo is down: sudo ip link set lo up" in done.stderr, done.stderr)
    found = [json.loads(line) for line in there("doctor", "--json").stdout.splitlines()]
    row = next(f for f in found if f["check"] == "interface")
    check_equal((row["state"], row["cure"]), ("wrong", "sudo ip link set lo up"), row)


def test_runs_that_live_and_processes_that_are_left():
    domain, other = new_domain(), new_domain()
    with Processes() as processes, folder() as out:
        left = processes.start(MUSTER, "host", "north", "--domain", other)
        processes.start(MUSTER, "run", FOLLOW, "--rate", 1, "--duration", 60, "--domain", domain, "--out",
                        out / "r")
        check_equal(muster("wait", "red", "--domain", domain).returncode, 0, "a run")
        found = wait_for(lambda: str(left.pid) in (now := findings())["left processes"].get("cure", "") and now,
                         10, "the host that is left")
        check_equal(found["domain"]["found"], f"{domain}, of the run follow", "domain")
        check(f"{domain} (follow)" in found["domains"]["found"], found["domains"])
        check(f"{other} (not a run of yours)" in found["domains"]["found"], found["domains"])
        check(int(found["participants"]["found"].split()[0]) >= 4, found["participants"])
