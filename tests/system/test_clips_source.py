# SPDX-License-Identifier: Apache-2.0
"""tools/clips-source: CLIPS as Debian's source package has it, from a file, the cache, or apt."""
import os
import subprocess

from support import ROOT, check, check_equal, folder

TOOL = ROOT / "tools" / "clips-source"
TAR = "muster/clips_6.30.orig.tar.gz"


def laid(to, **environment):
    return subprocess.run([TOOL, to], env={**os.environ, **environment}, capture_output=True,
                          text=True, timeout=120)


def is_clips(to):
    return len(list((to / "core").glob("*.c"))) == 164 and \
        '#define VERSION_STRING "6.30"' in (to / "core/constant.h").read_text()


def without_apt(out):
    """A PATH in which apt-get says that it was called, and fails."""
    (out / "bin").mkdir()
    apt = out / "bin" / "apt-get"
    apt.write_text("#!/bin/sh\necho called >&2\nexit 1\n")
    apt.chmod(0o755)
    return f"{out}/bin:{os.environ['PATH']}"


def test_it_comes_from_apt_once_and_then_from_the_cache():
    with folder() as out:
        path = without_apt(out)
        done = laid(out / "a", XDG_CACHE_HOME=str(out / "cache"), CLIPS_TAR="")
        check_equal(done.returncode, 0, f"from apt: {done.stderr}")
        check(is_clips(out / "a"), "all of it")
        again = laid(out / "a", XDG_CACHE_HOME=str(out / "cache"), CLIPS_TAR="", PATH=path)
        check_equal((again.returncode, again.stdout), (0, ""), f"from the cache: {again.stderr}")
        check(is_clips(out / "a"), "again")
        file = laid(out / "b", CLIPS_TAR=str(out / "cache" / TAR), PATH=path)
        check_equal(file.returncode, 0, f"from a file: {file.stderr}")
        check(is_clips(out / "b"), "the same")
        with open(out / "cache" / TAR, "r+b") as tar:
            tar.truncate(1000)
        broken = laid(out / "c", XDG_CACHE_HOME=str(out / "cache"), CLIPS_TAR="", PATH=path)
        check_equal(broken.returncode, 1, "what is cut is not taken, but fetched")
        check("called" in broken.stderr and "CLIPS_TAR=FILE" in broken.stderr, broken.stderr)


def test_another_file_is_refused():
    with folder() as out:
        (out / "other.tar.gz").write_text("this is no CLIPS\n")
        for name in ("other.tar.gz", "none.tar.gz"):
            done = laid(out / "a", CLIPS_TAR=str(out / name))
            check_equal(done.returncode, 1, name)
            check(f"{name} is not there, or is another file" in done.stderr, done.stderr)
            check(not (out / "a").exists(), "nothing is left behind")
        check_equal(subprocess.run([TOOL], capture_output=True).returncode, 2, "it wants a folder")
