# SPDX-License-Identifier: Apache-2.0
"""Hands on the world of a run that lives: muster world place, push, reset, sensor, pace, save."""
import csv
import json
import math
import os
import pathlib
import signal
import subprocess

from support import (FOLLOW, MUSTER, ROOT, Processes, broker_start, check, check_equal, child_of,
                     experiment_run, folder, members, muster, new_domain, program, wait_for)


def world(domain, *words):
    return muster("world", *words, "--domain", domain)


def done_at(domain, *words):
    """An order that is carried out; gives the last step that does not show it."""
    done = world(domain, *words, "--json")
    check_equal((done.returncode, done.stderr), (0, ""), f"{words}")
    answer = json.loads(done.stdout)
    check_equal(answer["result"], "done", f"{words}")
    return answer["step"]


def track(out, robot):
    with open(pathlib.Path(out) / "run.csv", newline="") as f:
        return [{k: float(v) for k, v in row.items() if k != "robot"}
                for row in csv.DictReader(f) if row["robot"] == robot]


def run_start(processes, domain, out, *words):
    p = processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out", out, "--quiet", *words)
    wait_for(lambda: "red" in members(domain) and members(domain)["red"]["state"] == "running", 20,
             "red runs")
    return p


def test_orders_change_the_world_of_a_run():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = run_start(processes, domain, out / "report", "--rate", "1", "--duration", "30")
        placed = done_at(domain, "place", "red", "0", "-3", "90")
        pushed = done_at(domain, "push", "blue", "0", "-40", "--for", "0.2")
        again = done_at(domain, "reset", "red")
        check(placed <= pushed <= again, f"in this order: {placed} {pushed} {again}")
        done_at(domain, "pace", "0")
        check_equal(run.wait(60), 0, "the run ends well")
        red, blue = track(out / "report", "red"), track(out / "report", "blue")
        near = math.hypot(red[placed + 1]["x_m"], red[placed + 1]["y_m"] + 3)
        check(near < 0.1, f"red is put there: {red[placed + 1]}")
        check(math.hypot(red[placed]["x_m"], red[placed]["y_m"] + 3) > 0.5, "and was not there")
        check(abs(red[placed + 1]["heading_rad"] - math.pi / 2) < 0.1, "looking north")
        first = red[0]
        back = math.hypot(red[again + 1]["x_m"] - first["x_m"], red[again + 1]["y_m"] - first["y_m"])
        check(back < 0.1, f"and back to where it began: {red[again + 1]}")
        check(blue[pushed + 2]["y_m"] < blue[pushed]["y_m"] - 0.005,
              f"blue is pushed to the side: {blue[pushed]} {blue[pushed + 2]}")


def test_orders_for_later_come_at_their_time_or_with_their_condition():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = run_start(processes, domain, out / "report", "--rate", "1", "--duration", "30")
        waits = world(domain, "place", "red", "0", "-3", "--at", "20", "--wait", "0")
        check_equal((waits.returncode, waits.stdout), (0, "waits for its time\n"), "nobody waits")
        with open(out / "when", "w") as answer:
            when = processes.start(MUSTER, "world", "push", "blue", "0", "-40", "--when",
                                   "red at 0 -3 0.5", "--json", "--domain", domain, stdout=answer)
        check_equal(done_at(domain, "push", "green", "1", "0", "--at", "0.1") < 200, True,
                    "what is past is done at once")
        at = done_at(domain, "sensor", "yellow", "sonar", "off", "--at", "9.0")
        check_equal(at, 90, "the step of a time")
        wrong = world(domain, "push", "red", "1", "0", "--when", "red likes blue")
        check_equal(wrong.returncode, 2, "no condition")
        check("--when: " in wrong.stderr, wrong.stderr)
        nobody = world(domain, "push", "red", "1", "0", "--when", "red near nobody 1")
        check_equal(nobody.returncode, 8, "of one who is not there")
        check("nobody" in nobody.stderr, nobody.stderr)
        pace = world(domain, "pace", "2", "--at", "25")
        check_equal(pace.returncode, 2, "the pace is no matter of the run's time")
        done_at(domain, "pace", "0")
        check_equal((run.wait(60), when.wait(30)), (0, 0), "the run ends well")
        red = track(out / "report", "red")
        check(math.hypot(red[201]["x_m"], red[201]["y_m"] + 3) < 0.1, f"placed: {red[201]}")
        check(math.hypot(red[200]["x_m"], red[200]["y_m"] + 3) > 0.1, f"and not before: {red[200]}")
        check_equal(json.loads((out / "when").read_text())["step"] in (201, 202), True,
                    "blue is pushed when red is there")
        again = muster("verify", out / "report/run.mcap")
        check_equal(again.returncode, 0, f"all of it is done again: {again.stdout} {again.stderr}")


def test_what_waits_when_a_run_ends_says_so():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = run_start(processes, domain, out / "report", "--rate", "1", "--duration", "8")
        late = world(domain, "push", "red", "1", "0", "--at", "100")
        check_equal((late.returncode, run.wait(30)), (124, 0), "its time has not come")
        check("the run has ended" in late.stderr, late.stderr)


def test_a_simulator_that_is_stopped_is_not_heard_of():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = run_start(processes, domain, out / "report", "--rate", "4", "--duration", "60")
        simulator = child_of(run, "muster-sim")
        os.kill(simulator, signal.SIGSTOP)
        silent = world(domain, "place", "red", "0", "-3", "--at", "50", "--wait", "0")
        os.kill(simulator, signal.SIGCONT)
        check_equal((silent.returncode, silent.stdout), (4, ""), "nobody says that a run goes on")
        check("no simulator answers" in silent.stderr, silent.stderr)
        waits = world(domain, "place", "red", "0", "-3", "--at", "50", "--wait", "0")
        check_equal((waits.returncode, waits.stdout), (0, "waits for its time\n"), waits.stderr)


def order_while_stopped(processes, domain):
    """Orders something for later of one who is stopped when the order goes out, and once more when
    he goes on.  @return both ends; None: the command gave up before there was a run"""
    order = ("world", "place", "red", "0", "-3", "--at", "20", "--wait", "0", "--domain", domain)
    taker = processes.start(program("order_taker"), domain, "take", stdout=subprocess.PIPE)
    sayer = subprocess.Popen([program("order_taker"), str(domain), "say"], text=True,
                             stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    processes.started.append(sayer)
    check_equal(sayer.stdout.readline(), "ready\n", "who says that there is a run")
    first = subprocess.Popen([MUSTER, *map(str, order)], text=True, stdout=subprocess.PIPE,
                             stderr=subprocess.PIPE)
    processes.started.append(first)
    check_equal(taker.stdout.readline(), b"met\n", "who takes orders")
    os.kill(taker.pid, signal.SIGSTOP)
    os.waitpid(taker.pid, os.WUNTRACED)
    sayer.stdin.write("\n")
    sayer.stdin.flush()
    said = first.communicate(timeout=30)
    os.kill(taker.pid, signal.SIGCONT)
    again = muster(*order)
    return None if first.returncode == 4 else ((first.returncode, *said), again)


def test_an_order_for_later_is_with_the_simulator_or_is_said_not_to_be():
    for _ in range(5):  # on a busy machine the command may give up first
        with Processes() as processes:
            ends = order_while_stopped(processes, new_domain())
        if ends:
            break
    check(ends, "the command never heard of the run")
    (code, answer, error), again = ends
    check_equal((code, answer), (124, ""), f"an order that was not taken: {error}")
    check("the simulator has not taken the order" in error, error)
    check_equal((again.returncode, again.stdout), (0, "waits for its time\n"), again.stderr)


def test_orders_that_cannot_be_carried_out_say_why():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run_start(processes, domain, out / "report", "--rate", "1", "--duration", "60")
        for words, code, why in (
                (("place", "nobody", "1", "2"), 7, "no robot or object of that name"),
                (("push", "nobody", "1", "2"), 7, "no robot or object of that name"),
                (("reset", "nobody"), 7, "no robot or object of that name"),
                (("sensor", "nobody", "sonar", "off"), 7, "no robot or object of that name"),
                (("place", "red", "1000", "0"), 8, "outside"),
                (("place", "red", "1e308", "0", "1e308"), 8, "outside"),
                (("place", "red", "1.0", "3.7"), 8, "overlap"),
                (("place", "red", "1"), 2, "expected place NAME X Y [DEG]"),
                (("place", "red", "1", "nan"), 2, "expected a number"),
                (("sensor", "red", "smell", "off"), 2, "sonar, laser, camera"),
                (("pace", "-1"), 2, "or 0"),
                (("fly", "red"), 2, "place, push")):
            done = world(domain, *words)
            check_equal((done.returncode, done.stdout), (code, ""), f"{words}: {done.stderr}")
            check(why in done.stderr, f"{words}: {done.stderr}")


def test_a_sensor_is_switched_off_and_on():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run_start(processes, domain, out / "report", "--rate", "1", "--duration", "60")

        def sonars():
            done = muster("do", "red", "(length$ (sonar))", "--domain", domain, "--wait", "5")
            check_equal(done.returncode, 0, done.stderr)
            return done.stdout.split()[-1].strip('"\\n')

        wait_for(lambda: sonars().startswith("16"), 10, "red hears its sonars")
        done_at(domain, "sensor", "red", "sonar", "off")
        wait_for(lambda: sonars().startswith("0"), 10, "red hears nothing")
        done_at(domain, "sensor", "red", "sonar", "on")
        wait_for(lambda: sonars().startswith("16"), 10, "red hears again")


def test_pace_and_a_sensor_that_nobody_reads_leave_the_hash():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = run_start(processes, domain, out / "paced", "--rate", "1", "--duration", "20")
        done_at(domain, "pace", "4")
        done_at(domain, "pace", "0")
        check_equal(run.wait(60), 0, "the run ends well")
        hashes = {json.loads((out / "paced" / "summary.json").read_text())["hash"]}
        _, summary = experiment_run(out / "plain", "--duration", "20")
        hashes.add(summary["hash"])
        check_equal(len(hashes), 1, f"{hashes}")


def test_the_slowest_and_the_fastest_pace():
    """The run ends at once behind the second order, and has answered it all the same."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = run_start(processes, domain, out / "report", "--rate", "1", "--duration", "20")
        slow = done_at(domain, "pace", "1e-300")
        check(slow <= done_at(domain, "pace", "1e300") <= slow + 1, "it stands meanwhile")
        check_equal(run.wait(60), 0, "the run ends well")


def test_without_a_simulator_nobody_answers():
    done = world(new_domain(), "reset")
    check_equal((done.returncode, done.stdout), (4, ""), done.stderr)
    check("no simulator answers" in done.stderr, done.stderr)


def positions(domain, robot):
    done = muster("do", robot, "(position)", "--domain", domain, "--wait", "5")
    check_equal(done.returncode, 0, done.stderr)
    return [float(word) for word in done.stdout.split("(")[1].split()[1:3]]


def test_a_saved_world_goes_on_where_it_was():
    domain, other = new_domain(), new_domain()
    with folder() as out, Processes() as processes:
        run = run_start(processes, domain, out / "report", "--rate", "1", "--duration", "60")
        done_at(domain, "place", "red", "0", "-3", "90")  # far from where it begins
        step = done_at(domain, "save", "state")
        (out / "report/link").symlink_to(out)
        for file, why in (("state", "exists"), ("nowhere/state", "No such file"),
                          ("../state", "leads out"), (out / "state", "leads out"),
                          ("link/state", "leads out"), ("/tmp/../tmp/state", "leads out")):
            refused = world(domain, "save", file)
            check_equal((refused.returncode, why in refused.stderr), (9, True), refused.stderr)
        check_equal([p.name for p in out.iterdir()], ["report"], "nothing is written elsewhere")
        done_at(domain, "pace", "0")
        check_equal(run.wait(60), 0, "the run ends well")
        at = track(out / "report", "red")[step + 1]
        broker_start(processes, other)
        for name in ("red", "blue", "green", "yellow"):
            processes.start(MUSTER, "robot", name, "--rules", ROOT / "rules/follower.clp",
                            "--domain", other)
        processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--domain", other, "--restore",
                        out / "report/state", "--rate", "1")
        wait_for(lambda: "(" in muster("do", "red", "(position)", "--domain", other, "--wait",
                                       "2").stdout and positions(other, "red"), 20, "red is there")
        x_mm, y_mm = positions(other, "red")
        check(math.hypot(x_mm / 1000 - at["x_m"], y_mm / 1000 - at["y_m"]) < 0.3,
              f"red goes on from {at}, not from {x_mm} {y_mm}")


def test_a_file_that_is_no_state_of_this_world_is_refused():
    with folder() as out:
        (out / "state").write_bytes(b"muster?" * 100)
        for path, why in ((out / "state", "state"), (out / "nothing", "No such file")):
            done = muster("sim", ROOT / "worlds/arena.world", "--restore", path, "--domain",
                          new_domain())
            check_equal(done.returncode, 3, done.stderr)
            check(why in done.stderr, done.stderr)
