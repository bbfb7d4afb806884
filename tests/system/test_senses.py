# SPDX-License-Identifier: Apache-2.0
"""Sensors and grippers from the world file to rules and to a controller in C."""
import csv

from support import (BUILD, MUSTER, ROOT, Processes, broker_start, check, check_equal,
                     experiment_run, folder, members, muster, new_domain, wait_for)

COLLECT = ROOT / "experiments" / "collect.yaml"
WORLD = ROOT / "worlds" / "collect.world"


def asked(domain, robot, line):
    """What a robot answers to a line, without its name."""
    done = muster("do", robot, line, "--domain", domain, "--wait", "5")
    check_equal(done.returncode, 0, f"{line}: {done.stderr}")
    return done.stdout.split(": ", 1)[-1].strip().strip('"').replace("\\n", "")


def test_robots_find_take_and_carry_pucks_the_same_way_each_time():
    with folder() as out:
        hashes = set()
        for run in ("one", "two"):
            done, summary = experiment_run(out / run, file=COLLECT)
            check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
            hashes.add(summary["hash"])
            check_equal(len(summary["objects"]), 12, "pucks in the summary")
        check_equal(len(hashes), 1, f"{hashes}")


def test_a_line_asks_for_a_sensor_and_it_can_be_switched_off():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        processes.start(MUSTER, "run", COLLECT, "--domain", domain, "--out", out / "report",
                        "--rate", "1", "--quiet")
        wait_for(lambda: members(domain).get("ada", {}).get("state") == "running", 20, "ada runs")
        beams = "(length$ (laser))"
        check_equal(asked(domain, "ada", "(findall (laser $?))"), "()", "nobody has looked at it")
        asked(domain, "ada", beams)
        wait_for(lambda: asked(domain, "ada", beams) == "181", 10, "a beam a degree")
        check(asked(domain, "ada", "(findall (laser $?))").startswith("(<Fact-"), "and the fact")
        done = muster("world", "sensor", "ada", "laser", "off", "--domain", domain)
        check_equal(done.returncode, 0, done.stderr)
        wait_for(lambda: asked(domain, "ada", beams) == "0", 10, "it is off")
        check_equal(asked(domain, "ada", "(length$ (gps))"), "3", "gps")
        check_equal(asked(domain, "ada", "(length$ (gripper))"), "5", "gripper")
        check_equal(asked(domain, "ada", "(battery)"), "FALSE", "no battery")


def test_a_controller_in_c_drives_by_laser():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        processes.start(BUILD / "examples" / "laser", "ada", domain)
        sim = processes.start(MUSTER, "sim", WORLD, "--robots", "ada", "--domain", domain, "--csv",
                              out / "run.csv", "--rate", "20", "--duration", "40")
        wait_for(lambda: "ada" in members(domain), 10, "ada")
        check_equal(muster("start", "ada", "--domain", domain).returncode, 0, "start ada")
        check_equal(sim.wait(60), 0, "the simulator ends well")
        with open(out / "run.csv", newline="") as f:
            rows = list(csv.DictReader(f))
        far = sum(abs(float(b["x_m"]) - float(a["x_m"])) + abs(float(b["y_m"]) - float(a["y_m"]))
                  for a, b in zip(rows, rows[1:]))
        check(far > 2, f"it drives: {far} m")
        check(not any(row["stalled"] == "1" for row in rows), "and touches nothing")
