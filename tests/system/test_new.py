# SPDX-License-Identifier: Apache-2.0
"""muster new: an experiment and a rule file that run at once, and never replace another's."""
import json
import os

from support import check, check_equal, folder, muster

NO_NAMES = ("", "../mine", "/tmp/mine", "a/b", "my team", "-", "1st", "mine\n", "é", "a" * 32, ".mine", "a'b",
            os.fsdecode(b"\xff"), "$(touch x)", "mine.yaml", "mine.clp")
NAMES = ("mine", "null", "no", "a-b.c_d", "_", "z" * 31)


def test_what_it_makes_runs_at_once():
    with folder() as home:
        for name in NAMES:
            done = muster("new", name, cwd=home)
            check_equal((done.returncode, done.stderr), (0, ""), name)
            check(f"muster run {name}.yaml" in done.stdout, done.stdout)
            run = muster("run", f"{name}.yaml", "--quiet", "--json", "--duration", 20, cwd=home)
            check_equal((run.returncode, run.stderr), (0, ""), name)
            summary = json.loads((home / "out" / f"{name}-1" / "summary.json").read_text())
            check_equal(summary["experiment"], name, "its name")
            check(summary["robots"][0]["distance_m"] > 2, f"it drives: {summary['robots']}")
            check(summary["robots"][0]["rule_firings"] > 100, f"by its rules: {summary['robots']}")
        made = {p.name for p in home.iterdir()} - {"out"}
        check_equal(made, {f"{n}.{e}" for n in NAMES for e in ("yaml", "clp")}, "files")


def test_a_line_that_is_added_is_a_second_robot():
    with folder() as home:
        done = muster("new", "pair", "--json", cwd=home)
        made = json.loads(done.stdout)
        check_equal((made["experiment"], made["rules"]), ("pair.yaml", "pair.clp"), "what was made")
        file = home / "pair.yaml"
        file.write_text(file.read_text().replace("# - {name: blue", "  - {name: blue"))
        check_equal(muster("run", "pair.yaml", "--quiet", "--duration", 1, cwd=home).returncode, 0, "a run")
        robots = json.loads((home / "out/pair-1/summary.json").read_text())["robots"]
        check_equal([r["name"] for r in robots], ["red", "blue"], "robots")


def test_what_is_there_stays():
    for taken, other in (("yaml", "clp"), ("clp", "yaml")):
        with folder() as home:
            (home / f"mine.{taken}").write_text("precious")
            done = muster("new", "mine", cwd=home)
            check_equal((done.returncode, done.stdout), (9, ""), taken)
            check(f"mine.{taken} is there already" in done.stderr, done.stderr)
            check_equal((home / f"mine.{taken}").read_text(), "precious", "it stays")
            check(not (home / f"mine.{other}").exists(), "half of it")


def test_a_link_is_not_followed():
    with folder() as home:
        (home / "mine.yaml").symlink_to(home / "elsewhere")
        check_equal(muster("new", "mine", cwd=home).returncode, 9, "a link")
        check(not (home / "elsewhere").exists(), "it was followed")


def test_names_from_hell_are_refused():
    with folder() as home:
        for name in NO_NAMES:
            done = muster("new", "--", name, cwd=home)
            check_equal((done.returncode, done.stdout), (2, ""), repr(name))
            check("is no name" in done.stderr or "name alone: muster new mine\n" in done.stderr, done.stderr)
            check(done.stderr.endswith("\n") and done.stderr[:-1].isprintable(), repr(done.stderr))
        check_equal(list(home.iterdir()), [], "nothing is made")
        check_equal(muster("new", cwd=home).returncode, 2, "no name")


def test_a_folder_that_cannot_be_written():
    done = muster("new", "mine", cwd="/proc")
    check_equal((done.returncode, done.stdout), (9, ""), done.stderr)
    check("cannot write mine.yaml" in done.stderr, done.stderr)
