#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Damaged recordings, to the programs that read them: each ends by itself, or on demand, with an
exit code of its own and nothing to complain about from the sanitizers.  Part of
`make soak-strangers`; MUSTER_SEED and MUSTER_ROUNDS choose others and more.
"""
import os
import pathlib
import random
import signal
import struct
import subprocess
import sys
import urllib.error
import urllib.request
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support" / "system"))
from support import (FOLLOW, MUSTER, Processes, folder, muster, new_domain,  # noqa: E402
                     observer_environment, program, wait_for)

BROKE = 99  # what a sanitizer ends with
CODES = {0, 1, 2, 3, 4, 5, 7, 9}
NUMBERS = (0, 1, 8, 255, 65535, 2**31 - 1, 2**31, 2**32 - 1, 2**40, 2**63, 2**64 - 1, 2**64 - 9)


def wounded(random_source, sample):
    """A copy with one to six wounds; of half of them the checksums are mended."""
    data = bytearray(sample)
    for _ in range(random_source.randint(1, 6)):
        at = random_source.randrange(len(data) - 8)
        what = random_source.randrange(10)
        if what == 0 and random_source.randrange(4) == 0:
            del data[at + 9:]
        elif what == 1:
            del data[at:at + random_source.choice((1, 2, 4, 8))]
        elif what < 6:
            number = struct.pack("<Q", random_source.choice(NUMBERS))
            data[at:at + 8] = number[:random_source.choice((1, 2, 4, 8))] + data[at + 8:at + 8]
        else:
            data[at] = random_source.randrange(256)
    if random_source.randrange(2):
        mend(data)
    return bytes(data)


def mend(data):
    """Writes the checksums of chunks anew, and takes the summary's away."""
    at = 8
    while at + 9 <= len(data):
        size = struct.unpack_from("<Q", data, at + 1)[0]
        if size > len(data) - at - 9:
            break
        if data[at] == 0x06 and size >= 40:
            crc = zlib.crc32(data[at + 9 + 40:at + 9 + size])
            struct.pack_into("<I", data, at + 9 + 24, crc)
        elif data[at] == 0x02 and size == 20:
            struct.pack_into("<I", data, at + 9 + 16, 0)
        at += 9 + size


def ended(p, what, timeout):
    """Waits for a program, and ends it when it takes too long.  Says what it broke on."""
    try:
        _, errors = p.communicate(timeout=timeout)
    except subprocess.TimeoutExpired:
        p.send_signal(signal.SIGINT)
        try:
            _, errors = p.communicate(timeout=30)
        except subprocess.TimeoutExpired:
            p.kill()
            _, errors = p.communicate()
            print(f"{what}: it does not end", flush=True)
            return False
    broke = (p.returncode < 0 and p.returncode != -signal.SIGINT) or \
        p.returncode not in CODES | {130, -signal.SIGINT} or \
        "runtime error" in errors or "AddressSanitizer" in errors
    if broke:
        print(f"{what}: {p.returncode}\n{errors[-3000:]}", flush=True)
    return not broke


def start(processes, *words):
    environment = dict(os.environ, ASAN_OPTIONS=f"exitcode={BROKE}",
                       UBSAN_OPTIONS=f"exitcode={BROKE}")
    return processes.start(MUSTER, *words, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                           text=True, errors="replace", env=environment)


def page_ask(processes, path, domain):
    """The slider's page of a recording: some moments, and why."""
    p = start(processes, "web", path, "--domain", domain, "--port", 0)
    url = p.stdout.readline().strip() if p.poll() is None else ""
    url = url.partition("#")[0]
    for question in ("recording", "tracks", "moments/3/red", "moments/7/red", "why/5/red"):
        try:
            if url:
                urllib.request.urlopen(url + question, timeout=10).read()
        except (urllib.error.URLError, OSError):
            pass  # a recording without a moment has no answer
    if p.poll() is None:
        p.send_signal(signal.SIGINT)
    return ended(p, "web", 20)


def case(processes, path, n, domain):
    good = ended(start(processes, "why", path, "red"), "why", 60)
    good = ended(start(processes, "replay", path, "--domain", domain, "--rate", 0, "--wait", 0,
                       "--topics", "all"), "replay", 30) and good
    if n % 4 == 0:
        good = page_ask(processes, path, domain) and good
        good = ended(start(processes, "verify", path), "verify", 30) and good
    return good


def samples(out):
    """A run that is moved about in, and what a program with types of its own says."""
    muster("run", FOLLOW, "--duration", 4, "--out", out / "o", timeout=120)
    domain = new_domain()
    with Processes() as processes:
        heard = out / "heard.mcap"
        record = start(processes, "record", "--all", "--domain", domain, "--out", heard)
        wait_for(lambda: heard.exists() and heard.stat().st_size > 0, 20, "the recording")
        subprocess.run([program("stranger"), str(domain), "40"], timeout=60, check=True,
                       env=observer_environment())
        last = struct.pack("<Q", 10**12 + 3 * 40)  # the number of the animal that is written last
        wait_for(lambda: last in heard.read_bytes(), 20, "the last sample")
        record.send_signal(signal.SIGINT)
        record.communicate(timeout=20)
    return [(out / "o" / "run.mcap").read_bytes(), heard.read_bytes()]


def main():
    seed = int(os.environ.get("MUSTER_SEED", random.randrange(10**6)))
    rounds = int(os.environ.get("MUSTER_ROUNDS", 100))
    random_source = random.Random(seed)
    failed = 0
    domain = new_domain()
    with folder() as out, Processes() as processes:
        recordings = samples(out)
        for n in range(rounds):
            path = out / f"wounded-{n}.mcap"
            path.write_bytes(wounded(random_source, recordings[n % 2]))
            if case(processes, path, n, domain):
                path.unlink()
            else:
                failed += 1
                kept = pathlib.Path("/tmp") / f"muster-stranger-{seed}-{n}.mcap"
                kept.write_bytes(path.read_bytes())
                print(f"  kept as {kept}", flush=True)
    print(f"seed {seed}: {rounds - failed} passed, {failed} failed")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
