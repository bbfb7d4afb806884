# SPDX-License-Identifier: Apache-2.0
"""What others build on: the interface of this version, versions that meet, the sensors of figures."""
import math
import platform
import re
import shutil
import subprocess

from support import (BUILD, MUSTER, ROOT, Processes, Skip, broker_start, check, check_equal, folder, members, muster,
                     new_domain, program, wait_for)

KEPT = ROOT / "tests/interface"


def interface(kept=KEPT):
    """@return how the built library and the IDL compare with what is kept"""
    if not shutil.which("abidiff"):
        raise Skip("no abidiff: package abigail-tools")
    if BUILD.name != "release" or platform.machine() != "x86_64":
        raise Skip("the interface is kept of the release build for x86_64 alone")
    return subprocess.run([ROOT / "tools/interface", kept], capture_output=True, text=True, timeout=120)


def test_the_interface_is_that_of_this_version():
    done = interface()
    check_equal(done.returncode, 0, done.stdout + done.stderr)


# A file that is kept, what is changed in it, and a part of what is said then.
CHANGES = (
    ("libmuster.abi", "var-decl name='ttl_ns'", "var-decl name='ttl_s'", "name of 'mu_mail::ttl_s' changed to 'mu_mail::ttl_ns'"),
    ("libmuster.abi", "name='mu_stats_pair' size-in-bits='256'", "name='mu_stats_pair' size-in-bits='192'",
     "'struct mu_stats_pair' changed:\n  type size changed from 24 to 32 (in bytes)"),
    ("libmuster.abi", "'MU_MAIL_DROPPED' value='7'", "'MU_MAIL_DROPPED' value='17'", "from value '17' to '7'"),
    ("libmuster.abi", "mu_agent_drive", "mu_agent_steer", "[D] 'function mu_result mu_agent_steer("),
    ("libmuster.symbols", "mu_agent_drive@@MUSTER_0\n", "", "have changed: -mu_age@@MUSTER_0 +mu_agent_drive@@MUSTER_0"),
    ("libmuster.symbols", "mu_version", "mu_age", " +mu_version@@MUSTER_0\nUndo that; or, if it is meant,"),
    ("wire", r" \w+", " 0", "The types in idl/wire.idl have changed, and WIRE is "),
    ("wire", r"^\d+", "0", "`make interface` writes that down"))


def check_named(changes):
    """One call for all, as it takes a second."""
    with folder() as out:
        shutil.copytree(KEPT, out, dirs_exist_ok=True)
        for name, old, new, _ in changes:
            text = (out / name).read_text()
            check(re.search(old, text), f"{old} is in {name}")
            (out / name).write_text(re.sub(old, new, text))
        done = interface(out)
    check_equal(done.returncode, 1, f"{changes}: {done.stderr}")
    for *_, words in changes:
        check(words in done.stdout, f"{words}: {done.stdout}")
    check("`make interface` writes" in done.stdout, f"what to do: {done.stdout}")


def test_a_change_of_the_interface_is_named():
    check_named(CHANGES[:-1])
    check_named(CHANGES[-1:])


def other_wire_start(processes, domain, what):
    return processes.start(program("other_wire"), domain, what, stdout=subprocess.PIPE, text=True)


def test_an_agent_of_another_wire_is_refused_by_name():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        said, _ = other_wire_start(processes, domain, "number").communicate(timeout=30)
        check_equal(said, "newer: other-version\n", "the answer of the broker")
        check("newer" not in members(domain), "the white pages")


OTHER = "other_wire: muster 9.0.0 wire 4000000000"


def test_a_program_of_another_wire_is_not_heard_and_named():
    """Its samples are not read, so that the number in them says nothing."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        with (out / "log").open("w") as log:
            processes.start(MUSTER, "broker", "main", "--domain", domain, stderr=log)
        other_wire_start(processes, domain, "user-data")
        wait_for(lambda: f'other-version who="{OTHER}"' in (out / "log").read_text(), 10, "a line in the broker's log")
        check("use programs of one version" in (out / "log").read_text(), "what to do")
        check("newer" not in members(domain), "the white pages")


def test_a_broker_of_another_wire_is_passed_over_and_named():
    domain = new_domain()
    with Processes() as processes:
        other_wire_start(processes, domain, "beacon")
        done = muster("ps", "--domain", domain)
        check_equal(done.returncode, 4, "nobody answers")
        check(f"a broker of another version is passed over ({OTHER}); this program is of muster " in done.stderr and
              ": use programs of one version\n" in done.stderr, done.stderr)


# A robot with sonars alone, one with all that there is, and one with nothing.
WORLD = """
include "pioneer.inc"
pioneer ( name "plain" pose [ 0 0 0 45 ] )
pioneer_gripper ( name "seeing" pose [ 3 0 0 90 ]
  fiducial ( pose [ 0.05 0.02 0 -30 ] fov 120 range_max 6 range_max_id 4 ) )
position ( name "blind" pose [ -3 0 0 0 ] size [ 0.4 0.4 0.2 ] )
"""


def mount(robot, sensor, x_m, y_m, heading_deg, fov_deg, range_m, beams):
    return (robot, sensor, x_m, y_m, math.radians(heading_deg), math.radians(fov_deg), range_m, beams)


def mounts_of_files():
    """The poses of the ring as worlds/pioneer.inc has them, and of the other sensors as they stand there and above."""
    ring = re.findall(r"pioneer_ear \( pose \[ *(\S+) +(\S+) +\S+ +(\S+) *\] \)", (ROOT / "worlds/pioneer.inc").read_text())
    check_equal(len(ring), 16, "sonars in worlds/pioneer.inc")
    sonars = [mount(robot, "sonar", *map(float, pose), 15, 5, 1) for robot in ("plain", "seeing") for pose in ring]
    return [*sonars, mount("seeing", "laser", 0.1, 0, 0, 180, 8, 181), mount("seeing", "camera", 0.1, 0, 0, 60, 6, 160),
            mount("seeing", "fiducials", 0.05, 0.02, -30, 120, 6, 1)]


def test_figures_have_their_sensors_where_the_world_has_them():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        shutil.copy(ROOT / "worlds/pioneer.inc", out)
        (out / "mounts.world").write_text(WORLD)
        processes.start(MUSTER, "sim", out / "mounts.world", "--domain", domain)
        done = subprocess.run([program("mounts_printer"), str(domain)], capture_output=True, text=True, timeout=30)
        check_equal(done.returncode, 0, done.stderr)
    lines = [line.split() for line in done.stdout.splitlines()]
    got = [(robot, sensor, *map(float, numbers)) for robot, sensor, *numbers in lines]
    wanted = mounts_of_files()
    check_equal([g[:2] for g in got], [w[:2] for w in wanted], "robots and sensors, in this order")
    for g, w in zip(got, wanted):
        check(all(abs(a - b) < 1e-6 for a, b in zip(g[2:], w[2:])), f"{g}, and not {w}")
