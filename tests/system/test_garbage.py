# SPDX-License-Identifier: Apache-2.0
"""What nobody should say, said over the network: refused by name, counted, and nothing else."""
import collections
import json
import subprocess

from support import (Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for, whole_lines)
from test_health import Watch, counters
from test_store import receiver_start

MAILS, BAD_WORDS = 20000, 11


def resident_kb(process):
    with open(f"/proc/{process.pid}/status", encoding="ascii") as status:
        return next(int(line.split()[1]) for line in status if line.startswith("VmRSS"))


def garbage_say(domain):
    done = subprocess.run([program("garbage"), str(domain)], capture_output=True, timeout=40)
    check_equal(done.returncode, 0, f"the broker answers to the end: {done.stderr!r}")
    return collections.Counter(done.stdout.decode(errors="replace").splitlines())


def test_garbage_is_refused_and_counted_and_others_are_not_disturbed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        audit = out / "audit.jsonl"
        broker = broker_start(processes, domain, "--audit", audit)
        receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 10, "the receiver in the white pages")
        sender = processes.start(program("mail_sender"), domain, "sender", "receiver", MAILS)
        said = garbage_say(domain)
        check(said["refused not a valid name"] >= 6, f"names refused: {said}")
        check(said["receipt refused"] >= 6, f"addresses refused: {said}")
        check(said["receipt delivered"] >= 3, f"odd contents are contents: {said}")
        check(said["answer failure not-a-name"] >= 6, f"groups and services refused: {said}")
        check(said["answer not-understood find-service"] >= 6, f"queries refused: {said}")
        check_equal(said["answer inform groups"], 1, f"no group was made: {said}")
        counted = counters(domain, "broker.mail")
        check(counted["malformed"] > BAD_WORDS, f"counted: {counted}")
        check_equal(sender.wait(60), 0, "the other pair's mail")
        check_equal([line for line in whole_lines(out / "record") if " sender " in line][-1]
                    .split()[1:], ["sender", "count", str(MAILS)], "and all of it")
        watch = Watch(processes, domain)
        wait_for(lambda: watch.look("status").get("malformed", 0) > 3 * BAD_WORDS, 10,
                 "those of the border are counted, too")
        before = resident_kb(broker)
        garbage_say(domain)
        grown = resident_kb(broker) - before
        check(grown < 2048, f"{grown} kB more for the same garbage")
        strangers = {name for name in members(domain) if not name.startswith("broker")}
        check_equal(strangers, {"receiver", "sender", "garbler", "operator", "x"} & strangers,
                    "names in the white pages")
        check(broker.poll() is None, "the broker lives")


def test_what_is_written_and_shown_stays_whole():
    domain = new_domain()
    odd = 'a "b" \\ \t\n\x1b[31m \x7f é'
    with folder() as out, Processes() as processes:
        audit = out / "audit.jsonl"
        broker_start(processes, domain, "--audit", audit)
        receiver_start(processes, domain, out)
        wait_for(lambda: "receiver" in members(domain), 10, "the receiver in the white pages")
        muster("do", "receiver", odd, "--domain", domain, timeout=60)
        muster("do", "receiver", b"\xff\xfe broken", "--domain", domain, timeout=60)
        wait_for(lambda: len(whole_lines(audit)) == 2, 10, "two records")
        records = [json.loads(line) for line in audit.read_text(encoding="utf-8").splitlines()]
        check_equal(records[0]["line"], odd, "a record")
        check("broken" in records[1]["line"], f"a record: {records[1]}")
        garbage_say(domain)
        line = members(domain)["garbler"]
        check(line["host"].isprintable() and " " not in line["host"], f"the host: {line}")
        for shown in muster("ps", "--domain", domain).stdout.splitlines()[1:]:
            check_equal(len(shown.split()) in (6, 7), True, f"a line of ps: {shown!r}")
