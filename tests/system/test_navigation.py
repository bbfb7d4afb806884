# SPDX-License-Identifier: Apache-2.0
"""Robots that find their way: the library's behaviours with a map."""
import json
import math
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
    done = subprocess.run([ROOT / "tests/gohome/run", "8"], capture_output=True, text=True,
                          timeout=120)
    check_equal(done.returncode, 0, done.stdout + done.stderr)
    check(done.stdout.count("arrive") >= 3, done.stdout)
