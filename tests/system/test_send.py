# SPDX-License-Identifier: Apache-2.0
"""Mail and directives from the command line: envelopes, answers, exit codes, bad input."""
import json
import subprocess

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder,
                     members, muster, new_domain, program, wait_for)

CONTENT_MAX = 16384


def answerer_start(processes, domain, *names):
    for name in names:
        processes.start(program("mail_answerer"), domain, name)
    wait_for(lambda: set(names) <= set(members(domain)), 10, f"{names}")


def send(domain, *words):
    return muster("send", *words, "--domain", domain)


def test_answers_are_waited_for_and_printed():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann", "bob")
        done = send(domain, "ann", "tell", "42", "--wait", 10)
        check_equal((done.returncode, done.stdout, done.stderr), (0, "ann: 42\n", ""), "an answer")
        done = send(domain, "ann,bob,ann", 'tell "a b"', "--wait", 10)
        check_equal((done.returncode, sorted(done.stdout.splitlines())),
                    (0, ["ann: a b", "bob: a b"]), "each once")
        done = send(domain, "all", "tell here", "--wait", 10)
        check_equal((done.returncode, len(done.stdout.splitlines())), (0, 2), "of all")
        for performative, words in (("refuse", "refuses"), ("not-understood", "not understood")):
            done = send(domain, "ann", performative, "too late", "--wait", 10)
            check_equal((done.returncode, done.stdout), (8, ""), performative)
            check(words in done.stderr and "too late" in done.stderr, done.stderr)
        done = send(domain, "ann", "--layer", 2, "--performative", "state", "?", "--wait", 10)
        check_equal((done.returncode, done.stdout), (0, "ann: state running\n"), "another layer")
        check_equal(send(domain, "ann", "tell", "--layer", 0).returncode, 2, "no layer")
        done = send(domain, "ann", "silence", "--wait", 0.2, "--reply-with", "mine")
        check_equal((done.returncode, done.stdout), (0, "ann: \n"), "an empty answer")


def test_why_nobody_answers():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann")
        check_equal(muster("suspend", "ann", "--domain", domain).returncode, 0, "suspend")
        wait_for(lambda: members(domain)["ann"]["state"] == "suspended", 10, "it is suspended")
        done = send(domain, "ann", "tell", "42", "--wait", 0.3)
        check_equal((done.returncode, done.stdout), (124, ""), "no answer")
        check("ann is suspended; what was sent waits for it" in done.stderr, done.stderr)
        check_equal(muster("dispose", "ann", "--domain", domain).returncode, 0, "dispose")
        wait_for(lambda: members(domain).get("ann", {}).get("state") in (None, "absent"), 10, "gone")
        done = send(domain, "ann", "tell", "42", "--wait", 5)  # its name has ended: nothing waits
        check_equal(done.returncode, 7, "no such agent")
        check("to ann: unknown-name" in done.stderr, done.stderr)


def test_answers_as_objects_have_the_whole_envelope():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann")
        done = send(domain, "ann", "tell", '"a" \\', "--wait", 10, "--json", "--language", "text",
                    "--ontology", "kitchen", "--conversation", "c1", "--reply-with", "r1",
                    "--performative", "ask-one", "--level", "ram", "--priority", "high")
        check_equal(done.returncode, 0, done.stderr)
        answer = json.loads(done.stdout)
        want = {"from": "ann", "to": "operator", "performative": "tell", "language": "text",
                "ontology": "kitchen", "conversation": "c1", "in_reply_to": "r1",
                "reply_with": "", "layer": 3, "content": '"a" \\'}
        check_equal({key: answer[key] for key in want}, want, "the answer")
        done = send(domain, "ann", "refuse", "no", "--wait", 10, "--json")
        check_equal((done.returncode, json.loads(done.stdout)["performative"]), (8, "refuse"),
                    "a refusal is an answer, too")


def test_what_became_of_it_is_said_and_is_the_exit_code():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann", "bob")
        gone = processes.started[-1]
        gone.terminate()
        gone.wait()
        for words, want in (
                (("ann", "tell"), (0, "delivered\n", "")),
                (("ann", "tell", "--quiet"), (0, "", "")),
                (("bob", "tell"), (0, "stored\n", "")),
                (("bob", "tell", "-q"), (0, "", "")),
                (("bob", "tell", "--ttl", 0.2, "--wait", 10),
                 (8, "", "muster: to bob: expired\n")),
                (("ann", "tell", "--as", "carl"), (0, "delivered\n", ""))):
            done = send(domain, *words)
            check_equal((done.returncode, done.stdout, done.stderr), want, f"{words}")
        for to, outcome, code in (("ann", "delivered", 0), ("bob", "stored", 0),
                                  ("nobody", "unknown-name", 7)):
            done = send(domain, to, "tell", "--json")
            said = json.loads(done.stdout)
            check_equal((done.returncode, said["to"], said["outcome"]), (code, to, outcome),
                        "the same as an object")
            check(said["seq"] > 0, f"its number: {said}")
        for to in ("nobody", "group:nobody", "role:nobody", "ann,nobody"):
            done = send(domain, to, "tell")
            check_equal(done.returncode, 7, f"{to}: {done.stderr}")
            check("unknown-name" in done.stderr, done.stderr)
        done = send(domain, "bob", "tell", "--wait", 0.2)
        check_equal((done.returncode, done.stdout), (124, ""), "nobody answers")
        done = muster("start", "ann", "--as", "stranger", "--domain", domain)
        check_equal(done.returncode, 6, "a directive of a stranger")
        done = send(new_domain(), "ann", "tell")
        check_equal(done.returncode, 4, "no broker")


def test_a_full_box_is_an_exit_code():
    domain = new_domain()
    with Processes() as processes:
        processes.start(MUSTER, "broker", "main", "--domain", domain, "--box-mails", 1,
                        "--box-policy", "drop-oldest")
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
        answerer_start(processes, domain, "bob")
        processes.started[-1].terminate()
        processes.started[-1].wait()
        waits = processes.start(MUSTER, "send", "bob", "one", "--wait", 20, "--as", "ann",
                                "--domain", domain, stderr=subprocess.PIPE)
        wait_for(lambda: "ann" in members(domain), 10, "a sender that waits")
        wait_for(lambda: "waiting 1" in " ".join(muster("lookup", "broker.mail", "--domain",
                                                        domain).stdout.split()), 10, "its mail")
        check_equal(send(domain, "bob", "two").returncode, 0, "it made room")
        _, said = waits.communicate(timeout=60)
        check_equal((waits.returncode, said), (8, b"muster: to bob: dropped\n"), "the old one")


def test_without_a_disk_durable_mail_is_refused():
    domain = new_domain()
    with Processes() as processes:
        processes.start(MUSTER, "broker", "main", "--domain", domain, "--store", "none")
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker")
        answerer_start(processes, domain, "ann")
        for level, want in (("ram", 0), ("logged", 9), ("synced", 9)):
            done = send(domain, "ann", "tell", "--level", level)
            check_equal(done.returncode, want, f"{level}: {done.stderr}")
        check("no-store" in done.stderr, done.stderr)


def test_nobody_loses_mail_to_who_sends_in_his_name():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "bob")
        processes.started[-1].terminate()
        processes.started[-1].wait()
        send(domain, "bob", "tell for bob")
        check_equal(send(domain, "broker", "hello", "--as", "bob").returncode, 0, "mail of bob")
        processes.start(program("mail_receiver"), domain, "bob", out / "bob")
        wait_for(lambda: (out / "bob").exists() and "tell for bob" in (out / "bob").read_text(), 10,
                 "the mail that waited")


def test_bad_input_is_refused_with_what_is_right():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann")
        bad = [b"a b", b"a\nb", b"*", b'"a"', b"", b"ann,", b",ann", b"ann,,ann", b"ann,all",
               b"group:", b"group:a b", b"group:1", b":a", b"role:", b"caf\xe9", b"x" * 10000,
               b",".join([b"ann"] * 300)]
        for to in bad:
            for verb in ((b"send", to, b"x"), (b"do", to, b"(x)"), (b"start", to),
                         (b"step", to, b"1")):
                done = subprocess.run([MUSTER, *verb, b"--domain", b"%d" % domain], timeout=30,
                                      capture_output=True, stdin=subprocess.DEVNULL)
                check_equal(done.returncode, 2, f"{verb[0]} {to[:40]}: {done.stderr}")
                check(b"expected" in done.stderr and len(done.stderr) < 300, f"{done.stderr}")
        for words in (("--level", "disk"), ("--priority", "1"), ("--ttl", "-1"), ("--ttl", "x"),
                      ("--reply-by", "nan"), ("--wait", "soon"), ("--ontology", "x" * 64),
                      ("--performative", "x" * 64), ("--as", "a b"), ("--as", "")):
            done = send(domain, "ann", "tell", *words)
            check_equal(done.returncode, 2, f"{words}: {done.stderr}")
            check(done.stderr.strip(), f"{words} says why")
        done = subprocess.run([MUSTER, "send", "ann", b"caf\xe9", "--domain", str(domain)],
                              capture_output=True, timeout=30)
        check_equal(done.returncode, 2, "content that is no UTF-8")
        for words in ((), ("ann",)):
            check_equal(send(domain, *words).returncode, 2, f"{words}")
        for name in (b"a b", b"", b"1a", b"*", b"x" * 10000, b"caf\xe9"):
            done = subprocess.run([MUSTER, b"lookup", name, b"--domain", b"%d" % domain],
                                  capture_output=True, timeout=30)
            check_equal(done.returncode, 2, f"lookup {name[:40]}: {done.stderr}")
            check(b"it must match" in done.stderr and len(done.stderr) < 300, f"{done.stderr}")


def test_content_up_to_the_limit_and_not_a_byte_more():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann")
        content = "tell " + "\u00e9" * ((CONTENT_MAX - 5) // 2) + "x"
        check_equal(len(content.encode()), CONTENT_MAX, "bytes")
        done = send(domain, "ann", content, "--wait", 10)
        check_equal((done.returncode, done.stdout == f"ann: {content[5:]}\n"), (0, True), "all of it")
        done = send(domain, "ann", content + "x")
        check_equal(done.returncode, 2, "one byte more")
        check(str(CONTENT_MAX) in done.stderr, done.stderr)
        check_equal(muster("broadcast", "x" * (CONTENT_MAX + 1), "--domain", domain).returncode, 2,
                    "a broadcast")


def state(domain, name):
    return members(domain)[name]["state"]


def test_step_fires_some_rules_and_suspends():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        rules = out / "count.clp"
        rules.write_text("(defglobal ?*n* = 0)\n(defrule count (position $?) => "
                         "(bind ?*n* (+ ?*n* 1)))\n")
        broker_start(processes, domain)
        processes.start(MUSTER, "robot", "red", "--rules", rules, "--domain", domain)
        processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots", "red", "--rate",
                        "10", "--domain", domain)
        wait_for(lambda: "red" in members(domain), 10, "the robot")

        def count():
            return muster("do", "red", "?*n*", "--domain", domain).stdout.strip()

        wait_for(lambda: muster("do", "red", "(position)", "--domain", domain).stdout.strip()
                 not in ("", "red: FALSE"), 10, "steps")
        check_equal(count(), "red: 0", "rules in standby")
        for rounds, want in ((3, "red: 3"), (1, "red: 4")):
            done = muster("step", "red", rounds, "--domain", domain)
            check_equal(done.returncode, 0, done.stderr)
            wait_for(lambda: state(domain, "red") == "suspended", 10, "the end of the steps")
            check_equal(count(), want, "rules fired")
        done = muster("step", "robots", "999999999", "--wait", 5, "--domain", domain)
        check_equal((done.returncode, done.stdout), (0, "red: step\n"), "many, and an answer")
        wait_for(lambda: state(domain, "red") == "running", 10, "it runs")
        muster("suspend", "red", "--domain", domain)
        wait_for(lambda: state(domain, "red") == "suspended", 10, "it is stopped")
        for verb in (("suspend", "red"), ("step", "red", "5"), ("resume", "red")):
            muster(*verb, "--domain", domain)
        before = int(count().split()[1])
        wait_for(lambda: int(count().split()[1]) > before + 5, 20, "it goes on: the later one wins")
        for number in ("0", "-1", "x", "", "1.5", "1000000000", "00"):
            done = muster("step", "red", number, "--domain", domain)
            check_equal(done.returncode, 2, f"{number}: {done.stderr}")
        check_equal(muster("step", "red", "1", "2", "--domain", domain).returncode, 2, "two numbers")


def test_verbs_do_not_stand_in_each_others_way():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann")
        muster("suspend", "ann", "--domain", domain)
        busy = processes.start(MUSTER, "send", "ann", "tell", "--wait", 3, "--domain", domain)
        wait_for(lambda: members(domain).get("operator", {}).get("state") == "running", 10, "one")
        readers = [processes.start(MUSTER, *verb, "--domain", domain)
                   for verb in (("ps",), ("ps",), ("lookup", "ann"), ("lookup", "broker.delivery"),
                                ("group", "list"), ("service", "list"))]
        late = subprocess.run([MUSTER, "send", "ann", "tell x", "--domain", str(domain)],
                              capture_output=True, text=True, timeout=30)
        check_equal((late.returncode, late.stdout), (0, "stored\n"), late.stderr)
        check("waiting for it" in late.stderr, late.stderr)
        for reader in readers:
            check_equal(reader.wait(60), 0, f"{reader.args}")
        check_equal(busy.wait(60), 124, "no answer")
        check(not any(name.startswith("operator-") for name in members(domain)), "who only looks")


def test_directives_take_lists_and_groups():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann", "bob")
        muster("group", "join", "scouts", "--as", "ann", "--domain", domain)
        check_equal(muster("suspend", "group:scouts", "--domain", domain).returncode, 0, "a group")
        wait_for(lambda: (state(domain, "ann"), state(domain, "bob")) == ("suspended", "running"),
                 10, "one that is suspended")
        check_equal(muster("suspend", "ann,bob", "--domain", domain).returncode, 0, "a list")
        wait_for(lambda: state(domain, "bob") == "suspended", 10, "both suspended")
        check_equal(muster("resume", "bob,ann", "--domain", domain).returncode, 0, "a list")
        wait_for(lambda: {state(domain, n) for n in ("ann", "bob")} == {"running"}, 10, "both run")


def test_pages_keep_their_keys():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann")
        line = json.loads(muster("lookup", "ann", "--json", "--domain", domain).stdout)
        check_equal(list(line), ["name", "kind", "state", "broker", "host", "pid", "since"], "keys")
        check_equal(list(members(domain)["ann"]), list(line), "of ps, too")
        check_equal(muster("lookup", "nobody", "--domain", domain).returncode, 7, "nobody")


def test_each_of_many_has_a_line_of_its_own():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann", "bob")
        for name in ("red", "blue"):
            processes.start(MUSTER, "robot", name, "--rules", ROOT / "rules/follower.clp",
                            "--domain", domain)
        muster("dispose", "bob", "--domain", domain)
        wait_for(lambda: {"red", "blue"} <= set(members(domain)) and
                 members(domain).get("bob", {}).get("state") != "running", 10, "two robots")
        whom = "red,ann,nobody,bob,blue"
        done = muster("do", whom, "(+ 1 2)", "--wait", 0.5, "--domain", domain)
        check_equal((done.returncode, sorted(done.stdout.splitlines())), (7, ["blue: 3", "red: 3"]),
                    done.stderr)
        for said in ("ann has not understood: do", "to nobody: unknown-name",
                     "to bob: unknown-name"):  # its name has ended: nothing waits
            check(said in done.stderr, f"{said}: {done.stderr}")
        check_equal(len(done.stderr.splitlines()), 3, done.stderr)
        done = muster("do", whom, "(+ 1 2)", "--wait", 0.5, "--json", "--domain", domain)
        lines = [json.loads(line) for line in done.stdout.splitlines()]
        check_equal((done.returncode, lines.pop()),
                    (7, {"receivers": 5, "done": 2, "refused": 0, "failed": 3, "silent": 0,
                         "exit": 7}), "counts")
        check_equal({line.get("from", line.get("to")): line.get("outcome", line.get("performative"))
                     for line in lines},
                    {"red": "inform", "blue": "inform", "ann": "not-understood",
                     "nobody": "unknown-name", "bob": "unknown-name"}, "each")
        done = muster("do", "robots", "(nonsense)", "--domain", domain)
        check_equal((done.returncode, len(done.stderr.splitlines())), (8, 0), done.stderr)
        check(all(f"{name}: [EXPRNPSR3]" in done.stdout for name in ("red", "blue")), done.stdout)
        check_equal(muster("do", "ann,bob", "(facts)", "--wait", 0.5, "--domain", domain).returncode,
                    7, "the smaller code")
        done = muster("do", "special", "(facts)", "--domain", domain)
        check_equal((done.returncode, done.stdout, "no such agent is there" in done.stderr), (7, "", True),
                    done.stderr)


def test_what_cannot_be_done_is_refused_with_its_code():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        answerer_start(processes, domain, "ann")
        processes.start(MUSTER, "host", "north", "--domain", domain)
        processes.start(MUSTER, "robot", "red", "--rules", ROOT / "rules/follower.clp", "--domain",
                        domain)
        wait_for(lambda: {"red", "north"} <= set(members(domain)), 10, "a robot and a host")
        for verb, whom, want, why in (
                ("suspend", "red", 6, "red refuses: suspend wrong-state standby; its state"),
                ("resume", "red", 6, "red refuses: resume wrong-state standby"),
                ("suspend", "north", 6, "north refuses: suspend unsupported"),
                ("suspend", "broker", 6, "broker refuses: suspend unsupported"),
                ("dispose", "broker.delivery", 6, "delivery refuses: dispose unsupported"),
                ("suspend", "red,nobody", 6, "to nobody: unknown-name"),
                ("start", "ann", 0, ""), ("suspend", "ann", 0, ""), ("suspend", "ann", 0, ""),
                ("start", "ann", 6, "ann refuses: start wrong-state suspended"),
                ("resume", "ann", 0, ""), ("start", "red", 0, ""), ("suspend", "all", 0, "")):
            done = muster(verb, whom, "--domain", domain)
            check_equal(done.returncode, want, f"{verb} {whom}: {done.stderr}")
            check(why in done.stderr, f"{verb} {whom}: {done.stderr}")
        check_equal((state(domain, "red"), state(domain, "ann"), state(domain, "north")),
                    ("suspended", "suspended", "running"), "states")
        for whom, want in (("broker", 6), ("north", 6), ("ann", 8)):
            done = muster("step", whom, "1", "--domain", domain)
            check_equal((done.returncode, done.stdout), (want, ""), f"{whom}: {done.stderr}")
            check(whom in done.stderr, done.stderr)
        muster("resume", "all", "--domain", domain)
        done = muster("start", "all", "--json", "--domain", domain)
        check_equal(json.loads(done.stdout.splitlines()[-1]),
                    {"receivers": 2, "done": 2, "refused": 0, "failed": 0, "silent": 0, "exit": 0},
                    "a host is not among all")
        done = muster("resume", "ann", "--json", "--domain", domain)
        check_equal(json.loads(done.stdout)["performative"], "agree", "one")
        muster("suspend", "ann", "--domain", domain)
        done = muster("start", "ann", "--json", "--domain", domain)
        check_equal((done.returncode, json.loads(done.stdout)["code"]), (6, "wrong-state"), "a code")
