# SPDX-License-Identifier: Apache-2.0
"""muster run --seeds and muster compare: many runs, what they amount to, and their end."""
import json
import re
import shutil
import signal
import subprocess

from support import (FOLLOW, MUSTER, ROOT, Processes, alive, check, check_equal, children_of,
                     experiment_run, folder, muster, new_domain, wait_for)


def descendants(pid):
    found = []
    for child in children_of(pid):
        found += [child] + descendants(child)
    return found


def test_a_series_leaves_whole_reports_and_a_table():
    with folder() as out:
        done = muster("run", FOLLOW, "--seeds", "3,1..2", "--duration", "15", "--record", "none",
                      "--out", out)
        check_equal(done.returncode, 0, f"the series: {done.stdout} {done.stderr}")
        hashes = set()
        for seed in (1, 2, 3):
            report = out / f"follow-{seed}"
            summary = json.loads((report / "summary.json").read_text())
            check_equal(summary["seed"], seed, "the seed of a report")
            check((report / "report.html").exists() and (report / "run.csv").exists(), report)
            check(not (report / "run.mcap").exists(), "an option goes to every run")
            hashes.add(summary["hash"])
        check_equal(len(hashes), 3, "different runs")
        _, alone = experiment_run(out / "alone", "--seed", "2", "--duration", "15")
        check(alone["hash"] in hashes, "a run of the series and the same run alone")
        check(re.search(r"robots\.distance_m +follow +3 +\d", done.stdout), done.stdout)
        check("follow: 3 of 3 runs as expected" in done.stdout, done.stdout)
        page = (out / "follow-series.html").read_text()
        check("<svg" in page and "http://" not in page.replace("http://www.w3.org/", ""), "page")


def test_the_worst_exit_code_counts():
    with folder() as out:
        strict = out / "strict.yaml"
        text = (ROOT / "experiments/follow.yaml").read_text().replace("../", f"{ROOT}/")
        strict.write_text(text.split("expect:")[0] + "expect:\n  - {near: [yellow, red], "
                          "within: 0.1, from: 0, to: 5}\n")
        done = muster("run", strict, "--seeds", "1,2", "--duration", "5", "--out", out, "--json")
        check_equal(done.returncode, 1, f"a series with a failed expectation: {done.stderr}")
        runs = [json.loads(line) for line in done.stdout.splitlines()]
        check_equal(sorted(r["seed"] for r in runs), [1, 2], "one object per run")
        rules = out / "bad.clp"
        rules.write_text("(defrule broken\n")
        done = muster("run", FOLLOW, "--seeds", "1,2", "--out", out / "b", "--set",
                      f"robots.red.rules={rules}")
        check_equal(done.returncode, 3, "a series whose rules are wrong")
        check("bad.clp" in done.stderr, done.stderr)


def test_wrong_seeds_are_refused():
    for seeds in ("", "3..1", "1..5000", "1,1", "a"):
        done = muster("run", FOLLOW, "--seeds", seeds)
        check_equal((done.returncode, "--seeds" in done.stderr), (2, True), f"--seeds {seeds}")


def test_ctrl_c_ends_all_runs_and_says_what_is_done():
    with folder() as out, Processes() as processes:
        series = processes.start(MUSTER, "run", FOLLOW, "--seeds", "1..40", "--rate", "1",
                                 "--jobs", "2", "--duration", "60", "--out", out,
                                 stderr=subprocess.PIPE)
        pids = wait_for(lambda: len(descendants(series.pid)) == 14 and descendants(series.pid),
                        20, "two runs with six processes each")
        series.send_signal(signal.SIGINT)
        _, words = series.communicate(timeout=60)
        check_equal(series.returncode, 130, "exit code")
        check("interrupted: 0 of 40 runs are done" in words.decode(), words.decode())
        wait_for(lambda: not any(alive(pid) for pid in pids), 5, "the end of every process")


def test_compare_groups_by_a_key():
    with folder() as out:
        runs = []
        for seed in (1, 2):
            for color in ("red", "#00aa00"):
                runs.append(out / f"{seed}-{color[-2:]}")
                experiment_run(runs[-1], "--seed", seed, "--duration", "5", "--set",
                               f"robots.red.color={color}")
        page = out / "compare.html"
        done = muster("compare", *runs, "--out", page)
        check_equal(done.returncode, 0, done.stderr)
        check("follow, robots.red.color=#00aa00" in done.stdout, done.stdout)
        done = muster("compare", *runs, "--by", "robots.red.color", "--statistic",
                      "red.distance_m", "--statistic", "red.nothing", "--json")
        check_equal(done.returncode, 0, done.stderr)
        check("red.nothing" in done.stderr, done.stderr)
        rows = [json.loads(line) for line in done.stdout.splitlines()]
        check_equal([(r["group"], r["runs"]) for r in rows], [("red", 2), ("#00aa00", 2)], "groups")
        check_equal(rows[0]["mean"], rows[1]["mean"], "a colour changes nothing")
        distances = [json.loads((run / "summary.json").read_text())["robots"][0]["distance_m"]
                     for run in runs[::2]]
        check(abs(rows[0]["mean"] - sum(distances) / 2) < 1e-9, "the mean")
        check(rows[0]["half_width_95"] > 0, f"the interval: {rows[0]}")
        check("<svg" in page.read_text(), "the page's plots")
        check_equal(muster("compare", out / "nothing").returncode, 3, "a missing report")
        (out / "broke-off").mkdir()
        (out / "broke-off" / "run.mcap").touch()
        done = muster("compare", runs[0], page, out / "broke-off", "--json")
        check_equal((done.returncode, done.stderr.count("left out")), (0, 2), done.stderr)
        check_equal(muster("compare", page).returncode, 3, "a page alone")
        check_equal(muster("compare").returncode, 2, "no report")


def test_compare_groups_by_what_was_run():
    """Folders and seeds make no group; rules, durations and what --set says do, and are named."""
    with folder() as out:
        shutil.copytree(ROOT / "rules", out / "rules")
        file = out / "team.yaml"
        file.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 2\nrobots:\n"
                        "  - {name: red, rules: rules/follower.clp}\n")
        def run(name, *more):
            done = muster("run", file, "--quiet", "--out", out / name, *more, "--domain", new_domain())
            check_equal(done.returncode, 0, done.stderr)
            return out / name
        runs = [run("team-1", "--seed", 1), run("another", "--seed", 2),
                run("team-2", "--duration", 1), run("team-3", "--set", "robots.red.color=blue"),
                run("team-4", "--record", "none", "--free")]
        with open(out / "rules" / "follower.clp", "a") as rules:
            rules.write("; changed\n")
        runs.append(run("team-5"))
        def groups():
            done = muster("compare", *runs, "--statistic", "mail.sent", "--json")
            check_equal((done.returncode, done.stderr), (0, ""), "compared")
            return {row["group"]: row["runs"] for row in map(json.loads, done.stdout.splitlines())}
        found = groups()
        check_equal(list(found.values()), [2, 1, 1, 1, 1], found)
        for group, (name, part) in zip(found, (("team", " s"), ("team", ", 1 s"),
                                               ("team", ", robots.red.color=blue"),
                                               ("team", ", free"), ("team", ", follower.clp "))):
            check(group.startswith(name) and part in group, (group, part))
        for again in (runs[0], runs[4]):
            check_equal(muster("report", again).returncode, 0, "its report once more")
        check_equal(groups(), found, "after that")
