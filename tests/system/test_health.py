# SPDX-License-Identifier: Apache-2.0
"""The parts of the broker: their lines, their counters, the topics that tell them; the interval."""
import json
import os
import subprocess

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, observer_environment, program, tool_python, wait_for)

PARTS = ("names", "mail", "delivery", "groups", "services", "trust", "journal", "federation")


def counters(domain, part):
    """What a part answers to whoever looks it up."""
    done = muster("lookup", part, "--json", "--domain", domain)
    check_equal(done.returncode, 0, f"lookup {part}: {done.stderr}")
    lines = done.stdout.splitlines()
    check_equal(len(lines), 1, f"one object: {done.stdout}")
    return json.loads(lines[0])["counters"]


class Watch:
    """The lines of health_watch, by their first word; the last of each counts."""

    def __init__(self, processes, domain):
        self.stream = processes.start(program("health_watch"), domain,
                                      stdout=subprocess.PIPE).stdout
        os.set_blocking(self.stream.fileno(), False)
        self.text, self.told = b"", {}

    def look(self, word):
        self.text += self.stream.read() or b""
        *lines, self.text = self.text.split(b"\n")
        for line in lines:
            first, *rest = line.decode().split()
            self.told[first] = dict(zip(rest[::2], map(int, rest[1::2])))
        return self.told.get(word, {})


def test_parts_stand_in_the_white_pages():
    domain = new_domain()
    with Processes() as processes:
        broker = broker_start(processes, domain)
        pages = members(domain)
        for part in PARTS:
            line = pages[f"broker.{part}"]
            check_equal((line["kind"], line["state"], line["pid"]),
                        ("special", "running", broker.pid), part)
        done = muster("lookup", "broker.delivery", "--domain", domain)
        check(any(line.split()[:1] == ["deliveries"] for line in done.stdout.splitlines()),
              done.stdout)
        check_equal(counters(domain, "broker.trust")["refused"], 0, "directives refused")
        check("delivery.deliveries" in counters(domain, "broker"), "all parts at once")
        before = counters(domain, "broker.courier")  # its name in 0.1, and those of its counters
        check(before["parcels"] <= before["items"] <= counters(domain, "broker.delivery")["parcels"], before)


def test_an_option_keeps_one_process_off_the_sockets():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain, "--local", "on")
        for name, local in (("red", "on"), ("blue", "off")):
            processes.start(MUSTER, "agent", name, "--rules", ROOT / "rules/clerk.clp", "--local", local, "--domain",
                            domain)
        check_equal(muster("wait", "red", "blue", "--local", "on", "--domain", domain).returncode, 0, "both")

        def ways():
            done = muster("lookup", "broker.names", "--json", "--local", "on", "--domain", domain)
            found = json.loads(done.stdout)["counters"]
            return found["by-socket"] > 0 and found["by-dds"] == 2
        wait_for(ways, 10, "both readers of blue alone have their mail by DDS")


def test_counters_are_told_to_late_comers_and_grow_with_the_mail():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        receiver = processes.start(program("mail_receiver"), domain, "receiver", out / "record")
        wait_for(lambda: "receiver" in members(domain), 10, "the receiver in the white pages")
        receiver.terminate()
        receiver.wait()
        wait_for(lambda: members(domain)["receiver"]["state"] == "absent", 10, "its absence")
        for _ in range(3):
            check_equal(muster("send", "receiver", "x", "--domain", domain).returncode, 0, "send")
        watch = Watch(processes, domain)
        wait_for(lambda: watch.look("status").get("waiting") == 3, 10, "three mails wait")
        check_equal(watch.look("status")["stored"], 3, "mails stored")
        age = watch.look("status")["oldest_ns"]
        cpu = watch.look("status")["cpu_ns"]
        wait_for(lambda: watch.look("status")["oldest_ns"] > age, 10, "the oldest grows older")
        wait_for(lambda: watch.look("status")["cpu_ns"] > cpu, 10, "the processor is used")
        check(watch.look("status")["resident_bytes"] > 1 << 20, "some memory")
        wait_for(lambda: watch.look("broker.mail").get("waiting") == 3, 10, "the part says so")
        check_equal(set(watch.told), {"status", *(f"broker.{part}" for part in PARTS)}, "who tells")
        processes.start(program("mail_receiver"), domain, "receiver", out / "record")
        wait_for(lambda: watch.look("broker.mail").get("waiting") == 0, 10, "none waits")
        wait_for(lambda: watch.look("status").get("oldest_ns") == 0, 10, "nor is any old")


def test_dds_tools_decode_the_health_topics():
    home = tool_python("cyclonedds")
    domain = new_domain()
    tool = [str(home / "bin" / "python"), str(home / "bin" / "cyclonedds")]
    with Processes() as processes:
        broker_start(processes, domain)
        for topic, wanted in (("PartStatus", b"name='deliveries'"),
                              ("BrokerStatus", b"resident_bytes=")):
            subscribe = processes.start(*tool, "subscribe", topic, "-i", str(domain), "-r", "2",
                                        "--suppress-progress-bar", stdout=subprocess.PIPE,
                                        env=observer_environment())
            os.set_blocking(subscribe.stdout.fileno(), False)
            seen = bytearray()

            def decoded(stream=subscribe.stdout, seen=seen, wanted=wanted):
                seen.extend(stream.read() or b"")
                return wanted in seen

            wait_for(decoded, 20, f"{topic}, decoded by cyclonedds subscribe")


def test_the_interval_is_an_option_and_is_tuned_by_directive():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        processes.start(MUSTER, "broker", "main", "--domain", domain, "--delivery-interval", "20")
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
        processes.start(program("mail_receiver"), domain, "receiver", out / "record")
        wait_for(lambda: "receiver" in members(domain), 10, "the receiver in the white pages")
        check_equal(counters(domain, "broker.delivery")["interval-ns"], 20000000, "the option")
        done = muster("do", "broker", "(delivery-interval 50)", "--domain", domain)
        check_equal((done.returncode, done.stdout), (0, "broker: delivery-interval 50\n"), "set")
        check_equal(counters(domain, "broker.delivery")["interval-ns"], 50000000, "the directive")
        done = subprocess.run([program("mail_sender"), str(domain), "sender", "receiver", "2000"],
                              capture_output=True, text=True, timeout=60)
        check_equal(done.stdout.strip(), "delivered 2000", "mail all the same")
        counted = counters(domain, "broker.delivery")
        check(counted["wakings"] > 0 and counted["delay-ns"] > 0, f"the interval: {counted}")
        check(counted["most-items"] > 10, f"many mails in one delivery: {counted}")
        for wrong in ("(delivery-interval 60001)", "(delivery-interval soon)"):
            done = muster("do", "broker", wrong, "--domain", domain)
            check_equal(done.returncode, 8, wrong)
            check("expected milliseconds, from 0 (at once) to 60000" in done.stdout, done.stdout)
        check_equal(counters(domain, "broker.delivery")["interval-ns"], 50000000, "as it was")
        done = muster("do", "broker", "(delivery-interval 0)", "--as", "red", "--domain", domain)
        check_equal(done.returncode, 6, "red may not")
        check_equal(muster("broker", "x", "--delivery-interval", "-1").returncode, 2, "wrong usage")
