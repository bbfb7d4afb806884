# SPDX-License-Identifier: Apache-2.0
"""Robots that find their way: the library's behaviours with a map."""
import csv
import json
import math
import shutil
import subprocess

from support import ROOT, check, check_equal, folder, muster

HOME = """
name: home
world: {root}/worlds/flat.world
duration: 90
robots:
  - {{name: red, rules: {root}/rules/follower.clp}}
observer:
  - {{at: 0, do: red, line: "({command})"}}
expect:
  - inside: arena
"""


def run_flat(out, command):
    file = out / "home.yaml"
    file.write_text(HOME.format(root=ROOT, command=command))
    done = muster("run", file, "--out", out / "report")
    check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
    return json.loads((out / "report" / "summary.json").read_text())


def test_gohome_goes_through_doors():
    """From the hall into a room whose far corner is behind two doors and a table."""
    with folder() as out:
        red = run_flat(out, "gohome 4800 -2000")["robots"][0]
        final = red["final"]
        check(math.hypot(final["x_m"] - 4.8, final["y_m"] + 2.0) < 0.3, f"it came to {final}")
        check_equal(red["stalls"], 0, "stalls")


def test_gohome_arrives_from_random_places():
    done = subprocess.run([ROOT / "tests/soak/gohome", "8", "120"], capture_output=True, text=True,
                          timeout=120)
    check_equal(done.returncode, 0, done.stdout + done.stderr)
    check(done.stdout.count("arrive") >= 3, done.stdout)


HALL = """
include "pioneer.inc"
model ( name "hall" size [8 6 1] boundary 1 )
model ( name "block" size [2 1 1] pose [2.5 2.5 0 0] )
{robots}
"""


def run_hall(out, commands, duration=120):
    """Robots by name in a hall of their own; gives each one's track, (time, x, y) in m."""
    shutil.copy(ROOT / "worlds" / "pioneer.inc", out)
    names = list(commands)
    (out / "hall.world").write_text(HALL.format(robots="\n".join(
        f'pioneer ( name "{name}" pose [ {-1 - 1.2 * i} -1 0 0 ] )' for i, name in enumerate(names))))
    lines = [f"name: hall\nworld: hall.world\nduration: {duration}", "robots:"]
    lines += [f"  - {{name: {name}, rules: {ROOT}/rules/follower.clp}}" for name in names]
    lines += ["observer:"]
    lines += [f'  - {{at: 0, do: {name}, line: "{line}"}}' for name, line in commands.items()]
    lines += ["expect:", "  - inside: arena"]
    (out / "hall.yaml").write_text("\n".join(lines) + "\n")
    done = muster("run", out / "hall.yaml", "--out", out / "report")
    check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
    summary = json.loads((out / "report" / "summary.json").read_text())
    for robot in summary["robots"]:
        check(robot["stalled_s"] < 0.01 * duration, f"{robot}")
    tracks = {name: [] for name in names}
    with open(out / "report" / "run.csv", newline="") as file:
        for row in csv.DictReader(file):
            tracks[row["robot"]].append((float(row["time_s"]), float(row["x_m"]), float(row["y_m"])))
    return tracks


def wall_distance(x, y):
    block = math.hypot(max(abs(x - 2.5) - 1, 0), max(abs(y - 2.5) - 0.5, 0))
    return min(4 - abs(x), 3 - abs(y), block)


def test_a_robot_follows_the_wall_round_the_hall():
    for side, way in (("left", -1), ("right", 1)):
        with folder() as out:
            track = run_hall(out, {"red": f"(follow-wall {side})"})["red"]
            later = [(x, y) for time, x, y in track if time > 30]
            near = sum(wall_distance(x, y) < 1.0 for x, y in later) / len(later)
            check(near > 0.9, f"near a wall for {near:.2f} of the time")
            turns = sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in zip(later, later[1:]))
            check(way * turns > 10, f"{side}: it went round the other way, or not at all: {turns}")


def test_a_formation_holds():
    """Behind a leader that wanders: column, line, circle, each within what its geometry says."""
    for kind, near in (("column", (0.7, 1.6)), ("line", (0.6, 2.2)), ("circle", (0.8, 2.2))):
        with folder() as out:
            tracks = run_hall(out, {"red": "(wander)", "blue": f"(formation {kind} red 1)",
                                    "green": f"(formation {kind} red 2)"})
            far = [math.dist(r[1:], b[1:]) for r, b in zip(tracks["red"], tracks["blue"])
                   if r[0] > 30]
            good = sum(near[0] <= d <= near[1] for d in far) / len(far)
            check(good > 0.8, f"{kind}: blue in its place for {good:.2f} of the time")


def test_an_explorer_comes_into_every_room():
    rooms = {"hall": lambda x, y: abs(y) < 0.9,
             "bedroom": lambda x, y: y > 1.1 and x < -2.6,
             "study": lambda x, y: y > 1.1 and -2.4 < x < 2.4,
             "kitchen": lambda x, y: y > 1.1 and x > 2.6,
             "dining room": lambda x, y: y < -1.1 and x < 0.2,
             "parlour": lambda x, y: y < -1.1 and x > 0.4}
    with folder() as out:
        file = out / "home.yaml"
        file.write_text(HOME.format(root=ROOT, command="explore 9000").replace(
            "duration: 90", "duration: 400"))
        done = muster("run", file, "--out", out / "report")
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        seen = set()
        with open(out / "report" / "run.csv", newline="") as rows:
            for row in csv.DictReader(rows):
                x, y = float(row["x_m"]), float(row["y_m"])
                seen |= {name for name, inside in rooms.items() if inside(x, y)}
        check_equal(seen, set(rooms), "rooms that it was in")
