# SPDX-License-Identifier: Apache-2.0
"""Programs of the user's as controllers of an experiment: how they are started, and what a run says of
those that do what one should not."""
import json
import time

import pytest
from support import (BUILD, ROOT, alive, check, check_equal, experiment_run, folder, muster, program,
                     wait_for)

FILE = """
name: own
world: {root}/worlds/arena.world
duration: {duration}
on-crash: {on_crash}
checkpoint: 0.1
robots:
  - name: red
    controller: {{program: {program}, args: [{args}]}}
  - {{name: blue, rules: {root}/rules/follower.clp}}
observer:
  - {{at: 0, do: blue, line: "(wander)"}}
"""


def run(out, *args, on_crash="stop", duration=5, path=None, words=()):
    """Runs red by the program, with blue beside it."""
    file = out / "own.yaml"
    file.write_text(FILE.format(root=ROOT, duration=duration, on_crash=on_crash,
                                program=path or program("bad_controller"),
                                args=", ".join(f'"{a}"' for a in args)))
    return experiment_run(out / f"run{time.monotonic_ns()}", *words, file=file)


def test_a_controller_runs_and_has_one_hash():
    with folder() as out:
        (one, first), (_, second) = run(out, "none"), run(out, "none")
        check_equal(one.returncode, 0, one.stderr)
        check(first["robots"][0]["distance_m"] > 0.3, f"red drove {first['robots']}")
        check_equal(second["hash"], first["hash"], "the hash")
        names = [f["file"] for f in first["made_of"]]
        check(any(n.startswith("controller/") and n.endswith("bad_controller") for n in names),
              f"the program among {names}")


def test_verify_starts_a_controller_when_it_is_asked_to():
    with folder() as out:
        own = out / "own_controller"
        own.symlink_to(program("bad_controller"))
        copy = out / "copy"
        copy.write_bytes(own.read_bytes())
        copy.chmod(0o755)
        run(out, "none", path=copy)
        recording = next(out.glob("run*/run.mcap"))
        asked = muster("verify", recording)
        check_equal(asked.returncode, 2, asked.stderr)
        check("--programs" in asked.stderr and str(copy) in asked.stderr, asked.stderr)
        same = muster("verify", "--programs", "--json", recording)
        check_equal(same.returncode, 0, same.stderr)
        check(json.loads(same.stdout)["same_controllers"], same.stdout)
        with copy.open("ab") as file:
            file.write(b"\0")
        other = muster("verify", "--programs", "--json", recording)
        check(not json.loads(other.stdout)["same_controllers"], other.stdout)
        check("another program" in other.stderr, other.stderr)
        copy.write_bytes((BUILD / "examples" / "braitenberg").read_bytes())
        another = muster("verify", "--programs", recording)
        check_equal(another.returncode, 13, another.stderr)
        copy.unlink()
        gone = muster("verify", "--programs", recording)
        check_equal(gone.returncode, 3, gone.stderr)
        check("is not here" in gone.stderr, gone.stderr)


def test_what_cannot_be_a_controller_is_said_with_its_line():
    with folder() as out:
        for path, said in ((out / "nowhere", "cannot read the program"),
                           (ROOT / "README.md", "may be started"), (out, "not the folder")):
            done, _ = run(out, path=path)
            check_equal(done.returncode, 3, done.stderr)
            check("own.yaml:" in done.stderr and said in done.stderr, done.stderr)
        file = out / "both.yaml"
        file.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 1\nrobots:\n"
                        f"  - {{name: red, rules: {ROOT}/rules/follower.clp, "
                        f"controller: {{program: {program('bad_controller')}}}}}\n")
        done, _ = experiment_run(out / "both", file=file)
        check_equal(done.returncode, 3, done.stderr)
        check("either rules: FILE, or controller" in done.stderr, done.stderr)


@pytest.mark.parametrize("deed, code, said", [
    (("early",), 5, ("red ended with exit code 9", "no licence to drive")),
    (("segfault", 20), 5, ("red was killed by signal 11", "about to fall")),
    (("end", 20), 5, ("red ended with exit code 4",)),
    (("hang", 20), 5, ("silent for 5 s at step 20: red",)),
    (("silent",), 4, ("has not registered red", "bad_controller")),
    (("alias",), 4, ("has not registered red, but as somebody",)),
])
def test_a_controller_that_fails_ends_the_run_and_is_named(deed, code, said):
    with folder() as out:
        done, _ = run(out, *deed)
        check_equal(done.returncode, code, done.stderr)
        for words in said:
            check(words in done.stderr, f"{words!r} in {done.stderr!r}")


def test_a_run_with_a_limit_waits_for_a_controller_that_is_late():
    with folder() as out:
        late = out / "late.sh"
        late.write_text(f"#!/bin/sh\nsleep 22\nexec {program('bad_controller')} \"$@\"\n")
        late.chmod(0o755)
        done, _ = run(out, "none", path=late, words=("--limit", 100))
        check_equal(done.returncode, 0, done.stderr)
        check("after 20 s (--limit S waits longer); missing: red\n" in done.stderr, done.stderr)


@pytest.mark.parametrize("deed", ["babble", "mute", "flood"])
def test_a_controller_that_is_loud_or_mute_stops_no_run(deed):
    with folder() as out:
        done, summary = run(out, deed, 10)
        check_equal(done.returncode, 0, done.stderr[-500:])
        check(summary["hash"] != "none", "it came to its end")


def test_what_a_controller_has_forked_does_not_outlive_the_run():
    with folder() as out:
        pid_file = out / "pid"
        done, _ = run(out, "fork", 10, pid_file)
        check_equal(done.returncode, 0, done.stderr)
        pid = int(pid_file.read_text())
        wait_for(lambda: not alive(pid), 5, f"the end of {pid}")


def test_a_controller_that_dies_is_started_again():
    with folder() as out:
        done, summary = run(out, "end", 20, on_crash="restart")
        check_equal(done.returncode, 0, done.stderr)
        check("red is started again" in done.stderr, done.stderr)
        check(summary["sim_time_s"] > 4.9, "the run went on")


def test_many_of_one_entry_have_a_process_each():
    with folder() as out:
        file = out / "many.yaml"
        file.write_text(f"world: {ROOT}/worlds/flat.world\nduration: 1\nrobots:\n"
                        f"  - {{name: c, count: 3, body: pioneer, place: random, "
                        f"controller: {{program: {program('bad_controller')}}}}}\n")
        done, summary = experiment_run(out / "many", file=file)
        check_equal(done.returncode, 0, done.stderr)
        check_equal([r["name"] for r in summary["robots"]], ["c_0", "c_1", "c_2"], "the robots")
