# SPDX-License-Identifier: Apache-2.0
"""muster report: the report of a run once more, from what lies in its folder."""
import json
import math
import os
import signal

from browser import Browser
from support import (BUILD, FOLLOW, MUSTER, ROOT, Processes, broker_start, check, check_equal,
                     child_of, experiment_run, folder, muster, new_domain, wait_for)

PAGES = ("tracks.svg", "bearing.svg", "report.html")
EVENTS = """
expect:
  - {sequence: ["red told mate-pos", "blue near red 3", "time > 5"]}
  - {never: "red near blue 0.1"}
  - {statistic: mail.lost, at_most: 0}
  - {statistic: red.distance_m, at_least: 1, from: 15}
"""
TEAM = f"""
name: again
world: {ROOT}/worlds/collect.world
duration: 20
robots:
  - {{name: blue, rules: {ROOT}/rules/follower.clp, body: pioneer_gripper, place: random}}
  - {{name: red,  rules: {ROOT}/rules/follower.clp, body: pioneer_gripper, pose: [0, 0, 0]}}
observer:
  - {{at: 0, do: red,  line: "(wander)"}}
  - {{at: 0, do: blue, line: "(follow red)"}}
chaos:
  - {{at: 3, push: red, force: [20, 5], for: 0.5}}
  - {{when: "red told nothing", push: red, force: [1, 0]}}
"""


def texts(path):
    return {f.name: f.read_bytes() for f in path.iterdir() if f.suffix in (".json", ".csv", ".svg",
                                                                           ".html")}


def same(before, after, names):
    for name in names:
        check(before[name] == after[name], f"{name} is another one")


def test_a_report_again_is_the_same():
    with folder() as out:
        for name, file, words in (("follow", FOLLOW, ("--duration", "40")),
                                  ("free", FOLLOW, ("--free", "--duration", "2"))):
            done, _ = experiment_run(out / name, *words, file=file)
            check_equal(done.returncode, 0, done.stderr)
            before = texts(out / name)
            for gone in PAGES:
                (out / name / gone).unlink()
            again = muster("report", out / name)
            check_equal(again.returncode, 0, f"{again.stdout} {again.stderr}")
            check_equal(sorted(texts(out / name)), sorted(before), "the files")
            same(before, texts(out / name), before)


def test_a_report_of_a_run_without_a_recording():
    with folder() as out:
        file = out / "the --seed again.yaml"
        file.write_text(TEAM + EVENTS)
        done, summary = experiment_run(out / "run", "--set", "seed=3", "--record", "none", file=file)
        check_equal((summary["file"], summary["free"]), (str(file), False), "how it was made")
        text = (out / "run/summary.json").read_text()
        (out / "run/summary.json").write_text(text.replace("muster run ", "words for people: "))
        before = texts(out / "run")
        (out / "run/report.html").unlink()
        again = muster("report", out / "run")
        check_equal(again.returncode, done.returncode, f"{again.stdout} {again.stderr}")
        after = texts(out / "run")
        same(before, after, [name for name in before if name != "report.html"])
        check(b"words for people: " in after["report.html"], "the command")
        file.unlink()
        gone = muster("report", out / "run")
        check_equal(gone.returncode, 3, "without its experiment, too")
        check("again.yaml: cannot read the experiment" in gone.stderr, gone.stderr)


def test_a_report_from_the_recording_alone():
    with folder() as out:
        file = out / "again.yaml"
        file.write_text(TEAM + EVENTS)
        done, summary = experiment_run(out / "run", "--set", "seed=3", file=file)
        before = texts(out / "run")
        for name in before:
            (out / "run" / name).unlink()
        again = muster("report", out / "run", "--json")
        check_equal(again.returncode, done.returncode, f"{again.stdout} {again.stderr}")
        after = texts(out / "run")
        same(before, after, ("run.csv", "events.csv", "tracks.svg", "bearing.svg"))
        made = json.loads(after["summary.json"])
        check_equal(made, json.loads(again.stdout), "what is said is what is written")
        for key in ("experiment", "seed", "hash", "command", "overrides", "sim_time_s",
                    "wall_time_s", "robots", "objects", "explored_fraction", "most_efficient"):
            check_equal(made[key], summary[key], key)
        check_equal([c["done"] for c in made["chaos"]], [True, False], "what was pushed")
        check_equal(made["mail"]["sent"], None, "the brokers have told nobody")
        kept = [e for e in summary["expectations"] if "mail" not in e["text"]]
        check_equal(made["expectations"], kept, "what can be judged is judged alike")


def test_every_robot_has_its_own_counters():
    """One with a random place stands behind one with a pose, wherever the file has it."""
    with folder() as out:
        (out / "silent.clp").write_text("(defrule s (position $?) => (update-sensors))\n")
        (out / "talks.clp").write_text(
            "(defrule t (position $?) => (broadcast hi there) (update-sensors))\n")
        file = out / "order.yaml"
        file.write_text(f"""
world: {ROOT}/worlds/arena.world
duration: 5
robots:
  - {{name: silent, rules: silent.clp, body: pioneer, place: random}}
  - {{name: talks, rules: talks.clp, body: pioneer, pose: [0, 0, 0]}}
""")
        _, summary = experiment_run(out / "run", file=file)
        sent = {r["name"]: r["mail_sent"] for r in summary["robots"]}
        check_equal(sent, {"talks": 50, "silent": 0}, "mails sent")
        (out / "run/summary.json").unlink()
        check_equal(muster("report", out / "run").returncode, 0, "from the recording")
        made = json.loads((out / "run/summary.json").read_text())
        check_equal(made["robots"], summary["robots"], "the recording's counters")


def test_many_agents_have_one_line():
    with folder() as out:
        (out / "talks.clp").write_text("(defrule t (time ?) => (broadcast hi) (update-sensors))\n")
        for count, words, rows in ((24, (), [f"w_{i}" for i in range(24)]), (25, (), ["25 agents"]),
                                   (24, ("--quiet",), [])):
            (out / "many.yaml").write_text(f"""
simulator: none
duration: 1
agents:
  - {{name: w, rules: talks.clp, count: {count}}}
""")
            done = muster("run", out / "many.yaml", "--out", out / "run", *words)
            said = [line.split("  ") for line in done.stdout.splitlines() if "mails sent" in line]
            check_equal([row[1] for row in said], rows, done.stdout + done.stderr)
        summary = json.loads((out / "run/summary.json").read_text())
        check_equal(len(summary["agents"]), 24, "agents of the summary")


def test_a_run_that_was_killed_has_a_report_as_far_as_it_went():
    with folder() as out, Processes() as processes:
        run = processes.start(MUSTER, "run", FOLLOW, "--quiet", "--rate", "10", "--out", out / "r")
        simulator = child_of(run, "muster-sim")
        recording = out / "r/run.mcap"
        wait_for(lambda: recording.exists() and recording.stat().st_size > 500000, 30, "steps")
        live = muster("report", out / "r")
        check_equal(live.returncode, 9, "a live run makes its report itself")
        check("a run is writing there" in live.stderr, live.stderr)
        os.kill(simulator, signal.SIGKILL)
        check_equal(run.wait(30), 5, "the run has crashed")
        check(not (out / "r/summary.json").exists(), "and has no report")
        early = muster("compare", out / "r", "--json")
        check_equal(early.returncode, 3, "no summary to compare")
        check("`muster report` with that folder makes its report" in early.stderr, early.stderr)
        done = muster("report", out / "r")
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        check("where it broke off" in done.stdout, done.stdout)
        late = muster("compare", out / "r", "--json")
        check_equal(late.returncode, 0, "compare")
        check("broke off: it counts as far as it went" in late.stderr, late.stderr)
        summary = json.loads((out / "r/summary.json").read_text())
        check_equal((summary["broke_off"], summary["hash"]), (True, "none"), "how it ended")
        check(summary["sim_time_s"] > 1, f"how far it came: {summary['sim_time_s']}")
        rows = (out / "r/run.csv").read_text().splitlines()
        check_equal(float(rows[-1].split(",")[0]), summary["sim_time_s"], "the last row")
        check("where it broke off" in (out / "r/report.html").read_text(), "the page says so")
        before = texts(out / "r")
        check_equal(muster("report", out / "r").returncode, 0, "once more")
        same(before, texts(out / "r"), before)


def test_what_is_no_folder_of_a_run():
    with folder() as out:
        experiment_run(out / "bare", "--duration", 1, "--record", "none")
        (out / "bare/run.csv").unlink()
        bare = muster("report", out / "bare")
        check_equal(bare.returncode, 3, "nothing that a report is made of")
        check("there is no run.mcap" in bare.stderr, bare.stderr)
        check_equal(muster("report").returncode, 2, "no folder named")
        check_equal(muster("report", out / "none").returncode, 3, "no such folder")
        check_equal(muster("report", out).returncode, 3, "nothing in it")
        (out / "run.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(range(200)))
        check_equal(muster("report", out).returncode, 3, "no recording")
        (out / "summary.json").write_text("{\"seed\": }")
        broken = muster("report", out)
        check_equal(broken.returncode, 3, "a broken summary")
        check("summary.json:1:" in broken.stderr, broken.stderr)


def by_hand(out, *words):
    """A simulator with one robot that spins; what it said."""
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        processes.start(BUILD / "examples/spin", "red", domain)
        for verb in ("wait", "start"):
            done = muster(verb, "red", "--domain", domain)
            check_equal((done.returncode, done.stderr), (0, ""), verb)
        done = muster("sim", ROOT / "worlds/office.world", "--robots", "red", "--seed", 7, "--record",
                      out / "run.mcap", "--domain", domain, *words, timeout=60)
        check_equal((done.returncode, done.stderr), (0, ""), "muster sim")
        return done.stdout


def test_a_simulator_by_hand_has_its_hash_and_its_report():
    with folder() as one, folder() as other, folder() as live:
        said = by_hand(one, "--duration", 9)
        check_equal(said, by_hand(other, "--duration", 9), "a second run")
        again = muster("report", one)
        check_equal((again.returncode, again.stderr), (0, ""), "muster report")
        summary = json.loads((one / "summary.json").read_text())
        check_equal(said, f"hash   {summary['hash']}\n", "the hash")
        check_equal((summary["experiment"], summary["seed"], summary["duration_s"]),
                    ("office", 7, 9), "the run")
        check_equal([robot["name"] for robot in summary["robots"]], ["red"], "who drove")
        check(summary["robots"][0]["final"]["heading_rad"] != 0, "red has not turned")
        check_equal([made["file"].split("/")[-1] for made in summary["made_of"]],
                    ["office.world", "pioneer.inc", "office.pbm"], "its files")
        check_equal(by_hand(live, "--duration", 0.5, "--free"), "", "a free run has no hash")
        check_equal(muster("report", live).returncode, 0, "its report")
        lacks = muster("verify", one / "run.mcap")
        check_equal(lacks.returncode, 3, lacks.stdout)
        check("lacks the experiment" in lacks.stderr, lacks.stderr)


def test_a_robot_that_was_placed_by_hand_is_in_the_report():
    with folder() as out:
        by_hand(out, "--duration", 2, "--place", "red pioneer 1 1 90 green")
        check_equal(muster("report", out).returncode, 0, "its report")
        final = json.loads((out / "summary.json").read_text())["robots"][0]["final"]
        # It turns about a point that is not its middle.
        off = math.hypot(final["x_m"] - 1, final["y_m"] - 1)
        check(off < 0.2, f"it stands at {final}")


def test_a_report_on_a_dark_screen_and_on_a_phone():
    """Plots are drawn for it, in each robot's own colour; what is too wide is moved, not shrunk."""
    stroke = "getComputedStyle(document.querySelector('path[stroke=\"#e70c44\"]')).stroke"
    ground = "getComputedStyle(document.querySelector('figure rect')).fill"
    text = ("(() => { const t = document.querySelector('figure text'); const m = t.getScreenCTM();"
            " return parseFloat(getComputedStyle(t).fontSize) * m.a; })()")
    with folder() as out:
        done, _ = experiment_run(out / "run", "--duration", 20)
        check_equal(done.returncode, 0, done.stderr)
        page = f"file://{out}/run/report.html"
        for dark, colors in ((False, ("rgb(231, 12, 68)", "rgb(255, 255, 255)")),
                             (True, ("rgb(255, 68, 51)", "rgb(21, 25, 29)"))):
            with Browser(page, dark=dark) as browser:
                check_equal((browser.value(stroke), browser.value(ground)), colors, f"dark: {dark}")
        with Browser(page, width=390, height=844) as browser:
            check_equal(browser.value("document.documentElement.scrollWidth"), 390, "its width")
            check(browser.value(text) >= 11, f"letters of {browser.value(text)} px")
