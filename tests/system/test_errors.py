# SPDX-License-Identifier: Apache-2.0
"""Errors as JSON, the table of exit codes, and what muster says without a word."""
import json
import signal
import subprocess
import time

from support import (FOLLOW, MUSTER, ROOT, Processes, broker_start, check, check_equal, folder, muster,
                     new_domain, wait_for)

CODES = {0: "done", 1: "expectation", 2: "usage", 3: "file", 4: "no-answer", 5: "crash", 6: "refused",
         7: "unknown", 8: "undelivered", 9: "write", 10: "ambiguous", 11: "network", 12: "undone",
         13: "other", 124: "time", 130: "interrupted"}


def test_one_code_has_one_meaning():
    rows = [line.split("\t") for line in muster("help", "exits").stdout.splitlines()]
    check_equal({int(code): word for code, word, _ in rows}, CODES, "codes")
    check_equal(len({meaning for _, _, meaning in rows}), len(CODES), "meanings")
    page = (ROOT / "docs/reference/options.md").read_text()
    for code, word, meaning in rows:
        check(f"| {code} | `{word}` | {meaning} |" in page, f"{code} is not in options.md")


def test_an_error_is_an_object():
    domain = new_domain()
    with Processes() as processes, folder() as out:
        nowhere = ("--domain", domain, "--wait-broker", "0.2")
        (out / "bad.yaml").write_text("name: bad\nwrold: x\n")
        (out / "mine.clp").write_text("")
        for words, code, part in (
                (("ps", *nowhere), 4, "no broker answers"),
                (("lookup",), 2, "name one agent"),
                (("send", "red", "hello", "--level", "x"), 2, "level"),
                (("ps", "--jsn"), 2, "did you mean '--json'?"),
                (("world", "draw", out / "none.world"), 3, "none.world"),
                (("new", "mine"), 9, "mine.clp is there already"),
                (("report", out / "nothing"), 3, "nothing"),
                (("ps", "--interface", "10.9.9.9"), 11, "no such IPv4 address")):
            done = muster(*words, "--json", cwd=out)
            check_equal(done.returncode, code, f"{words}: {done.stderr}")
            error = json.loads(done.stderr)
            check_equal((error["error"], error["exit"]), (CODES[code], code), f"{words}")
            check(part in error["message"], f"{words}: {error}")
        broker_start(processes, domain)
        done = muster("lookup", "nobody", "--json", "--domain", domain)
        error = json.loads(done.stderr)
        check_equal((done.returncode, error["error"], error["exit"]), (7, "unknown", 7), "no such agent")
        done = muster("ps", "--json", "--domain", domain)
        check_equal((done.returncode, done.stderr), (0, ""), "what is well says nothing")


def test_a_verb_that_goes_on_for_long_ends_with_the_object():
    with folder() as out:
        (out / "bad.yaml").write_text("name: bad\nwrold: x\n")
        done = muster("run", out / "bad.yaml", "--json")
        check_equal(done.returncode, 3, done.stderr)
        check("bad.yaml:2:1" in done.stderr and "world" in done.stderr, done.stderr)
        check_equal(json.loads(done.stderr.splitlines()[-1])["error"], "file", "the last line")
    done = muster("wait", "--broker", "--json", "--domain", new_domain())
    check_equal(done.returncode, 2, "wait has no --json, and says so")
    check_equal(json.loads(done.stderr.splitlines()[-1])["exit"], 2, done.stderr)


def test_a_verb_with_json_is_interrupted():
    domain = new_domain()
    with Processes() as processes:
        waits = processes.start(MUSTER, "ps", "--json", "--domain", domain, "--wait-broker", 60,
                                stderr=subprocess.PIPE, text=True)
        time.sleep(0.3)
        waits.send_signal(signal.SIGTERM)
        check_equal(waits.wait(10), 130, "its code")
        check_equal(json.loads(waits.stderr.read())["error"], "interrupted", "its error")


def test_without_a_word_it_says_what_lives_and_what_to_try():
    began = time.monotonic()
    done = muster()
    check_equal((done.returncode, done.stderr), (0, ""), "nothing lives")
    check(time.monotonic() - began < 1, "it ends at once")
    check("No run of yours lives" in done.stdout and "muster run follow --watch" in done.stdout, done.stdout)
    domain = new_domain()
    with Processes() as processes, folder() as out:
        processes.start(MUSTER, "run", FOLLOW, "--rate", 1, "--duration", 60, "--domain", domain, "--out", out / "r")
        check_equal(muster("wait", "red", "blue", "green", "yellow", "--domain", domain).returncode, 0, "a run")
        line = f"  --domain {domain}  follow: 1 brokers, 4 robots, 0 hosts, "
        said = wait_for(lambda: line in (text := muster().stdout) and text, 10, "what lives")
        check("muster web --open" in said and "Runs of yours that live:" in said, said)
