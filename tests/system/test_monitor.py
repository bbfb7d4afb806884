# SPDX-License-Identifier: Apache-2.0
"""Monitors and `muster top`: the figures of the report while a run goes on, and no other run."""
import fcntl
import json
import os
import pathlib
import re
import signal
import struct
import subprocess
import termios

from support import (BUILD, FOLLOW, MUSTER, PAIR, ROOT, Processes, check, check_equal, children_of,
                     experiment_run, folder, members, muster, new_domain, pair_run, places_taken,
                     wait_for)
from terminal import Terminal

WATCHER = str(BUILD / "examples" / "watcher")
ASKER = str(BUILD / "examples" / "asker")
STALLS = ROOT / "rules" / "monitor_stalls.clp"

RULES = """
(defglobal ?*mails* = 0 ?*fired* = 0 ?*steps* = 0)
(defrule steps (step (number ?)) => (bind ?*steps* (+ ?*steps* 1)))
(defrule mails (mail-seen (from ?) (outside FALSE)) => (bind ?*mails* (+ ?*mails* 1)))
(defrule rules (fired ?robot ?) => (bind ?*fired* (+ ?*fired* 1)))
(defrule first (step (number ?n) (world ?w)) (not (began)) => (assert (began))
  (printout t "first " ?n " " ?w crlf))
(defrule robots (run-ended (how ?how) (hash ?hash)) (robot (name ?r) (distance ?d) (sent ?s)
  (received ?g) (fired ?f)) => (printout t ?r " " ?d " " ?s " " ?g " " ?f crlf))
(defrule over (declare (salience -1)) (run-ended (how ?how) (hash ?hash))
  (team (explored ?explored) (most-efficient ?best))
  => (printout t ?how " " ?hash " " ?explored " " ?best " " ?*steps* " " ?*mails* " " ?*fired* crlf))
"""

# Sends red home after 2 s, and asks it now and then what it wants.
INTRUSIVE = """
(defrule direct (step (time ?t&:(> ?t 2.0))) (not (told)) => (assert (told)) (ask-one red goal))
(defrule answer ?m <- (mail (from ?who) (content $?content)) => (retract ?m)
  (printout t ?who " says " ?content crlf))
"""

# Red goes to a place, and says so in its diary.
HOME = """
name: home
world: %s
duration: 30
robots:
  - {name: red, rules: %s}
observer:
  - {at: 2, do: red, line: "(gohome -1000 -4400)"}
  - {at: 2, do: red, line: "(run)"}
"""

# A robot that drives into the wall before it, and stays there.
BUMP = """
name: bump
world: %s
duration: 30
robots:
  - {name: red, rules: %s}
observer:
  - {at: 0, do: red, line: "(run)"}
"""


def text_of(path):
    return path.read_text() if path.exists() else ""


def start(processes, path, *words):
    """Starts a program whose standard output goes into a file."""
    with open(path, "w") as f:
        return processes.start(*words, stdout=f)


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
        top = start(processes, out / "top", MUSTER, "top", "--json", "--domain", domain)
        lines = start(processes, out / "lines", MUSTER, "top", "--sort", "distance", "--every",
                      "0.1", "--domain", domain)
        watcher = start(processes, out / "watcher", WATCHER, domain)
        wait_for(lambda: places_taken(domain) == 3, 20, "three who watch")
        _, summary = experiment_run(out / "report", "--rate", "60", "--domain", domain)
        check_equal([p.wait(60) for p in (top, lines, watcher)], [0, 0, 0], "all end with it")
        seen = [json.loads(line) for line in text_of(out / "top").splitlines()]
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
        check_table(text_of(out / "lines"), summary)
        text = text_of(out / "watcher")
        check(f"hash {plain['hash']}" in text, f"the example's end: {text}")
        check("arena.world: 4 robots, seed 1\n" in text, f"the example's scene: {text}")


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


def test_top_scrolls_and_follows_the_window():
    """Twenty robots of the run and four that stand about, in a window of 24 lines, then of 40."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        processes.start(MUSTER, "run", ROOT / "experiments/crowd.yaml", "--domain", domain, "--out",
                        out / "report", "--quiet", "--rate", "1")
        with Terminal(MUSTER, "top", "--every", "3600", "--domain", domain) as t:
            fcntl.ioctl(t.fd, termios.TIOCSWINSZ, struct.pack("HHHH", 24, 60, 0, 0))
            wait_for(lambda: "w_9" in muster("top", "--once", "--domain", domain).stdout, 30,
                     "a run of many")
            t.type("S")  # whatever is typed shows what is there now
            t.type("s")
            t.wait_for("sorted by name")
            at = t.wait_for("w_0 ")
            check("yellow" not in t.text, "there is no room for the last")
            check("EXPL" not in t.text, "nor for the columns behind")
            t.type("\x1b[6~")
            at = t.wait_for("yellow", since=at)
            t.type("\x1b[5~")
            at = t.wait_for("blue", since=at)
            fcntl.ioctl(t.fd, termios.TIOCSWINSZ, struct.pack("HHHH", 40, 160, 0, 0))
            at = t.wait_for("EXPL", since=at)
            t.wait_for("yellow", since=at)
            t.type("q")
            check_equal(t.end(), 0, "q ends it")


def test_the_examples_are_short():
    for name in ("watcher", "asker"):
        lines = (ROOT / "examples" / f"{name}.c").read_text().splitlines()
        check(len(lines) < 100, f"{name}.c: {len(lines)} lines")


def test_top_needs_no_broker_and_no_run():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        none = muster("top", "--once", "--domain", domain)
        check_equal(none.returncode, 4, "nobody answers")
        check("no run in domain" in none.stderr, none.stderr)
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
        os.kill(broker, signal.SIGKILL)
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


def test_a_monitor_of_rules_sees_all_and_changes_nothing():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, plain = experiment_run(out / "plain", "--domain", domain)
        rules = out / "all.clp"
        rules.write_text(RULES)
        monitor = start(processes, out / "out", MUSTER, "monitor", "--rules", rules, "--domain",
                        domain)
        wait_for(lambda: places_taken(domain) == 1, 20, "the monitor")
        _, summary = experiment_run(out / "report", "--rate", "40", "--domain", domain)
        check_equal(monitor.wait(30), 0, "it ends with the run")
        check_equal(summary["hash"], plain["hash"], "the same hash")
        lines = text_of(out / "out").splitlines()
        last = lines[-1].split()
        check_equal(last[:2], ["done", plain["hash"]], "how it ended")
        robots = {words[0]: [float(w) for w in words[1:]]
                  for words in (line.split() for line in lines[-5:-1])}
        for r in summary["robots"]:
            want = [r["distance_m"] * 1000, r["mail_sent"], r["mail_received"],
                    r["rule_firings"]]
            check(all(abs(a - b) < 1e-6 for a, b in zip(robots[r["name"]], want)),
                  f"{r['name']}: {robots} {want}")
        check_equal(last[3], summary["most_efficient"], "most efficient")
        missed = 1201 - int(last[4])
        if missed == 0:
            check_equal(lines[0], "first 0 arena.world", "from the first step on")
            check(abs(float(last[2]) - summary["explored_fraction"]) < 1e-12, "explored")
            firings = sum(r["rule_firings"] for r in summary["robots"])
            check(0.9 * firings < int(last[6]) <= firings, f"rules fired: {last}")
            sent = sum(r["mail_sent"] for r in summary["robots"])
            check(0.99 * sent < int(last[5]) <= sent, f"mails: {last} {sent}")


SLOW = """
(defrule first (declare (salience 1)) (step) (not (began)) => (assert (began)) (printout t "it sees steps" crlf))
(defrule slow (step (number ?n)) => (loop-for-count (?i 1 60000) (+ ?i 1)))
(defrule over (run-ended (how ?how) (step ?n)) => (printout t "over: " ?how " at " ?n crlf))
"""


def test_a_monitor_that_is_late_hears_how_the_run_ended():
    for _ in range(3):
        domain = new_domain()
        with folder() as out, Processes() as processes:
            rules = out / "slow.clp"
            rules.write_text(SLOW)
            monitor = start(processes, out / "out", MUSTER, "monitor", "--rules", rules, "--domain", domain)
            run = processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out", out / "report", "--quiet",
                                  "--rate", "1", "--duration", "20")
            wait_for(lambda: "it sees steps" in text_of(out / "out"), 20, "a monitor that sees the run")
            check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "full speed")
            check_equal(run.wait(60), 0, "the run ends well")
            check_equal(monitor.wait(30), 0, "it ends with the run")
            check("over: done at 200" in text_of(out / "out"), text_of(out / "out"))


def test_the_example_rules_say_who_is_stalled():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        (out / "red.clp").write_text(
            "(defrule go (position $?) => (setSpeed 400 0) (update-sensors))\n")
        file = out / "bump.yaml"
        file.write_text(BUMP % (ROOT / "worlds/arena.world", out / "red.clp"))
        monitor = start(processes, out / "out", MUSTER, "monitor", "--rules", STALLS, "--name",
                        "eye", "--domain", domain)
        wait_for(lambda: places_taken(domain) == 1, 20, "the monitor")
        done, summary = experiment_run(out / "report", "--rate", "20", "--domain", domain, file=file)
        check_equal(monitor.wait(30), 0, f"it ends with the run: {done.stderr}")
        red = summary["robots"][0]
        check(red["stalls"] > 0, f"red has hit a wall: {red}")
        lines = text_of(out / "out").splitlines()
        check_equal(len([line for line in lines if "red is stalled at" in line]), red["stalls"],
                    f"each stall is told: {lines}")
        check_equal(lines[-1], f"done after 30.0 s: {red['distance_m']:.1f} m, most efficient red, "
                               f"longest stalled red, {red['stalled_s']:.1f} s", "the summary")


def watched(out, name, monitors, *words):
    """The pair, with monitors of its own."""
    return pair_run(out, name, monitors, *words, duration_s=30)


def test_monitors_of_an_experiment_see_all_and_change_nothing():
    with folder() as out:
        (out / "all.clp").write_text(RULES)
        _, plain = watched(out, "plain", "")
        monitors = f"""
monitors:
  - {{rules: all.clp}}
  - {{name: mine, program: {WATCHER}}}
"""
        done, _ = watched(out, "refused", monitors)
        check_equal(done.returncode, 3, "a program runs when somebody says so, and else not")
        check("refused.yaml:14:5: the monitor 'mine' is a program" in done.stderr, done.stderr)
        for _ in range(3):  # nobody waits for who gets no time for a tenth of a second
            done, summary = watched(out, "seen", monitors, "--programs")
            check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
            if ", 0 steps missed" in text_of(out / "seen/mine.log") and \
                    " 301 " in text_of(out / "seen/monitor.log"):
                break
        check_equal(summary["hash"], plain["hash"], "the hash with and without them")
        check_equal([(m["name"], m["log"], m["ended"]) for m in summary["monitors"]],
                    [("monitor", "monitor.log", "with the run"), ("mine", "mine.log", "with the run")],
                    "the report names them")
        lines = text_of(out / "seen/monitor.log").splitlines()
        check_equal(lines[0], "first 0 arena.world", "from the first step on")
        check_equal(lines[-1].split()[:2], ["done", plain["hash"]], "to the end")
        check_equal(lines[-1].split()[4], "301", "every step, at full speed")
        check(f"hash {plain['hash']}, 0 steps missed" in text_of(out / "seen/mine.log"),
              text_of(out / "seen/mine.log"))
        again = muster("verify", out / "seen/run.mcap")
        check_equal(again.returncode, 0, f"the recording, done again: {again.stdout}")


def eye_of(run):
    """The process of the run's monitor of that name."""
    pids = [pid for pid in children_of(run.pid)
            if b"--name=eye" in (pathlib.Path("/proc") / str(pid) / "cmdline").read_bytes()]
    check_equal(len(pids), 1, "the monitor's process")
    return pids[0]


def test_the_death_of_a_monitor_ends_nothing():
    with folder() as out, Processes() as processes:
        (out / "dies.clp").write_text(
            "(defrule see (step) => (printout t seen crlf))\n")
        _, plain = watched(out, "plain", "")
        file = out / "killed.yaml"
        file.write_text(PAIR % 30 + "monitors: [{name: eye, rules: dies.clp}]\n")
        with open(out / "said", "w") as said:
            run = processes.start(MUSTER, "run", file, "--quiet", "--out", out / "killed", "--rate",
                                  "10", stderr=said)
        wait_for(lambda: "seen" in text_of(out / "killed/eye.log"), 20, "it sees the run")
        os.kill(eye_of(run), signal.SIGKILL)
        check_equal(run.wait(60), 12, "something did not happen")
        summary = json.loads((out / "killed/summary.json").read_text())
        check_equal(summary["undone"], ["the monitor eye was killed by signal 9 (Killed)"], "what")
        before = (out / "killed/summary.json").read_bytes()
        check_equal(muster("report", out / "killed").returncode, 12, "the report again")
        check((out / "killed/summary.json").read_bytes() == before, "byte by byte")
        check_equal(summary["hash"], plain["hash"], "the same hash")
        check_equal(summary["monitors"][0]["ended"], "was killed by signal 9 (Killed)", "its end")
        check("the monitor eye was killed by signal 9 (Killed); the run goes on" in
              text_of(out / "said"), text_of(out / "said"))


def test_a_monitor_that_never_sees_the_run_is_named():
    """A program that says nothing of it is waited for as long as a robot is."""
    with folder() as out:
        done, summary = watched(out, "mute", "monitors: [{name: mute, program: /bin/cat}]\n",
                                "--programs")
        check_equal(done.returncode, 0, f"a program that ends at once: {done.stderr}")
        check_equal(summary["monitors"][0]["ended"], "with the run", "ends well")
        (out / "mute.sh").write_text("#!/bin/sh\nexec sleep 100\n")
        (out / "mute.sh").chmod(0o755)
        done, summary = watched(out, "waits", "monitors: [{name: mute, program: mute.sh}]\n",
                                "--programs")
        check_equal((done.returncode, summary), (4, None), done.stderr)
        check("missing: mute\n" in done.stderr, done.stderr)


def test_a_monitor_that_is_slower_than_the_run_sees_its_end():
    """It has the steps that wait for it, and how the run ended, when the simulator has gone."""
    with folder() as out:
        (out / "slow.clp").write_text("""
(deffunction burn (?n) (bind ?x 0) (loop-for-count (?i 1 ?n) do (bind ?x (+ ?x (sqrt ?i)))) ?x)
(defrule step (step (number ?n)) => (burn 3000))
(defrule over (run-ended (how ?how) (step ?n)) => (printout t ?how " " ?n crlf))
""")
        _, summary = watched(out, "slow", "monitors: [{rules: slow.clp}]\n")
        check_equal(summary["monitors"][0]["ended"], "with the run", "its end")
        check_equal(text_of(out / "slow/monitor.log"), "done 300\n", "what it saw")


def test_wrong_rules_of_a_monitor_are_a_wrong_file():
    with folder() as out:
        (out / "wrong.clp").write_text("\n(defrule x (step) => (no-such-function))\n")
        done, summary = watched(out, "a", "monitors: [{rules: none.clp}]\n")
        check_equal((done.returncode, summary), (3, None), "no such file")
        check("a.yaml:11:20: cannot read the rules" in done.stderr, done.stderr)
        done, summary = watched(out, "b", "monitors: [{rules: wrong.clp}]\n")
        check_equal((done.returncode, summary), (3, None), "a mistake in it")
        check("wrong.clp:2" in done.stderr and "no-such-function" in done.stderr, done.stderr)


def test_what_a_monitor_asked_is_asked_again_by_verify():
    with folder() as out:
        (out / "asks.clp").write_text(INTRUSIVE)
        _, plain = watched(out, "plain", "")
        _, summary = watched(out, "asked", "monitors: [{name: eye, rules: asks.clp}]\n")
        check(summary["hash"] != plain["hash"], "its mails are in the hash")
        check_equal(text_of(out / "asked/eye.log"), "red says (goal safe-wander)\n", "its log")
        again = muster("verify", out / "asked/run.mcap")
        check_equal(again.returncode, 0, f"{again.stdout} {again.stderr}")
        check(summary["hash"] in again.stdout, again.stdout)


# Asks in every step, and after forty answers for more.
ASKS = """
(defglobal ?*answers* = 0)
(defrule ask (step (number ?n&:(< ?n 290))) => (ask-one red status)
  (if (= (mod ?n 7) 0) then (ask-one blue goal)))
(defrule answer ?m <- (mail (from ?who) (content $?content)) (step (number ?n)) =>
  (retract ?m) (bind ?*answers* (+ ?*answers* 1)) (if (= ?*answers* 40) then (send blue hello red))
  (printout t ?n " " ?who " says " ?content crlf))
"""


def test_what_an_intrusive_monitor_says_belongs_to_steps():
    """At any speed one hash, and one log: the run waits for it."""
    with folder() as out:
        (out / "asks.clp").write_text(ASKS)
        monitors = "monitors: [{name: eye, rules: asks.clp}]\n"
        runs = []
        for number, words in enumerate(((), (), ("--rate", "30"))):
            done, summary = watched(out, f"run{number}", monitors, *words)
            check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
            runs.append((summary["hash"], text_of(out / f"run{number}/eye.log")))
        check_equal(runs, runs[:1] * 3, "three runs of one seed")
        lines = runs[0][1].splitlines()
        check(lines[0].startswith("3 "), f"what it saw of step 0 is asked in 1: {lines[0]}")
        check_equal(len(lines), 290 + 42, "all is answered")
        again = muster("verify", out / "run0/run.mcap")
        check_equal(again.returncode, 0, f"{again.stdout} {again.stderr}")


def test_an_intrusive_monitor_that_dies_or_stops_ends_no_run():
    with folder() as out, Processes() as processes:
        (out / "asks.clp").write_text(ASKS)
        for name, number in (("killed", signal.SIGKILL), ("stopped", signal.SIGSTOP)):
            domain, file, log = new_domain(), out / f"{name}.yaml", out / name / "eye.log"
            file.write_text(PAIR % 30 + "monitors: [{name: eye, rules: asks.clp}]\n")
            run = processes.start(MUSTER, "run", file, "--domain", domain, "--out", out / name,
                                  "--quiet", "--rate", "2")
            wait_for(lambda: "red says" in text_of(log), 30, "an answer")
            os.kill(eye_of(run), number)
            check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "faster")
            check_equal(run.wait(60), 12, "something that the file names did not happen")
            summary = json.loads((out / name / "summary.json").read_text())
            check_equal(summary["sim_time_s"], 30, "to the end")


def test_an_intrusive_monitor_asks_robots():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, plain = experiment_run(out / "plain", "--domain", domain)
        rules = out / "asks.clp"
        rules.write_text(INTRUSIVE)
        asker = start(processes, out / "asker", ASKER, domain)
        monitor = start(processes, out / "monitor", MUSTER, "monitor", "--rules", rules, "--name",
                        "eye", "--domain", domain)
        wait_for(lambda: places_taken(domain) == 2, 20, "two who watch")
        _, summary = experiment_run(out / "report", "--rate", "20", "--domain", domain)
        check_equal([asker.wait(30), monitor.wait(30)], [0, 0], "they end with the run")
        text = text_of(out / "asker")
        check(re.search(r"^red: status red [0-9.]+ ", text, re.M), text)
        check(re.search(r"^red: goal safe-wander$", text, re.M), text)
        check(re.search(r"^blue: goal follow$", text, re.M), text)
        asked, answered = map(int, re.search(r"asked (\d+), answered (\d+)", text).groups())
        check(answered >= asked - 8 > 50, f"all but the last are answered: {text[-200:]}")
        check_equal(text_of(out / "monitor"), "red says (goal safe-wander)\n", "rules ask, too")
        check(summary["hash"] != plain["hash"], "its mails are in the hash")


def test_a_monitor_that_is_stopped_or_killed_changes_nothing():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, plain = experiment_run(out / "plain", "--domain", domain)
        rules = out / "all.clp"
        rules.write_text(RULES)
        monitors = [start(processes, out / name, MUSTER, "monitor", "--rules", rules, "--name",
                          name, "--domain", domain) for name in ("stopped", "killed")]
        run = processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out", out / "report",
                              "--quiet", "--rate", "2")
        for name in ("stopped", "killed"):
            wait_for(lambda: "first" in text_of(out / name), 20, "a step")
        seen = members(domain)
        check_equal((seen["killed"]["kind"], seen["killed"]["state"]), ("special", "running"),
                    "an agent with a name")
        monitors[0].send_signal(signal.SIGSTOP)
        monitors[1].kill()
        check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "full speed")
        check_equal(run.wait(60), 0, "the run ends well")
        summary = json.loads((out / "report" / "summary.json").read_text())
        check_equal(summary["hash"], plain["hash"], "with the same hash")
        monitors[0].send_signal(signal.SIGCONT)
        check_equal(monitors[0].wait(30), 0, "it ends, too")


def test_wrong_use_of_a_monitor_is_explained():
    with folder() as out:
        check_equal(muster("monitor").returncode, 2, "it wants rules")
        check_equal(muster("monitor", "--rules", STALLS, "--name", "all").returncode, 2, "reserved")
        bad = out / "bad.clp"
        bad.write_text("(defrule x\n  (robot (nme red)) =>)\n")
        done = muster("monitor", "--rules", bad)
        check_equal(done.returncode, 3, "a bad file")
        check("bad.clp:1" in done.stderr or "bad.clp:2" in done.stderr, done.stderr)


def test_a_replay_is_a_run_to_who_watches():
    """Nothing is missed of it: every figure is that of the report."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, summary = experiment_run(out / "report", "--domain", domain)
        top = start(processes, out / "top", MUSTER, "top", "--json", "--domain", domain)
        monitor = start(processes, out / "monitor", MUSTER, "monitor", "--rules", STALLS,
                        "--domain", domain)
        (out / "all.clp").write_text(RULES)
        sums = start(processes, out / "sums", MUSTER, "monitor", "--rules", out / "all.clp",
                     "--name", "sums", "--domain", domain)
        replayed = muster("replay", out / "report" / "run.mcap", "--rate", "100", "--wait", "10",
                          "--domain", domain)
        check_equal(replayed.returncode, 0, f"the replay: {replayed.stderr}")
        check_equal([p.wait(60) for p in (top, monitor, sums)], [0, 0, 0], "they end with it")
        seen = [json.loads(line) for line in text_of(out / "top").splitlines()]
        end = seen[-1]
        check_equal((end["end"], end["hash"], end["missed"]), ("done", summary["hash"], 0), "the end")
        check_robots({r["name"]: r for r in seen[:-1] if r["step"] == end["step"]}, summary)
        check_equal(end["explored_fraction"], summary["explored_fraction"], "explored")
        check_equal(end["most_efficient"], summary["most_efficient"], "most efficient")
        check_equal(sum(end["mail_by_performative"].values()),
                    sum(r["mail_sent"] for r in summary["robots"]), "mail by performative")
        distance = sum(r["distance_m"] for r in summary["robots"])
        check_equal(text_of(out / "monitor"), f"done after 120.0 s: {distance:.1f} m, most efficient "
                                              f"{summary['most_efficient']}\n", "the rules' summary")
        lines = text_of(out / "sums").splitlines()
        check_equal(lines[0], "first 0 arena.world", "rules see the first step")
        check_equal(lines[-1].split()[3:5], [summary["most_efficient"], "1201"], "and each one")


def test_goals_of_rules_are_timed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        file = out / "home.yaml"
        file.write_text(HOME % (ROOT / "worlds/arena.world", ROOT / "rules/follower.clp"))
        done, summary = experiment_run(out / "report", "--domain", domain, file=file)
        check_equal(done.returncode, 0, done.stderr)
        top = start(processes, out / "top", MUSTER, "top", "--json", "--domain", domain)
        muster("replay", out / "report" / "run.mcap", "--rate", "100", "--wait", "10", "--domain",
               domain)
        check_equal(top.wait(60), 0, "top ends with it")
        seen = [json.loads(line) for line in text_of(out / "top").splitlines()]
        red = [r for r in seen if r.get("name") == "red"][-1]
        rows = [line.split(",") for line in (out / "report/run.csv").read_text().splitlines()[1:]]
        there = next(float(r[0]) for r in rows
                     if ((float(r[2]) + 1) ** 2 + (float(r[3]) + 4.4) ** 2) ** 0.5 <= 0.2)
        check_equal(red["at_goal"], True, f"red is there: {red}")
        check(abs(red["goal_s"] - (there - 2)) < 0.31, f"{red['goal_s']} s, there at {there} s")
