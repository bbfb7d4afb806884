# SPDX-License-Identifier: Apache-2.0
"""One seed has one hash, whatever the processor can do; what a run was computed with is told."""
import json
import os
import pathlib
import re
import subprocess
import sys

import pytest
from support import BIN, MUSTER, ROOT, check, check_equal, experiment_run, folder, muster

# glibc's sine and cosine of a processor without fused multiplication, and beams without its vectors.
OLDER = {"GLIBC_TUNABLES": "glibc.cpu.hwcaps=-FMA,-FMA_Usable,-AVX2,-AVX2_Usable,-AVX512F", "MUSTER_FAN": "sse2"}
SINES = "import math, zlib; print(zlib.crc32(repr([math.sin(k / 7) for k in range(1, 100000)]).encode()))"


def sines(**environment):
    return subprocess.run([sys.executable, "-c", SINES], env={**os.environ, **environment}, capture_output=True,
                          text=True, check=True, timeout=60).stdout


@pytest.mark.parametrize("experiment", ["follow", "collect"])
def test_a_processor_without_fused_instructions_gives_the_same_hash(experiment):
    if "fma" in pathlib.Path("/proc/cpuinfo").read_text().split():
        check(sines() != sines(**OLDER), "the C library computes another way, as on another processor")
    with folder() as out:
        hashes = set()
        for name, more in ("new", {}), ("old", OLDER):
            done = subprocess.run([MUSTER, "run", ROOT / "experiments" / f"{experiment}.yaml", "--quiet",
                                   "--duration", "20", "--out", out / name],
                                  env={**os.environ, **more}, capture_output=True, text=True, timeout=120)
            check(done.returncode in (0, 1), done.stderr)
            hashes.add(json.loads((out / name / "summary.json").read_text())["hash"])
        check_equal(len(hashes), 1, f"hashes: {hashes}")


def test_programs_behind_scripts_give_the_same_hash():
    """As an emulator has them: agents without a body are agents, whatever name their file has."""
    with folder() as out:
        subprocess.run([ROOT / "tools/emulate", BIN.parent, out / "other", "env"], check=True, timeout=60)
        hashes = set()
        for program in MUSTER, out / "other/bin/muster":
            subprocess.run([program, "run", ROOT / "experiments/office.yaml", "--quiet", "--out", out / "run"],
                           check=True, timeout=60)
            hashes.add(json.loads((out / "run/summary.json").read_text())["hash"])
        check_equal(len(hashes), 1, f"hashes: {hashes}")


def test_arithmetic_is_told_and_another_one_before_anything_else():
    """A recording and a report that were computed another way: by verify and compare, exit code 13."""
    with folder() as out:
        _, summary = experiment_run(out / "run", "--duration", "2")
        check_equal(summary["arithmetic"], "musl 1.2.3", "in the summary")
        check_equal(summary["architecture"], os.uname().machine, "its architecture")
        check("processor" in summary, f"{sorted(summary)}")
        recording = (out / "run/run.mcap").read_bytes()
        check(recording.count(b"arithmetic") == 1, "the recording has it, once")
        version = muster("--version").stdout.split()[-1]
        older = re.sub(r"\d", "0", version)  # as long as it, in the file
        recording = recording.replace(version.encode(), older.encode())
        for name, old, new, what in (("other", b"musl 1.2.3", b"musl 0.0.9", "musl 0.0.9"),
                                     ("none", b"arithmetic", b"arithmetik", "the C library's functions")):
            (out / name).mkdir()
            file = out / name / "run.mcap"
            file.write_bytes(recording.replace(old, new))
            done = muster("verify", file)
            check_equal((done.returncode, done.stdout, done.stderr),
                        (13, "", f"{file}: the arithmetic differs: {what} in the recording, and musl 1.2.3 now; "
                                 f"verify it with the muster {older} that made it\n"), name)
            said = json.loads(muster("verify", file, "--json").stdout)
            check_equal(said, {"file": str(file), "what": "arithmetic", "recorded": what, "now": "musl 1.2.3"}, name)
            del summary["arithmetic"]
            if name == "other":
                summary["arithmetic"] = what
            summary["seed"] += 1
            (out / name / "summary.json").write_text(json.dumps(summary))
            done = muster("compare", out / "run", out / name, "--json")
            check_equal((done.returncode, json.loads(done.stderr)["error"]), (13, "other"), name)
            done = muster("compare", out / "run", out / name, "--out", out / "page.html")
            check_equal(done.returncode, 13, done.stderr)
            check_equal(done.stderr, "muster compare: the arithmetic differs, and hashes with it: "
                        f"{out}/run was computed with musl 1.2.3, {out}/{name} with {what}\n", name)
        check_equal(muster("compare", out / "run", "--json").returncode, 0, "one arithmetic")
