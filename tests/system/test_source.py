# SPDX-License-Identifier: Apache-2.0
"""tools/source: sources as Debian's source packages have them, from a file, the cache, or apt."""
import os
import re
import subprocess

import pytest
from support import BIN, ROOT, check, check_equal, folder

TOOL = ROOT / "tools" / "source"
# A source, its file, the variable that names a copy, how many .c files, and what one of its files says.
CLIPS = ("clips", "clips_6.30.orig.tar.gz", "CLIPS_TAR", 164, "constant.h", '#define VERSION_STRING "6.30"')
MUSL = ("musl", "musl_1.2.3.orig.tar.gz", "MUSL_TAR", 232, "sincos.c", "void sincos(double x,")
ODE = ("ode", "ode_0.16.2.orig.tar.gz", "ODE_TAR", 0, "ode/src/quickstep.cpp", "void dxQuickStepIsland(")
LIBCCD = ("libccd", "libccd_2.1.orig.tar.gz", "LIBCCD_TAR", 5, "ccd.c", "int ccdGJKIntersect(")
sources = pytest.mark.parametrize("source", [CLIPS, MUSL, ODE, LIBCCD], ids=["clips", "musl", "ode", "libccd"])


def laid(source, to, **environment):
    return subprocess.run([TOOL, source[0], to], env={**os.environ, **environment},
                          capture_output=True, text=True, timeout=120)


def is_whole(source, to):
    return len(list((to / "core").glob("*.c"))) == source[3] and \
        source[5] in (to / "core" / source[4]).read_text()


def without_apt(out):
    """A PATH in which apt-get says that it was called, and fails."""
    (out / "bin").mkdir()
    apt = out / "bin" / "apt-get"
    apt.write_text("#!/bin/sh\necho called >&2\nexit 1\n")
    apt.chmod(0o755)
    return f"{out}/bin:{os.environ['PATH']}"


@sources
def test_it_comes_from_apt_once_and_then_from_the_cache(source):
    with folder() as out:
        path, tar = without_apt(out), out / "cache/muster" / source[1]
        cached = {"XDG_CACHE_HOME": str(out / "cache"), source[2]: ""}
        done = laid(source, out / "a", **cached)
        check_equal(done.returncode, 0, f"from apt: {done.stderr}")
        check(is_whole(source, out / "a"), "all of it")
        again = laid(source, out / "a", **cached, PATH=path)
        check_equal((again.returncode, again.stdout), (0, ""), f"from the cache: {again.stderr}")
        check(is_whole(source, out / "a"), "again")
        file = laid(source, out / "b", PATH=path, **{source[2]: str(tar)})
        check_equal(file.returncode, 0, f"from a file: {file.stderr}")
        check(is_whole(source, out / "b"), "the same")
        with open(tar, "r+b") as cut:
            cut.truncate(1000)
        broken = laid(source, out / "c", **cached, PATH=path)
        check_equal(broken.returncode, 1, "what is cut is not taken, but fetched")
        check("called" in broken.stderr and f"{source[2]}=FILE" in broken.stderr, broken.stderr)


@sources
def test_another_file_is_refused(source):
    with folder() as out:
        (out / "other.tar.gz").write_text("this is no source\n")
        for name in ("other.tar.gz", "none.tar.gz"):
            done = laid(source, out / "a", **{source[2]: str(out / name)})
            check_equal(done.returncode, 1, name)
            check(f"{name} is not there, or is another file" in done.stderr, done.stderr)
            check(not (out / "a").exists(), "nothing is left behind")


def test_a_source_and_a_folder_are_wanted():
    for words in ([], ["clips"], ["lua", "build/lua"]):
        done = subprocess.run([TOOL, *words], capture_output=True, text=True)
        check_equal((done.returncode, done.stderr),
                    (2, "usage: tools/source clips|musl|ode|libccd FOLDER\n"), f"{words}")


def test_the_notice_names_the_programs_that_contain_a_source():
    notice = (ROOT / "NOTICE").read_text()
    for source, function in (("CLIPS 6.30\n---", " T EnvReset\n"), ("musl\n---", " T atan2\n")):
        named = set(re.findall(r"muster(?:-\w+)?", notice.partition(source)[2].partition(" contain ")[0]))
        built = {path.name for path in BIN.iterdir() if function in subprocess.run(
            ["nm", path], capture_output=True, text=True, timeout=60, check=True).stdout}
        check_equal(named, built, source)
