# SPDX-License-Identifier: Apache-2.0
"""muster run: the same run every time, its report, its end."""
import csv
import json
import os
import pathlib
import random
import re
import signal
import socket
import subprocess
import time
import xml.dom.minidom

from support import (BIN, FOLLOW, MUSTER, ROOT, Processes, alive, check, check_equal, children_of,
                     command_of, experiment_run, folder, muster, new_domain, wait_for)
from terminal import ESCAPES, Terminal

SHORT = ("--duration", "20")


def hash_of(out, *words, **kwargs):
    done, summary = experiment_run(out, *words, **kwargs)
    check(summary, f"no summary: {done.stderr}")
    check(re.fullmatch("[0-9a-f]{64}", summary["hash"]), f"hash {summary['hash']}")
    return summary["hash"]


def test_one_seed_one_hash_another_seed_another():
    with folder() as out:
        first = hash_of(out / "a", *SHORT)
        check_equal(hash_of(out / "b", *SHORT), first, "the same seed")
        check_equal(hash_of(out / "c", *SHORT, "--rate", "40"), first, "the same seed, paced")
        check(hash_of(out / "d", *SHORT, "--seed", "2") != first, "another seed, the same hash")


def test_a_busy_machine_changes_nothing():
    with folder() as out, Processes() as processes:
        first = hash_of(out / "a", *SHORT)
        for _ in range(2):
            processes.start("timeout", "60", "sh", "-c", "while :; do :; done")
        check_equal(hash_of(out / "b", *SHORT), first, "beside two busy loops")


def test_a_changed_rule_changes_the_hash():
    with folder() as out:
        first = hash_of(out / "a", *SHORT)
        rules = out / "rules.clp"

        def rules_with(action):
            rules.write_text((ROOT / "rules/follower.clp").read_text() +
                             "\n(defrule hello (declare (salience 100)) (initial-fact)"
                             f" => (bind ?x 1) {action})\n")

        rules_with("")
        changed = hash_of(out / "b", *SHORT, "--set", f"robots.red.rules={rules}")
        check(changed != first, "one more rule fired, the same hash")
        rules_with("(send blue hello)")
        mailed = hash_of(out / "c", *SHORT, "--set", f"robots.red.rules={rules}")
        check(mailed not in (first, changed), "one more mail, the same hash")
        rules_with("(setSpeed 1 0) (update-sensors)")
        driven = hash_of(out / "d", *SHORT, "--set", f"robots.red.rules={rules}")
        check(driven not in (first, changed, mailed), "another wheel command, the same hash")


def test_looking_at_a_run_does_not_change_it():
    """A robot whose speed depends on the white pages, and a person who reads them meanwhile."""
    with folder() as out, Processes() as processes:
        rules = out / "rules.clp"
        rules.write_text((ROOT / "rules/follower.clp").read_text() +
                         "\n(defrule by-the-pages (declare (salience 100)) (position $?) =>"
                         " (setSpeed (* 20 (length$ (listing))) 5) (update-sensors))\n")
        words = ("--duration", "30", "--set", f"robots.red.rules={rules}")
        alone = hash_of(out / "a", *words)
        run, _, domain = run_start(processes, out / "b", *words, rate=20)
        while run.poll() is None:
            muster("ps", "--domain", domain)
        summary = json.loads((out / "b/summary.json").read_text())
        check_equal(summary["hash"], alone, "the hash of the run that was looked at")


def test_a_domain_that_is_taken_is_refused_by_what_has_it():
    domain = new_domain()
    words = ("run", FOLLOW, "--quiet", "--duration", "600", "--domain", domain)
    with folder() as out, socket.socket(type=socket.SOCK_DGRAM) as tool, Processes() as processes:
        tool.bind(("127.0.0.1", 7410 + 250 * domain))
        done = muster(*words, "--out", out / "a")
        check_equal((done.returncode, done.stderr), (
            4, f"muster run: other programs have the DDS ports of domain {domain}; "
            "start a DDS tool when the run lives\n"), "a program on DDS")
        tool.close()
        processes.start(MUSTER, *words, "--rate", "1", "--out", out / "b")
        wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 20, "a run")
        done = muster(*words, "--out", out / "c")
        check_equal((done.returncode, done.stderr), (
            4, f"muster run: another run has domain {domain}; "
            "without --domain and MUSTER_DOMAIN a free one is found\n"), "another run")


def test_a_broker_outlives_a_run():
    with folder() as out, Processes() as processes:
        domain = new_domain()
        processes.start(MUSTER, "broker", "main", "--domain", domain)
        for life in ("first", "second"):
            robot = processes.start(MUSTER, "robot", "red", "--rules", ROOT / "rules/follower.clp",
                                    "--domain", domain)
            simulator = processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots",
                                        "red", "--duration", "5", "--domain", domain)
            check_equal(simulator.wait(30), 0, f"the simulator of the {life} run")
            check_equal(robot.wait(30), 0, f"the robot of the {life} run")
            done = muster("send", "red", "later", "--domain", domain)
            check_equal((done.returncode, done.stdout.strip()), (0, "stored"), "mail afterwards")


def test_free_running_survives_a_robot():
    """The others keep their own bodies when one controller dies and another takes its place."""
    with Processes() as processes:
        domain = new_domain()
        processes.start(MUSTER, "broker", "main", "--domain", domain)

        def robot(name):
            return processes.start(MUSTER, "robot", name, "--rules",
                                   ROOT / "rules/follower.clp", "--domain", domain)

        red = robot("red")
        robot("blue")
        processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots", "red,blue",
                        "--free", "--domain", domain)

        def place_of(name):
            done = muster("do", name, "(position)", "--domain", domain)
            fields = done.stdout.replace("(", " ").replace(")", " ").split()
            return fields[2] if len(fields) > 3 else None

        wait_for(lambda: place_of("blue") == "-3500.0", 20, "blue in its own body")
        red.kill()
        red.wait()
        robot("red")
        wait_for(lambda: place_of("red") == "-2500.0", 20, "the new red in red's body")
        check_equal(place_of("blue"), "-3500.0", "blue's body")


def parts_of_a_run(domain, out, processes, order):
    """Starts the processes of the follow experiment by hand, in any order, without muster run."""
    robots = ("red", "blue", "green", "yellow")
    parts = [[MUSTER, "broker", "main"],
             [MUSTER, "sim", ROOT / "worlds/arena.world", "--duration", "10", "--csv",
              out / "run.csv"]]
    parts += [[MUSTER, "robot", name, "--rules", ROOT / "rules/follower.clp"] for name in robots]
    order.shuffle(parts)
    started = [(words[1], processes.start(*words, "--domain", domain)) for words in parts]
    return next(p for kind, p in started if kind == "sim")


def test_the_order_of_starting_changes_nothing():
    tracks = set()
    for seed in range(4):
        with folder() as out, Processes() as processes:
            simulator = parts_of_a_run(new_domain(), out, processes, random.Random(seed))
            check_equal(simulator.wait(60), 0, "the simulator's exit code")
            tracks.add((out / "run.csv").read_bytes())
    check_equal(len(tracks), 1, "different tracks of four orders of starting")


def test_the_report_is_whole():
    with folder() as out:
        done, summary = experiment_run(out / "r")
        check_equal(done.returncode, 0, f"the follow experiment: {done.stdout} {done.stderr}")
        report = out / "r"
        keys = {"experiment", "seed", "hash", "sim_time_s", "wall_time_s", "real_time_factor",
                "robots", "explored_fraction", "most_efficient", "mail", "expectations"}
        check(keys <= set(summary), f"keys of summary.json: {sorted(summary)}")
        check_equal([r["name"] for r in summary["robots"]], ["red", "blue", "green", "yellow"],
                    "robots")
        robot_keys = {"name", "distance_m", "stalls", "stalled_s", "mean_speed_m_s", "mail_sent",
                      "mail_received", "rule_firings", "final"}
        check(robot_keys <= set(summary["robots"][0]), f"keys: {sorted(summary['robots'][0])}")
        mail = summary["mail"]
        check_equal((mail["lost"], mail["duplicated"], mail["refused"]), (0, 0, 0), "mail")
        check(mail["sent"] > 1000, f"mail {mail}")
        check_equal(mail["sent"], mail["delivered"] + mail["waiting"] + mail["expired"],
                    "mail that is accounted for")
        for robot in summary["robots"]:
            check(robot["rule_firings"] > 100 and robot["mail_sent"] > 100, f"{robot}")
        check(all(e["met"] for e in summary["expectations"]), f"{summary['expectations']}")
        with open(report / "run.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        check_equal(len(rows), 4 * 1201, "rows of run.csv")
        check_equal(list(rows[0]), ["time_s", "robot", "x_m", "y_m", "heading_rad", "forward_m_s",
                                    "turn_rad_s", "stalled"], "columns of run.csv")
        for name in ("tracks.svg", "bearing.svg"):
            drawing = xml.dom.minidom.parse(str(report / name))
            check(drawing.getElementsByTagName("svg"), name)
        page = (report / "report.html").read_text()
        check(summary["hash"] in page and page.count("<svg") == 3, "report.html")
        experiment_run(out / "r", "--duration", "1")
        check((out / "r.1/summary.json").exists(), "the earlier report at .1")


def test_followers_follow():
    """The behaviour that the paper's figure shows, measured from the tracks."""
    with folder() as out:
        experiment_run(out / "r")
        with open(out / "r/run.csv", newline="") as file:
            rows = list(csv.DictReader(file))
    at = {}
    for row in rows:
        at.setdefault(round(float(row["time_s"]), 1), {})[row["robot"]] = row

    def share_near(who, mate, begin, end):
        near = total = 0
        for time_s, robots in at.items():
            if begin <= time_s <= end:
                dx = float(robots[who]["x_m"]) - float(robots[mate]["x_m"])
                dy = float(robots[who]["y_m"]) - float(robots[mate]["y_m"])
                near += dx * dx + dy * dy <= 2.5 * 2.5
                total += 1
        return near / total

    for who, mate in (("blue", "red"), ("green", "blue"), ("yellow", "green")):
        check(share_near(who, mate, 30, 60) >= 0.8, f"{who} near {mate}")
    check(share_near("red", "green", 80, 120) >= 0.8, "red near green after the command")


def test_free_running_goes_by_the_clock_and_has_no_hash():
    with folder() as out:
        done, summary = experiment_run(out / "r", "--free", "--duration", "5")
        check(summary, done.stderr)
        check_equal(summary["hash"], "none", "hash")
        check(summary["mail"]["delivered"] > 50, f"mail {summary['mail']}")


def wrong(text, replacement, out, name="wrong.yaml"):
    """The follow experiment with one thing changed, beside copies of what it names."""
    path = out / name
    source = pathlib.Path(FOLLOW).read_text()
    check(text in source, f"{text} in follow.yaml")
    source = source.replace(text, replacement)
    path.write_text(source.replace("../", f"{ROOT}/"))
    return path


def test_bad_files_are_refused_with_their_place():
    with folder() as out:
        bad = wrong("duration: 120", "duration: soon", out)
        done = muster("run", bad, "--quiet", "--out", out / "r")
        check_equal(done.returncode, 3, f"a bad experiment: {done.stderr}")
        check(re.search(r"wrong\.yaml:\d+:\d+: ", done.stderr), done.stderr)

        world = out / "bad.world"
        world.write_text((ROOT / "worlds/pioneer.inc").read_text() + "\ndefine x model ( size [1\n")
        done = muster("run", FOLLOW, "--quiet", "--out", out / "r", "--set", f"world={world}")
        check_equal(done.returncode, 3, f"a bad world: {done.stderr}")
        check(re.search(r"bad\.world:\d+:\d+: .*expected", done.stderr), done.stderr)

        rules = out / "bad.clp"
        rules.write_text("(defrule broken\n  (goal ?x)\n  =>\n  (setSpeed ?nope))\n")
        done = muster("run", FOLLOW, "--quiet", "--out", out / "r", "--set",
                      f"robots.red.rules={rules}")
        check_equal(done.returncode, 3, f"bad rules: {done.stderr}")
        check(re.search(r"bad\.clp:\d+: ", done.stderr), done.stderr)

        check_equal(muster("run", "nothing.yaml").returncode, 3, "a missing file")
        check_equal(muster("run", FOLLOW, "--no-such").returncode, 2, "an unknown option")
        check_equal(muster("nonsense").returncode, 2, "an unknown verb")


def test_a_robot_without_a_place_is_told_with_its_line():
    for robot, words in (("name: pink", "'pink' does not stand in this world"),
                         ("name: red, pose: [100, 0, 0]", "outside the world"),
                         ("name: w, body: pioneer, pose: [-2.5, -4.4, 0]", "overlaps robot 'red'"),
                         ("name: w, body: pionier, pose: [0, 0, 0]", "(pioneer")):
        with folder() as out:
            (out / "t.yaml").write_text(
                f"world: {ROOT}/worlds/arena.world\nduration: 1\nrobots:\n"
                f"  - {{{robot}, rules: {ROOT}/rules/patrol.clp}}\n")
            done = muster("run", out / "t.yaml", "--out", out / "r")
            check_equal(done.returncode, 3, done.stderr)
            check(f"{out}/t.yaml:4:5: " in done.stderr and words in done.stderr, done.stderr)


def run_start(processes, out, *words, rate=1):
    """A slow run in the background whose robots run, and the pids of all its processes."""
    domain = new_domain()
    run = processes.start(MUSTER, "run", FOLLOW, "--rate", rate, "--out", out, "--domain", domain,
                          *words, stderr=subprocess.PIPE)
    children = wait_for(lambda: len(children_of(run.pid)) == 6 and children_of(run.pid), 10,
                        "six children")
    wait_for(lambda: all(command_of(pid).startswith("muster-") for pid in children), 10,
             "the programs of the children")
    wait_for(lambda: running(domain) == {"red", "blue", "green", "yellow"}, 20, "running robots")
    return run, sorted(children), domain


def running(domain):
    """The robots that run, by the white pages."""
    done = muster("ps", "--json", "--domain", domain)
    pages = [json.loads(line) for line in done.stdout.splitlines()]
    return {m["name"] for m in pages if m["kind"] == "robot" and m["state"] == "running"}


def all_gone(pids):
    return not any(alive(pid) for pid in pids)


def test_ctrl_c_leaves_nothing_behind():
    with folder() as out, Processes() as processes:
        run, children, _ = run_start(processes, out / "r")
        run.send_signal(signal.SIGINT)
        _, words = run.communicate(timeout=30)
        check_equal(run.returncode, 130, "exit code")
        check(f"muster report {out / 'r'}" in words.decode(), words.decode())
        wait_for(lambda: all_gone(children), 5, "the end of every child")


def test_a_narrow_terminal_has_the_progress_on_one_line():
    with folder() as out:
        with Terminal(MUSTER, "run", FOLLOW, "--rate", 1, "--duration", 3, "--out", out / "r",
                      columns=20) as t:
            t.end(30)
        lines = [line for line in re.split(r"[\r\n]", ESCAPES.sub(b"", t.raw).decode())
                 if "simul" in line and "3.0 s" not in line]
        check(len(lines) > 3, f"progress: {t.text}")
        check_equal([line for line in lines if len(line) > 19], [], "lines that are too wide")


def test_a_taken_domain_is_named():
    with folder() as out, Processes() as processes:
        _, _, domain = run_start(processes, out / "r")
        done = muster("run", FOLLOW, "--domain", domain, "--out", out / "second")
        check_equal((done.returncode, f"has domain {domain}" in done.stderr), (4, True), done.stderr)


def test_killing_the_run_leaves_nothing_behind():
    with folder() as out, Processes() as processes:
        run, children, _ = run_start(processes, out / "r")
        run.kill()
        run.wait(30)
        wait_for(lambda: all_gone(children), 5, "the end of every child")


def test_a_killed_child_ends_the_run_and_is_named():
    for index, name in ((0, "broker"), (1, "simulator"), (3, "blue")):
        with folder() as out, Processes() as processes:
            run, children, _ = run_start(processes, out / "r")
            os.kill(children[index], signal.SIGKILL)
            _, words = run.communicate(timeout=60)
            check_equal(run.returncode, 5, f"exit code after the death of {name}")
            check(f"{name} was killed by signal 9" in words.decode(), words.decode())
            wait_for(lambda: all_gone(children), 5, "the end of every child")


def test_a_silent_controller_is_a_fault():
    with folder() as out, Processes() as processes:
        run, children, _ = run_start(processes, out / "r")
        os.kill(children[3], signal.SIGSTOP)
        _, words = run.communicate(timeout=60)
        check_equal(run.returncode, 5, "exit code")
        check("silent" in words.decode() and "blue" in words.decode(), words.decode())
        wait_for(lambda: all_gone(children), 5, "the end of every child")


def test_a_run_that_gets_no_time_hears_of_its_end():
    """Its simulator waits for it; observers have heard it all long before.

    The run is short: its end must come before the lease of the stopped process ends, 10 s."""
    with folder() as out, Processes() as processes:
        run, children, domain = run_start(processes, out / "r", "--duration", "20")
        simulator = next(pid for pid in children if command_of(pid) == "muster-sim")
        with open(out / "top", "w") as said:
            top = processes.start(MUSTER, "top", "--json", "--domain", domain, stdout=said)
        wait_for((out / "top").read_text, 20, "somebody who looks on")
        run.send_signal(signal.SIGSTOP)
        check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "full speed")
        check_equal(top.wait(30), 0, "the run is over")
        time.sleep(1.5)  # longer than the simulator waits for others
        check(alive(simulator), "the simulator has gone")
        run.send_signal(signal.SIGCONT)
        check_equal(run.wait(30), 0, "the run")
        check((out / "r/summary.json").exists(), "its report")


def test_the_command_line_reaches_a_run():
    with folder() as out, Processes() as processes:
        run, _, domain = run_start(processes, out / "r")
        options = ("--domain", domain)
        done = muster("do", "red", "(+ 40 2)", *options)
        check_equal((done.returncode, done.stdout.strip()), (0, "red: 42"), f"do: {done.stderr}")
        check_equal(muster("suspend", "red", *options).returncode, 0, "suspend")
        check_equal(running(domain), {"blue", "green", "yellow"}, "who runs without red")
        check_equal(muster("resume", "red", *options).returncode, 0, "resume")
        wait_for(lambda: "red" in running(domain), 5, "red")
        run.send_signal(signal.SIGINT)
        check_equal(run.wait(30), 130, "exit code")


def test_programs_stay_small():
    """Resident memory of a robot and of the broker while the run lives."""
    if BIN.parent.name != "release":
        return
    with folder() as out, Processes() as processes:
        run, children, _ = run_start(processes, out / "r")
        for pid, most_kb in ((children[0], 12 * 1024), (children[2], 16 * 1024)):
            status = pathlib.Path(f"/proc/{pid}/status").read_text()
            resident_kb = int(re.search(r"VmRSS:\s+(\d+)", status)[1])
            check(resident_kb <= most_kb, f"{command_of(pid)} has {resident_kb} kB resident")
