# SPDX-License-Identifier: Apache-2.0
"""Monitors and `muster top`: the figures of the report while a run goes on, and no other run."""
import json
import re
import signal
import subprocess
import time

from support import (BUILD, FOLLOW, MUSTER, Processes, check, check_equal, experiment_run, folder,
                     members, muster, new_domain, wait_for)
from terminal import Terminal

WATCHER = str(BUILD / "examples" / "watcher")


def text_of(path):
    return path.read_text() if path.exists() else ""


def start(processes, path, *words):
    """Starts a program whose standard output goes into a file."""
    with open(path, "w") as f:
        return processes.start(*words, stdout=f)


def whole_run(out, what):
    """Runs with somebody who watches, again where it came too late for the first steps: nobody
    waits for it.  what: starts it, waits for its end, gives the steps that it missed."""
    for attempt in range(5):
        summary, missed = what(out / str(attempt))
        if missed == 0:
            return summary
    raise AssertionError(f"five times it has not seen every step: {missed}")


def check_robots(got, summary):
    """What top says of each robot at the end is what the report says."""
    check_equal(sorted(got), sorted(r["name"] for r in summary["robots"]), "robots")
    for robot in summary["robots"]:
        for key in ("distance_m", "stalls", "stalled_s", "mean_speed_m_s", "mail_sent",
                    "mail_received", "rule_firings"):
            check(abs(got[robot["name"]][key] - robot[key]) < 1e-9,
                  f"{robot['name']} {key}: {got[robot['name']][key]} {robot[key]}")


def test_top_says_what_the_report_says_and_changes_nothing():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, plain = experiment_run(out / "plain", "--domain", domain)

        def once(to):
            to.mkdir()
            top = start(processes, to / "top", MUSTER, "top", "--json", "--domain", domain)
            lines = start(processes, to / "lines", MUSTER, "top", "--sort", "distance", "--every",
                          "0.1", "--domain", domain)
            watcher = start(processes, to / "watcher", WATCHER, domain)
            time.sleep(0.3)  # they find the domain's ports; the test holds without it, too
            _, summary = experiment_run(to / "report", "--rate", "60", "--domain", domain)
            check_equal([p.wait(20) for p in (top, lines, watcher)], [0, 0, 0], "all end with it")
            seen = [json.loads(line) for line in text_of(to / "top").splitlines()]
            check_equal(summary["hash"], plain["hash"], "with three who watch, the same hash")
            end = seen[-1]
            check_equal((end["end"], end["hash"]), ("done", plain["hash"]), "how it ended")
            last = {r["name"]: r for r in seen[:-1] if r["step"] == end["step"]}
            check_robots(last, summary)
            check_equal(end["most_efficient"], summary["most_efficient"], "most efficient")
            if end["missed"] == 0:
                check_equal(end["explored_fraction"], summary["explored_fraction"], "explored")
                check_equal(sum(end["mail_by_performative"].values()) >=
                            sum(r["mail_sent"] for r in summary["robots"]) - 8, True, "mail")
            check_table(text_of(to / "lines"), summary)
            text = text_of(to / "watcher")
            check(f"hash {plain['hash']}" in text, f"the example's end: {text}")
            check("arena.world: 4 robots, seed 1\n" in text, f"the example's scene: {text}")
            return summary, end["missed"]

        whole_run(out, once)


def check_table(text, summary):
    """The last of several tables, sorted by distance."""
    check(text.count("NAME ") > 1, f"several tables: {text}")
    rows = [line.split() for line in text[text.rindex("NAME "):].splitlines()[1:5]]
    by_distance = sorted(summary["robots"], key=lambda r: -r["distance_m"])
    check_equal([(r[0], r[2]) for r in rows],
                [(r["name"], f"{r['distance_m']:.2f}") for r in by_distance], "the last table")
    check(text.splitlines()[-1].startswith("done at step 1200, 120.0 s, hash "), "how it ended")
    check(not re.search(r"\x1b|\r", text), "plain where there is no terminal")


def test_top_on_a_terminal():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        with Terminal(MUSTER, "top", "--every", "0.1", "--domain", domain) as t:
            t.wait_for("no run yet")
            run = processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out",
                                  out / "report", "--quiet", "--rate", "10")
            t.wait_for("sorted by name")
            at = t.wait_for("yellow")
            t.type("s")
            at = t.wait_for("sorted by state", since=at)
            t.type("S")
            at = t.wait_for("sorted by name", since=at)
            t.type("\x1b[B\x1b[5~")
            check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "faster")
            check_equal(run.wait(60), 0, "the run ends well")
            t.wait_for("done at step 1200", since=at)
            t.type("q")
            check_equal(t.end(), 0, "q ends it")
            check(t.raw.rstrip().endswith(b"\x1b[?25h\x1b[?1049l"), "the terminal is given back")


def test_top_needs_no_broker_and_no_run():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        started = time.monotonic()
        none = muster("top", "--once", "--domain", domain)
        check_equal(none.returncode, 4, "nobody answers")
        check("no run in domain" in none.stderr, none.stderr)
        check(time.monotonic() - started < 30, "it does not wait for ever")
        for words in (("--sort", "\x1b[2J"), ("--goal", "red"), ("--goal", "red=1,x")):
            wrong = muster("top", *words, "--domain", domain)
            check_equal(wrong.returncode, 2, f"wrong usage: {words}")
            check("\x1b" not in wrong.stderr, "made printable")
        top = start(processes, out / "top", MUSTER, "top", "--domain", domain)
        run = processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out", out / "report",
                              "--quiet", "--rate", "2")
        wait_for(lambda: "red" in text_of(out / "top"), 20, "a table")
        once = muster("top", "--once", "--domain", domain, "--goal", "red=100,0")
        check_equal(once.returncode, 0, f"one who comes later: {once.stderr}")
        check("yellow" in once.stdout and ">" in once.stdout, once.stdout)
        broker = wait_for(lambda: members(domain)["broker"]["pid"], 10, "the broker")
        subprocess.run(["kill", "-KILL", str(broker)], check=True)
        check(run.wait(30) != 0, "a run without its broker fails")
        top.wait(30)
        end = text_of(out / "top").splitlines()[-1]
        check(re.match(r"(done|fault|lost) at step .* of 120.0 s|lost", end), f"how it ended: {end}")


def test_who_watches_and_stops_changes_nothing():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, plain = experiment_run(out / "plain", "--domain", domain)
        watchers = [start(processes, out / str(i), MUSTER, "top", "--json", "--every", "0.05",
                          "--domain", domain) for i in range(2)]
        run = processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out", out / "report",
                              "--quiet", "--rate", "2")
        for i in range(2):
            wait_for(lambda: "red" in text_of(out / str(i)), 20, "a table")
        watchers[0].send_signal(signal.SIGSTOP)
        watchers[1].kill()
        check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "full speed")
        check_equal(run.wait(60), 0, "the run ends well")
        summary = json.loads((out / "report" / "summary.json").read_text())
        check_equal(summary["hash"], plain["hash"], "with the same hash")
        watchers[0].send_signal(signal.SIGCONT)
        check(watchers[0].wait(30) in (0, 4), "it ends, too")
