# SPDX-License-Identifier: Apache-2.0
"""What the processes are on the network: loopback alone, readable by DDS tools."""
import json
import os
import pathlib
import re
import shutil
import subprocess

from support import (BUILD, FOLLOW, MUSTER, ROOT, Processes, Skip, broker_start, check, check_equal,
                     experiment_run, folder, muster, new_domain, observer_environment, program, tool_python, wait_for)


def test_every_socket_is_bound_to_loopback():
    if not shutil.which("ss"):
        raise Skip("no ss: package iproute2")
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        robot = processes.start(MUSTER, "robot", "red", "--rules", ROOT / "rules/follower.clp",
                                "--domain", domain)
        simulator = processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--domain", domain)
        wait_for(lambda: "red" in muster("ps", "--domain", domain).stdout, 10, "the robot")
        pids = [p.pid for p in processes.started]
        listing = subprocess.run(["ss", "-H", "-a", "-n", "-u", "-t", "-p"], capture_output=True,
                                 text=True, check=True).stdout
        ours = [line for line in listing.splitlines()
                if any(f"pid={pid}," in line for pid in pids)]
        check(len(ours) >= 3, f"sockets of {pids}: {listing}")
        for line in ours:
            address = line.split()[4]
            check(re.match(r"127.0.0.1(%lo)?:|0.0.0.0%lo:", address), f"bound to {address}")
        check(robot.poll() is None and simulator.poll() is None, "both live")


def test_a_missing_broker_is_named():
    domain = new_domain()
    for words in (["ps"], ["send", "red", "x"],
                  ["robot", "red", "--rules", ROOT / "rules/follower.clp"],
                  ["sim", ROOT / "worlds/arena.world"]):
        done = muster(*words, "--domain", domain, "--wait-broker", "0.4", timeout=60)
        check_equal(done.returncode, 4, f"{words}: {done.stderr}")
        check("muster broker" in done.stderr, f"what to do: {done.stderr}")


def test_an_address_that_is_not_there_is_named():
    for words in (("--interface", "203.0.113.9"), ("--interface", "eth99"),
                  ("--peer", "127.0.0.1,nobody.invalid")):
        done = muster("ps", "--domain", new_domain(), *words)
        check_equal(done.returncode, 11, f"exit code of {words}")
        check(done.stderr.startswith(f"{words[0]} {words[1].split(',')[-1]}: "), done.stderr)


def test_dds_tools_list_and_decode_the_topics():
    home = tool_python("cyclonedds")
    tool = [str(home / "bin" / "python"), str(home / "bin" / "cyclonedds")]
    domain = new_domain()

    def tool_run(*words, seconds=20):
        return subprocess.run([*tool, *words], capture_output=True, text=True, timeout=seconds,
                              env=observer_environment(), stdin=subprocess.DEVNULL).stdout

    with Processes() as processes:
        broker_start(processes, domain)
        processes.start(MUSTER, "robot", "red", "--rules", ROOT / "rules/follower.clp",
                        "--domain", domain)
        wait_for(lambda: "red" in muster("ps", "--domain", domain).stdout, 10, "the robot")
        options = ["-i", str(domain), "-r", "2", "--suppress-progress-bar"]
        ps = tool_run("ps", *options)
        check("broker" in ps and "red" in ps, f"cyclonedds ps: {ps}")
        ls = tool_run("ls", *options)
        for topic in ("Registration", "Up", "Delivery", "Pages", "BrokerStatus"):
            check(topic in ls, f"{topic} in cyclonedds ls: {ls}")
        for topic, member in (("Up", "sequence<muster::Act> acts"), ("Pages", "sequence<string> lines"),
                              ("Delivery", "sequence<muster::Parcel> parcels")):
            typeof = tool_run("typeof", topic, *options)
            words = re.sub(r"\s+", " ", typeof).replace("muster::", "")
            check(member.replace("muster::", "") in words, f"typeof {topic}: {typeof}")
        for topic, wanted in ("Pages", b"'red robot "), ("Up", b"acks=[Ack(box='red'"):
            subscribe = processes.start(*tool, "subscribe", topic, *options, stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, env=observer_environment())
            subscribe.stdin.write(b"0\n")  # where a topic has several qualities of service, it asks
            subscribe.stdin.flush()
            os.set_blocking(subscribe.stdout.fileno(), False)
            seen = bytearray()

            def decoded():
                seen.extend(subscribe.stdout.read() or b"")
                muster("send", "red", "hello", "--domain", domain)
                return wanted in seen

            wait_for(decoded, 20, f"what red says on {topic}, decoded by cyclonedds subscribe")


def test_a_tool_sees_every_sample_and_changes_nothing():
    """Between processes of one host samples go by sockets; a tool has them by DDS, each once."""
    with folder() as out:
        done, calm = experiment_run(out / "calm", "--duration", "60")
        check_equal(done.returncode, 0, done.stderr)
        for times, ms in ((40, 50), (1, 2000)):
            domain = new_domain()
            with Processes() as processes:
                run = processes.start(MUSTER, "run", FOLLOW, "--quiet", "--duration", "60", "--rate", "10",
                                      "--domain", domain, "--out", out / f"seen{times}")
                done = subprocess.run([program("up_watcher"), str(domain), str(times), str(ms)], check=True,
                                      capture_output=True, text=True, timeout=90)
                seen = json.loads(done.stdout)
                check_equal(run.wait(60), 0, "the run")
            check_equal((seen["twice"], seen["missing"]), (0, 0), f"{seen}")
            check(seen["visits"] >= times / 4 and seen["samples"] > 10 * seen["visits"], f"{seen}")
            summary = json.loads((out / f"seen{times}/summary.json").read_text())
            check_equal(summary["hash"], calm["hash"], "the hash")


def test_library_and_headers_build_a_stranger_s_controller():
    if not shutil.which("pkg-config"):
        raise Skip("no pkg-config: package pkg-config")
    with folder() as out:
        subprocess.run(["make", "-s", "DEPS=skip", "install", f"BUILD={BUILD.name}",
                        f"DESTDIR={out}", "PREFIX=/usr"], cwd=ROOT, check=True,
                       capture_output=True)
        environment = {**os.environ, "PKG_CONFIG_PATH": str(out / "usr/lib/pkgconfig"),
                       "PKG_CONFIG_SYSROOT_DIR": str(out)}
        flags = subprocess.run(["pkg-config", "--cflags", "--libs", "muster"], env=environment,
                               check=True, capture_output=True, text=True).stdout.split()
        sanitize = ["-fsanitize=address,undefined"] if BUILD.name == "asan" else []
        built = subprocess.run(["gcc", "-o", out / "spin", ROOT / "examples/spin.c", *flags,
                                *sanitize], capture_output=True, text=True)
        check_equal(built.returncode, 0, f"a build against the installed library: {built.stderr}")
        libraries = subprocess.run(["ldd", out / "spin"], capture_output=True, text=True).stdout
        check("libclips" not in libraries and "libode" not in libraries, libraries)
        for name in ("bash-completion/completions/muster", "zsh/site-functions/_muster",
                     "fish/vendor_completions.d/muster.fish"):
            check("muster" in (out / "usr/share" / name).read_text(), name)
        installed = pathlib.Path(out, "usr/bin/muster")
        done = subprocess.run([installed, "run", ROOT / "experiments/follow.yaml", "--quiet",
                               "--duration", "2", "--out", out / "report"], capture_output=True,
                              text=True, timeout=60)
        check(done.returncode in (0, 1), f"the installed muster: {done.stderr}")
