# SPDX-License-Identifier: Apache-2.0
"""Groups from the command line: who is in them, in whose name, and what is refused how."""
import json
import subprocess

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for, whole_lines)

BAD_NAMES = ["a b", "a\nb", "*", '"a"', "", "1st", "a:b", "a,b", "x" * 32, "x" * 10000, b"caf\xe9",
             "caf\u00e9"]


def group(domain, *words):
    return muster("group", *words, "--domain", domain)


def objects(done):
    check_equal(done.returncode, 0, done.stderr)
    return [json.loads(line) for line in done.stdout.splitlines()]


def test_groups_are_made_listed_and_left():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        done = group(domain, "list")
        check_equal((done.returncode, done.stdout.split()), (0, ["GROUP", "MEMBERS"]), "none")
        check_equal(group(domain, "create", "cooks").returncode, 0, "create")
        done = group(domain, "create", "cooks")
        check_equal(done.returncode, 8, "it is there already")
        check("group-exists" in done.stderr, done.stderr)
        check_equal(group(domain, "join", "scouts").returncode, 0, "join")
        check_equal(objects(group(domain, "list", "--json")),
                    [{"group": "cooks", "members": 0}, {"group": "scouts", "members": 1}], "list")
        check_equal(objects(group(domain, "members", "scouts", "--json")),
                    [{"group": "scouts", "agent": "operator", "state": "absent"}], "members")
        check_equal(group(domain, "members", "scouts").stdout.split(),
                    ["GROUP", "AGENT", "STATE", "scouts", "operator", "absent"], "a table")
        check_equal(objects(group(domain, "members", "cooks", "--json")), [], "of nobody")
        check_equal(group(domain, "leave", "scouts").returncode, 0, "leave")
        for words in (("leave", "scouts"), ("members", "scouts"), ("leave", "cooks"),
                      ("send", "scouts", "hello")):
            done = group(domain, *words)
            check_equal(done.returncode, 7, f"{words}: {done.stderr}")
            check(done.stderr.strip(), f"{words} says why")
        check_equal(objects(group(domain, "list", "--json")), [{"group": "cooks", "members": 0}],
                    "the last one who leaves ends it")


def test_a_change_in_the_name_of_another():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        processes.start(program("mail_receiver"), domain, "ann", out / "ann")
        gone = processes.start(program("mail_receiver"), domain, "bob", out / "bob")
        wait_for(lambda: {"ann", "bob"} <= set(members(domain)), 10, "two agents")
        gone.terminate()
        gone.wait()
        muster("send", "bob", "first", "--domain", domain)
        for name in ("ann", "bob", "nova"):  # there, absent, never heard of
            done = group(domain, "join", "scouts", "--as", name)
            check_equal(done.returncode, 0, f"{name}: {done.stderr}")
        check_equal([(m["agent"], m["state"]) for m in
                     objects(group(domain, "members", "scouts", "--json"))],
                    [("ann", "running"), ("bob", "absent"), ("nova", "absent")], "members")
        done = group(domain, "send", "scouts", "gold")
        check_equal((done.returncode, done.stdout), (0, "stored\n"), "mail to the group")
        wait_for(lambda: (out / "ann").read_text().endswith(" operator gold\n"), 5, "ann's mail")
        processes.start(program("mail_receiver"), domain, "bob", out / "bob")
        wait_for(lambda: (out / "bob").read_text().endswith(" operator gold\n"), 5, "bob's mail")
        check_equal(len((out / "bob").read_text().splitlines()), 2, "nobody took his mail")
        check_equal(group(domain, "leave", "scouts", "--as", "bob").returncode, 0, "leave")
        done = group(domain, "leave", "scouts", "--as", "bob")
        check_equal(done.returncode, 7, "no member any more")
        for name in ("broker", "broker.groups", "all", "robots"):
            check_equal(group(domain, "join", "scouts", "--as", name).returncode, 2, f"as {name}")


def test_the_policy_decides_in_whose_name():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        policy, audit = out / "team.policy", out / "audit"
        policy.write_text("allow operator direct ann\n")
        processes.start(MUSTER, "broker", "main", "--domain", domain, "--policy", policy, "--audit",
                        audit)
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
        for name in ("ann", "bob"):
            processes.start(program("mail_receiver"), domain, name, out / name)
        wait_for(lambda: {"ann", "bob"} <= set(members(domain)), 10, "two agents")
        check_equal(group(domain, "join", "scouts", "--as", "ann").returncode, 0, "allowed")
        done = group(domain, "join", "scouts", "--as", "bob")
        check_equal(done.returncode, 6, "refused")
        check("trust policy" in done.stderr, done.stderr)
        done = muster("service", "add", "mapper", "--as", "bob", "--domain", domain)
        check_equal(done.returncode, 6, "a service, too")
        check_equal(group(domain, "join", "scouts").returncode, 0, "for itself it may")
        records = wait_for(lambda: len(whole_lines(audit)) == 3 and
                           [json.loads(line) for line in whole_lines(audit)], 5, "three records")
        check_equal([(r["receiver"], r["performative"], r["allowed"]) for r in records],
                    [("ann", "group-join", True), ("bob", "group-join", False),
                     ("bob", "advertise", False)], "the audit")


def test_bad_names_are_refused_with_what_is_right():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        for name in BAD_NAMES:
            for words in (("create", name), ("join", name), ("leave", name), ("members", name),
                          ("send", name, "hello"), ("join", "scouts", "--as", name)):
                done = group_bytes(domain, *words)
                check_equal(done.returncode, 2, f"{words}: {done.stderr}")
                said = done.stderr.decode()
                check("[A-Za-z_][A-Za-z0-9_.-]{0,30}" in said, said)
                check(len(said) < 300 and said.count("\n") == 1, f"one short line: {said!r}")
        for words in ((), ("members",), ("join",), ("list", "more"), ("sing", "x"), ("send", "g")):
            check_equal(group(domain, *words).returncode, 2, f"{words}")


def group_bytes(domain, *words):
    """Words that may be no UTF-8."""
    return subprocess.run([MUSTER, "group", *words, "--domain", str(domain)], capture_output=True,
                          timeout=30, stdin=subprocess.DEVNULL)


def test_a_robot_is_born_into_groups_and_services():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        rules = ROOT / "rules/follower.clp"
        processes.start(MUSTER, "robot", "red", "--rules", rules, "--domain", domain, "--group",
                        "scouts", "--group", "lead", "--service", "mapper role=scout x=1")
        wait_for(lambda: len(objects(group(domain, "list", "--json"))) == 2, 10, "two groups")
        done = muster("service", "find", "mapper", "x<2", "--json", "--domain", domain)
        check_equal(objects(done), [{"service": "mapper", "agent": "red",
                                     "attributes": {"role": "scout", "x": "1"},
                                     "state": "standby"}], "the service")
        done = muster("do", "group:scouts", "(+ 1 2)", "--domain", domain)
        check_equal((done.returncode, done.stdout), (0, "red: 3\n"), "a line to a group")
        for words in (("--group", "a b"), ("--service", "1st"), ("--service", "mapper role"),
                      ("--service", "")):
            done = muster("robot", "blue", "--rules", rules, *words, "--domain", domain)
            check_equal(done.returncode, 2, f"{words}: {done.stderr}")


def test_an_experiment_has_groups_and_services_from_the_start():
    with folder() as out:
        text = f"""world: {ROOT}/worlds/arena.world
duration: 2
robots:
  - {{name: red, rules: {ROOT}/rules/follower.clp, groups: [scouts], services: [mapper role=a]}}
  - {{name: blue, rules: {ROOT}/rules/follower.clp, groups: [scouts]}}
  - {{name: green, rules: {ROOT}/rules/follower.clp}}
  - {{name: yellow, rules: {ROOT}/rules/follower.clp}}
observer:
  - {{at: 0, do: "group:scouts", line: "(wander)"}}
expect:
  - {{inside: arena}}
"""
        file = out / "team.yaml"
        file.write_text(text)
        runs = []
        for name in ("a", "b"):
            done = muster("run", file, "--quiet", "--out", out / name)
            check_equal(done.returncode, 0, done.stderr)
            runs.append(json.loads((out / name / "summary.json").read_text()))
        check_equal(runs[0]["hash"], runs[1]["hash"], "the hash")
        moved = {r["name"]: r["distance_m"] > 0.1 for r in runs[0]["robots"]}
        check_equal(moved, {"red": True, "blue": True, "green": False, "yellow": False}, "who moved")
        file.write_text(text.replace("groups: [scouts], s", "groups: ['a b'], s"))
        done = muster("run", file, "--quiet")
        check_equal(done.returncode, 3, done.stderr)
        check("team.yaml:4:" in done.stderr and "'a b'" in done.stderr, done.stderr)
        file.write_text(text.replace("mapper role=a", "mapper role"))
        done = muster("run", file, "--quiet")
        check_equal(done.returncode, 3, done.stderr)
        check("team.yaml:4:" in done.stderr and "role=scout" in done.stderr, done.stderr)
        (out / "deny.policy").write_text("allow observer direct red\n")
        file.write_text(text + "policy: deny.policy\n")
        done = muster("run", file, "--quiet", "--out", out / "c")
        check_equal(done.returncode, 6, done.stderr)
