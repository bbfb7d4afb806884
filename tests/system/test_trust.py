# SPDX-License-Identifier: Apache-2.0
"""Whose directives are carried out, who is told, and what is written down."""
import json
import pathlib
import re
import resource
import signal

from support import (FOLLOW, MUSTER, ROOT, Processes, Skip, check, check_equal, folder, members, muster,
                     new_domain, wait_for, whole_lines)
from test_health import counters

POLICY = """# the team's policy
allow operator direct all
deny operator direct robots
allow operator direct red     # but red
allow red direct blue
"""


def broker_start(processes, domain, *options):
    processes.start(MUSTER, "broker", "main", "--domain", domain, *options)
    wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker that answers")


def robots_start(processes, domain, *names):
    for name in names:
        processes.start(MUSTER, "robot", name, "--rules", ROOT / "rules/follower.clp", "--domain",
                        domain)
    wait_for(lambda: set(names) <= set(members(domain)), 10, "the robots")


def records(path):
    return [json.loads(line) for line in whole_lines(path)]


def test_a_policy_decides_and_the_audit_says_so():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        policy, audit = out / "team.policy", out / "audit.jsonl"
        policy.write_text(POLICY)
        broker_start(processes, domain, "--policy", policy, "--audit", audit)
        robots_start(processes, domain, "red", "blue")
        done = muster("do", "red", "(+ 1 2)", "--domain", domain)
        check_equal((done.returncode, done.stdout), (0, "red: 3\n"), "allowed")
        done = muster("do", "blue", "(+ 1 2)", "--domain", domain)
        check_equal(done.returncode, 6, "refused")
        check("refused" in done.stderr, done.stderr)
        check_equal(muster("do", "red,blue", "(+ 1 2)", "--domain", domain).returncode, 6, "both")
        check_equal(muster("send", "blue", "please", "--domain", domain).returncode, 0, "a request")
        wait_for(lambda: len(records(audit)) == 4, 5, "four records")
        said = [(r["sender"], r["receiver"], r["allowed"]) for r in records(audit)]
        check_equal(said, [("operator", "red", True), ("operator", "blue", False),
                           ("operator", "red", True), ("operator", "blue", False)], "the audit")
        first = records(audit)[0]
        check_equal((first["clock"], first["performative"], first["line"], first["receivers"]),
                    ("wall", "do", "(+ 1 2)", 1), "a record")
        check(first["process"] and first["time_ns"] > 1 << 60, f"a record: {first}")
        counted = counters(domain, "broker.trust")
        check_equal((counted["allowed"], counted["refused"], counted["audited"]), (2, 2, 4), "told")


def test_a_robot_passes_the_policy_or_does_not():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        policy, audit = out / "team.policy", out / "audit.jsonl"
        policy.write_text(POLICY)
        broker_start(processes, domain, "--policy", policy, "--audit", audit)
        robots_start(processes, domain, "red", "blue")
        muster("start", "red", "--domain", domain)
        check_equal(muster("do", "red", "(you-do blue wander)", "--domain", domain).returncode, 0,
                    "red is told")
        wait_for(lambda: any((r["sender"], r["receiver"], r["allowed"]) == ("red", "blue", True)
                             for r in records(audit)), 10, "red directs blue")
        muster("do", "red", "(defrule told (event refused $?) =>)", "--domain", domain)
        muster("do", "red", "(you-do operator wander)", "--domain", domain)
        muster("do", "red", "(send nobody hello)", "--domain", domain)
        for fact in ("(event refused you-do operator refused)",
                     "(event refused send nobody unknown-name)"):
            wait_for(lambda f=fact: f in muster("do", "red", "(facts)", "--domain", domain).stdout, 10,
                     f"red's rules are told: {fact}")
        wait_for(lambda: any((r["sender"], r["receiver"], r["allowed"]) ==
                             ("red", "operator", False) for r in records(audit)), 10, "but no other")


def test_a_full_disk_stops_nothing():
    if not pathlib.Path("/dev/full").exists():
        raise Skip("no /dev/full here")
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain, "--audit", "/dev/full")
        for _ in range(3):
            check_equal(muster("do", "broker", "(delivery-interval 0)", "--domain",
                               domain).returncode, 0, "a directive")
        wait_for(lambda: counters(domain, "broker.trust")["audit-failed"] == 3, 5, "it is counted")


def file_size_limit():
    """A disk that is full behind 4 KiB, for a program and all that it starts."""
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, resource.RLIM_INFINITY))


def test_a_record_that_fits_in_part():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        with open(out / "log", "wb") as log:
            processes.start(MUSTER, "broker", "main", "--domain", domain, "--audit", out / "audit",
                            stderr=log, preexec_fn=file_size_limit)
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
        robots_start(processes, domain, "red")
        for _ in range(30):
            check_equal(muster("start", "red", "--domain", domain).returncode, 0, "a directive")
        check("audit-failed" in counters(domain, "broker.trust"), "a counter")
        check(counters(domain, "broker.trust")["audit-failed"] > 0, "records are lost")
        said = (out / "log").read_text()
        check('audit-not-written reason="File too large"' in said, said)
        lines = (out / "audit").read_bytes().split(b"\n")
        check(len(lines) > 10 and lines[-1], "it ends in the midst of a record")
        for line in lines[:-1]:
            json.loads(line)


def test_mistakes_are_named_with_their_place():
    with folder() as out:
        policy = out / "bad.policy"
        policy.write_text("allow operator direct all\n  deny operator command red\n")
        done = muster("broker", "main", "--domain", new_domain(), "--policy", policy)
        check_equal(done.returncode, 3, "a bad policy")
        check(f"{policy}:2:17: expected direct, not 'command'" in done.stderr, done.stderr)
        done = muster("broker", "main", "--policy", out / "none.policy")
        check_equal(done.returncode, 3, "no policy there")
        done = muster("broker", "main", "--policy", out)
        check_equal(done.returncode, 3, "a folder")
        check("cannot read the policy: Is a directory" in done.stderr, done.stderr)
        policy.write_bytes(b"deny operator \x1b[2J red\n")
        done = muster("broker", "main", "--policy", policy)
        check_equal(done.returncode, 3, "a word to the terminal")
        check(f"{policy}:1:15: expected direct, not '?[2J'" in done.stderr, repr(done.stderr))
        done = muster("broker", "main", "--audit", out / "none" / "audit")
        check_equal(done.returncode, 9, "an audit log that cannot be")


def test_an_experiment_names_its_policy():
    with folder() as out:
        text = pathlib.Path(FOLLOW).read_text()
        text = re.sub(r"(world|rules): (\S+?)([,}\s])",
                      lambda m: f"{m[1]}: {(pathlib.Path(FOLLOW).parent / m[2]).resolve()}{m[3]}",
                      text)
        file = out / "team.yaml"
        file.write_text(f"policy: team.policy\n{text}")
        (out / "team.policy").write_text("allow observer direct all\n")
        done = muster("run", file, "--quiet", "--duration", "2", "--out", out / "a")
        check(done.returncode in (0, 1), f"allowed: {done.returncode} {done.stderr}")
        (out / "team.policy").write_text("deny observer direct all\n")
        done = muster("run", file, "--quiet", "--duration", "2", "--out", out / "b")
        check_equal(done.returncode, 6, f"refused: {done.stderr}")
        check("allow observer direct all" in done.stderr, f"what to do: {done.stderr}")
        (out / "team.policy").write_text("deny observer\n")
        done = muster("run", file, "--quiet", "--duration", "2", "--out", out / "c")
        check_equal(done.returncode, 3, f"a bad policy: {done.stderr}")
        check("team.policy:1:14: expected direct" in done.stderr, done.stderr)
        (out / "team.policy").unlink()
        done = muster("run", file, "--quiet", "--duration", "2", "--out", out / "d")
        check_equal(done.returncode, 3, f"no policy: {done.stderr}")
        check(re.search(r"team\.yaml:1:9: cannot read the policy", done.stderr), done.stderr)
