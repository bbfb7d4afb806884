# SPDX-License-Identifier: Apache-2.0
"""muster run --watch: the page opens by itself, and a robot moves on it within 5 s."""
import json
import os
import pathlib
import re
import signal
import stat
import time

from browser import Browser
from support import (FOLLOW, MUSTER, PATIENCE, Processes, check, check_equal, folder, muster, new_domain,
                     wait_for)

ADDRESS = r"http://127\.0\.0\.1:\d+/#token=[0-9a-f]{32}"
MOVED = "Math.max(0, ...[...document.querySelectorAll('tbody tr')].map(r => parseFloat(r.cells[2].textContent)))"


def watch(processes, out, browser, *words):
    """A run that is watched; the browser is a program of the test, with words of its own."""
    environment = {**os.environ, "BROWSER": browser, "DISPLAY": "", "WAYLAND_DISPLAY": ""}
    return processes.start(MUSTER, "run", FOLLOW, "--watch", "--domain", new_domain(), "--out", out / "r", *words,
                           env=environment, stderr=(out / "err").open("w"), stdout=(out / "out").open("w"))


def browser_make(out):
    """Notes what it is to open, and what is in that file."""
    script = out / "browse"
    script.write_text(f"#!/bin/sh\necho \"$1 $2\" > {out}/opened.new && cp -p \"$2\" {out}/page.html &&\n"
                      f"mv {out}/opened.new {out}/opened\n")
    script.chmod(0o755)
    return f"{script} --new-window"


def test_a_robot_moves_on_the_page_within_five_seconds():
    with folder() as out, Processes() as processes, Browser("about:blank") as browser:
        began = time.monotonic()
        run = watch(processes, out, browser_make(out))
        wait_for((out / "opened").exists, 5, "the browser is started")
        word, file = (out / "opened").read_text().split()
        check_equal(word, "--new-window", "words of $BROWSER")
        check_equal(stat.S_IMODE(os.stat(file).st_mode), 0o600, "the file has the token: ours alone")
        browser.call("Page.navigate", url=f"file://{file}")
        browser.wait("location.protocol === 'http:' && document.querySelectorAll('tbody tr').length === 4", 5)
        first = browser.wait(MOVED, 5)
        browser.wait(f"{MOVED} > {first}", 5)
        took_s = time.monotonic() - began
        check(took_s < 5 * PATIENCE, f"it took {took_s:.1f} s")
        browser.wait("Number(document.getElementById('time').textContent) > 1")
        check(browser.value("Number(document.getElementById('time').textContent)") < time.monotonic() - began,
              "it goes at the pace of the clock")
        run.send_signal(signal.SIGINT)
        check_equal(run.wait(20), 130, "it ends")
        check(not pathlib.Path(file).exists(), "the file is taken away")
        check(re.search(ADDRESS, (out / "err").read_text()), "the address is said all the same")


def test_without_a_browser_the_address_is_said():
    with folder() as out, Processes() as processes:
        run = watch(processes, out, "", "--rate", 40, "--duration", 20, "--json")
        check(run.wait(30) in (0, 1), (out / "err").read_text())
        said = (out / "err").read_text()
        check(re.search(ADDRESS, said) and "open the address by hand" in said, said)
        summary = json.loads((out / "out").read_text())
        plain = json.loads(muster("run", FOLLOW, "--duration", 20, "--json", "--out", out / "plain").stdout)
        check_equal(summary["hash"], plain["hash"], "the page changes nothing")


def test_a_browser_that_fails_ends_nothing():
    with folder() as out, Processes() as processes:
        run = watch(processes, out, "/nowhere/browser", "--rate", 0, "--duration", 5)
        check(run.wait(30) in (0, 1), (out / "err").read_text())


def test_one_run_is_watched():
    done = muster("run", FOLLOW, "--watch", "--seeds", "1..2")
    check_equal((done.returncode, done.stdout), (2, ""), done.stderr)
    check("--watch is for one run" in done.stderr, done.stderr)
