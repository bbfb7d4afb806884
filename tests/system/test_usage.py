# SPDX-License-Identifier: Apache-2.0
"""Commands that are typed wrong, or ask for what is not there: each says what it wanted."""
import os
import re
import subprocess

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for)

FOLLOWER = str(ROOT / "rules" / "follower.clp")
LONG = ",".join(f"receiver{i:03}" for i in range(100))  # 1199 bytes

# The words, and a part of what is said; nobody is on the network, and nobody is asked.
WRONG = (
    (("fly",), "there is no verb 'fly'; muster --help lists them"),
    (("lokup", "red"), "there is no verb 'lokup'; did you mean 'lookup'?"),
    (("fly\n",), "there is no verb 'fly"),
    (("help", "fly"), "there is no verb 'fly'"),
    (("topics", "Pages"), "muster topics: expected options alone, not 'Pages'"),
    (("ps", "red"), "muster ps: expected options alone, not 'red'"),
    (("top", "red"), "muster top: expected options alone, not 'red'"),
    (("monitor", "red", "--rules", FOLLOWER), "expected options alone, not 'red'"),
    (("lookup",), "name one agent, for example: muster lookup red"),
    (("lookup", "no name"), "no name"),
    (("console",), "name one agent, for example: muster console red"),
    (("console", "red", "blue"), "name one agent"),
    (("console", "red", "-c", "(facts"), "a parenthesis or a string is never closed"),
    (("group",), "expected list, members G"),
    (("group", "join"), "expected list, members G"),
    (("group", "join", "scouts", "--as", "all"), "--as all: the name is reserved"),
    (("group", "create", "all"), "'all' is reserved: expected another name of a group"),
    (("service", "add"), "expected list, find QUERY"),
    (("service", "add", "cleaning", "role"), "expected words KEY=VALUE, each key once"),
    (("service", "add", "cleaning", "a=1", "a=2"), "each key once"),
    (("send", "red"), "expected TO WORD..."),
    (("send", LONG, "hello"), "expected receivers of at most 1023 bytes"),
    (("send", "red", os.fsdecode(b"\xff")), "expected content in UTF-8"),
    (("send", "red", "x" * 17000), "expected at most 16384 bytes of content"),
    (("do", "red"), "expected TARGETS 'LINE'"),
    (("start", "red", "blue"), "muster start: expected TARGETS [OPTION...], for example: muster start red,blue"),
    (("start",), "expected TARGETS"),
    (("step", "red", "x"), "'x': expected a number of rules"),
    (("move", "red"), "expected NAME HOST"),
    (("clone", "red"), "expected NAME NEW [HOST]"),
    (("dispose",), "expected TARGETS"),
    (("send", "red", "x", "--layer", "0"), "--layer 0: expected 1 to 4294967295"),
    (("launch", "red", "north"), "expected NAME HOST --rules FILE"),
    (("launch", "red", "north", "--rules", FOLLOWER, "--global", "speed"), "expected NAME=VALUE"),
    (("host",), "give it a name, for example: muster host north"),
    (("host", "north", "--robot", "red"), "--robot red: expected NAME=FILE"),
    (("replay",), "name one recording"),
    (("resolver",), "name one scheme:"),
    (("resolver", "near", "role"), "name one scheme:"),
    (("top", "--goal", "red"), "expected NAME=X,Y or NAME=X,Y,NEAR in metres"),
    (("world", "pace", "2", "--at", "25"), "the pace goes by the clock on the wall, at once"),
    (("world", "push", "red", "1", "0", "--when", "red likes"), "--when: "),
)


def test_wrong_words_are_explained():
    for words, why in WRONG:
        done = muster(*words)
        check_equal((done.returncode, done.stdout), (2, ""), f"{words}: {done.stderr}")
        check(why in done.stderr, f"{words}: {done.stderr}")


def test_what_was_typed_is_shown_short_and_printable():
    bad = os.fsdecode(b"a\n\x1b\xff") + "x" * 10000
    for words in (("ps", "--domain", bad), ("ps", f"--{bad}"), ("ps", f"-{bad}"), ("ps", "-\n"),
                  ("ps", bad), (bad,), ("lookup", bad), ("send", bad, "x"), ("group", "join", bad),
                  ("service", "find", bad), ("send", "red", "x", "--level", bad)):
        done = subprocess.run([MUSTER, *words], capture_output=True, timeout=60,
                              env={**os.environ, "LC_ALL": "C"})
        said = done.stderr.decode()  # it is UTF-8
        check_equal((done.returncode, done.stdout), (2, b""), f"{words}: {said}")
        check(len(said) < 600 and "\x1b" not in said and said.count("\n") <= 2, f"{words}: {said}")
    done = muster("ps", env={**os.environ, "MUSTER_DOMAIN": bad})
    check_equal(done.returncode, 2, "a variable of the environment")
    check(len(done.stderr) < 600 and "\x1b" not in done.stderr, done.stderr)


def test_help_is_there_in_each_way_that_people_ask_for_it():
    whole = muster("--help")
    check_equal(whole.returncode, 0, "help")
    for words in (("-h",), ("help",)):
        done = muster(*words)
        check_equal((done.returncode, done.stdout), (0, whole.stdout), f"help by {words}")
    for verb in re.findall(r"^  (\w+) ", whole.stdout, re.M):
        done = muster(verb, "--help")
        check_equal((done.returncode, done.stderr), (0, ""), f"help of {verb}")
        check_equal(muster("help", verb).stdout, done.stdout, f"help by help {verb}")


def test_files_that_are_not_there_are_named():
    nowhere = {**os.environ, "MUSTER_RULES": "/nowhere"}
    with folder() as out:
        gone = str(out / "gone.clp")
        for words, kwargs, code, why in (
                (("launch", "red", "north", "--rules", gone), {}, 3, f"{gone}: cannot be opened"),
                (("host", "north"), {"env": nowhere}, 3, "set MUSTER_RULES to the folder")):
            done = muster(*words, **kwargs)
            check_equal((done.returncode, done.stdout), (code, ""), f"{words}: {done.stderr}")
            check(why in done.stderr, f"{words}: {done.stderr}")


def test_who_is_not_there_is_named():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        for words, code, why in (
                (("lookup", "nobody"), 7, "no agent named nobody; muster ps lists them"),
                (("console", "nobody", "-c", "(facts)"), 7, "nobody"),
                (("group", "members", "nothing"), 7, "no group named nothing; muster group list"),
                (("send", "nobody", "hello"), 7, "to nobody: unknown-name; muster ps lists all agents"),
                (("do", "nobody", "(facts)"), 7, "to nobody: unknown-name"),
                (("service", "remove", "cleaning"), 7, "not-offered; it does not offer that; muster service list"),
                (("group", "leave", "scouts"), 7, "unknown-group; there is no such group; muster group list")):
            done = muster(*words, "--domain", domain)
            check_equal((done.returncode, done.stdout), (code, ""), f"{words}: {done.stderr}")
            check(why in done.stderr, f"{words}: {done.stderr}")


def test_who_does_not_answer_is_waited_for_no_longer():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        processes.start(program("mail_receiver"), domain, "mute", out / "heard")
        wait_for(lambda: "mute" in members(domain), 10, "mute in the white pages")
        done = muster("send", "mute", "hello", "--wait", "0.3", "--domain", domain)
        check_equal((done.returncode, done.stdout), (124, ""), done.stderr)
        check("0 of 1 answers within 0.3 s" in done.stderr, done.stderr)
        check("hello" in (out / "heard").read_text(), "it has come all the same")
