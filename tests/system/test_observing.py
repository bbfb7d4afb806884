# SPDX-License-Identifier: Apache-2.0
"""Who watches a run sees all of it, changes nothing, and is never waited for."""
import csv
import json
import pathlib
import signal

from support import (FOLLOW, MUSTER, ROOT, Processes, broker_start, check, check_equal,
                     experiment_run, folder, members, muster, new_domain, places_taken, program,
                     wait_for)

ROBOTS = ["red", "blue", "green", "yellow"]
RUNNING = "1"


class Seen:
    """What a frame_watcher has printed: frames and robots by step, the other lines by their word."""

    def __init__(self, path):
        self.lines = [line.split(" ") for line in pathlib.Path(path).read_text().splitlines()]
        self.steps = [int(line[1]) for line in self.of("frame")]
        self.digests = {int(line[1]): line[3] for line in self.of("frame")}
        self.robots = {(int(line[1]), line[2]): line[3:] for line in self.of("robot")}
        self.counts = {(int(line[1]), line[2]): line[3:] for line in self.of("count")}
        self.ended, self.missed, self.malformed = map(int, self.of("end")[0][1:]) \
            if self.of("end") else (None, None, None)

    def of(self, word):
        return [line for line in self.lines if line[0] == word]


def watch(processes, domain, partition, path):
    with open(path, "w") as f:
        return processes.start(program("frame_watcher"), domain, partition, stdout=f)


def run_start(processes, domain, out, *words):
    return processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out", out, "--quiet", *words)


def summary_of(out):
    return json.loads((pathlib.Path(out) / "summary.json").read_text())


def has_frames(path):
    return wait_for(lambda: "\nrobot " in pathlib.Path(path).read_text(), 20, "a frame")


def check_against_rows(seen, out):
    """Each frame says what run.csv says of its step."""
    steps = set(seen.steps)
    compared = 0
    with open(pathlib.Path(out) / "run.csv", newline="") as f:
        for row in csv.DictReader(f):
            step = round(float(row["time_s"]) * 10)
            if step not in steps:
                continue
            of_frame = seen.robots[step, row["robot"]]
            of_row = [row[k] for k in ("x_m", "y_m", "heading_rad", "forward_m_s", "turn_rad_s")]
            for got, want in zip(of_frame[1:6], of_row):
                check(abs(float(got) - float(want)) <= 5.1e-7,
                      f"step {step}, {row['robot']}: {of_frame} {row}")
            check_equal(of_frame[6], row["stalled"], f"stalled at step {step}")
            compared += 1
    check_equal(compared, len(ROBOTS) * len(steps), "rows for all frames")


def check_against_summary(seen, summary):
    last = max(seen.steps)
    check_equal(last, round(summary["sim_time_s"] * 10), "the last frame is the end")
    check_equal(seen.digests[last], summary["hash"][:16], "its digest is how the hash begins")
    for robot in summary["robots"]:
        view, count = seen.robots[last, robot["name"]], seen.counts[last, robot["name"]]
        for key, got in (("distance_m", view[7]), ("stalled_s", view[8]), ("stalls", view[9]),
                         ("rule_firings", count[0]), ("mail_sent", count[1]),
                         ("mail_received", count[2])):
            check(abs(float(got) - robot[key]) < 1e-9, f"{robot['name']} {key}: {got} {robot[key]}")


def check_steps(seen):
    check_equal(seen.steps, sorted(set(seen.steps)), "each step once, in order")
    check_equal(seen.malformed, 0, "all are well-formed")
    check_equal(seen.ended, len(seen.steps), "frames counted")
    check_equal(len(seen.steps) + seen.missed, max(seen.steps) + 1, "what is missing is counted")


def test_frames_say_what_the_report_says():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, plain = experiment_run(out / "plain", "--duration", "60", "--domain", domain)
        watchers = [watch(processes, domain, p, out / p) for p in ("every", "latest")]
        wait_for(lambda: places_taken(domain) == 2, 20, "two who watch")
        _, watched = experiment_run(out / "watched", "--duration", "60", "--rate", "40",
                                    "--domain", domain)
        for w in watchers:
            check_equal(w.wait(60), 0, "a watcher ends with the simulator")
        check_equal(watched["hash"], plain["hash"], "who watches changes nothing")
        every, latest = Seen(out / "every"), Seen(out / "latest")
        for seen in (every, latest):
            check_steps(seen)
            check_against_rows(seen, out / "watched")
            check_against_summary(seen, watched)
        check(len(every.steps) > 300, f"most steps are seen: {len(every.steps)}")
        check(1 < len(latest.steps) < len(every.steps) / 2, f"fewer are shown: {len(latest.steps)}")
        check_equal(every.of("scene"), [["scene", "arena.world", "1", "100000000", "11", "4", "0"]],
                    "the scene")
        check_equal([f[1:5] for f in every.of("figure")], [[r, "1", "16", "0"] for r in ROBOTS],
                    "its robots")
        acts = [a for a in every.of("act") if int(a[1]) == every.steps[10]]
        check_equal([a[2] for a in acts], ROBOTS, "what each did, in the order of the robots")
        check(all(int(a[3]) >= 1 and int(a[4]) >= 1 and a[5] for a in acts),
              f"rules and mails: {acts}")
        check(all(v[0] == RUNNING for (s, _), v in every.robots.items() if s >= every.steps[10]),
              "all of them run")


def test_frames_show_who_has_a_hand_in_the_run():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        watcher = watch(processes, domain, "every", out / "every")
        run = run_start(processes, domain, out / "report", "--rate", "2", "--duration", "60")
        has_frames(out / "every")
        wait_for(lambda: "red" in members(domain), 10, "red is registered")
        placed = muster("world", "place", "red", "0", "-3", "90", "--domain", domain, "--json")
        check_equal(placed.returncode, 0, f"placed: {placed.stderr}")
        step = json.loads(placed.stdout)["step"]
        sent = muster("send", "red", "hello", "there", "--domain", domain)
        check_equal(sent.returncode, 0, f"sent: {sent.stderr}")
        check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "full speed")
        check_equal(run.wait(60), 0, "the run ends well")
        check_equal(watcher.wait(60), 0, "so does the watcher")
        seen = Seen(out / "every")
        orders = seen.of("order")
        check_equal([(int(o[1]), o[4]) for o in orders], [(step, "red")], "the order at its step")
        near = [float(v) for v in seen.robots[step, "red"][1:3]]
        then = [float(v) for v in seen.robots[step + 1, "red"][1:3]]
        check(abs(near[0]) + abs(near[1] + 3) > 0.5 > abs(then[0]) + abs(then[1] + 3),
              f"the step does not show it, the next one does: {near} {then}")
        mails = [m for m in seen.of("outside") if m[3] == "red"]
        check_equal([m[4:] for m in mails], [["hello", "there"]], "the mail from outside")
        check_against_summary(seen, summary_of(out / "report"))


def test_nobody_waits_for_a_reader_that_is_stopped_or_killed():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        _, plain = experiment_run(out / "plain", "--domain", domain)
        stopped, killed, lively = (watch(processes, domain, "every", out / name)
                                   for name in ("stopped", "killed", "lively"))
        run = run_start(processes, domain, out / "report", "--rate", "2")
        for name in ("stopped", "killed", "lively"):
            has_frames(out / name)
        stopped.send_signal(signal.SIGSTOP)
        killed.kill()
        check_equal(muster("world", "pace", "0", "--domain", domain).returncode, 0, "full speed")
        # A simulator that waits for somebody gives up after 5 s, and the run fails.
        check_equal(run.wait(60), 0, "the run ends well")
        summary = summary_of(out / "report")
        check_equal(summary["hash"], plain["hash"], "with the same hash")
        check_equal(lively.wait(60), 0, "who is there sees the end")
        seen = Seen(out / "lively")
        check_steps(seen)
        check_against_rows(seen, out / "report")
        check_against_summary(seen, summary)
        stopped.send_signal(signal.SIGCONT)


def test_who_comes_late_learns_the_time_of_a_free_run():
    """A broker that is started again hands out what is due by the time of the run, not by that of
    its first Roster."""
    with folder() as out, Processes() as processes:
        domain, first, late = new_domain(), out / "first", out / "late"

        def watch(path):
            with open(path, "w") as file:
                processes.start(program("roster_watcher"), domain, stdout=file)

        broker_start(processes, domain)
        watch(first)
        wait_for(lambda: places_taken(domain) > 0, 10, "the first watcher")
        rules = out / "red.clp"
        rules.write_text("(defrule sit (position $?) => (update-sensors))\n")
        processes.start(MUSTER, "robot", "red", "--rules", rules, "--domain", domain)
        processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots", "red", "--free",
                        "--domain", domain)
        wait_for(lambda: "0 0" in first.read_text().split("\n"), 10, "the run begins")
        watch(late)
        wait_for(lambda: [line for line in late.read_text().split("\n")[:-1] if line != "0 0"], 10,
                 "a later step")
        check("1" not in [line.split()[1] for line in late.read_text().split("\n")[:-1]],
              "no lock step")
