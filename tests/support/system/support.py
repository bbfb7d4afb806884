# SPDX-License-Identifier: Apache-2.0
"""What the system tests share: programs, domains, processes that never stay behind."""
import contextlib
import fcntl
import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from unittest import SkipTest as Skip  # a test that cannot run here says why

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent.parent
BUILD = ROOT / "build" / os.environ.get("BUILD", "release")
BIN = BUILD / "bin"
MUSTER = str(BIN / "muster")
FOLLOW = str(ROOT / "experiments" / "follow.yaml")
# Domains of the tests: away from those that `muster run` picks first, and below the range of
# ephemeral ports.  Each process that runs tests has ten of its own, by the ports by which a run has
# its domain: no run picks one of them.
FIRST_DOMAIN, DOMAINS, SHARES = 10, 10, 8

# Rules of one that counts what came out of order, and of one that sends numbers to red.
COUNTS = """
(defglobal ?*last* = 0 ?*wrong* = 0)
(deffunction take (?from ?n ?i)
  (if (<> ?i (+ ?*last* 1)) then (bind ?*wrong* (+ ?*wrong* 1)))
  (bind ?*last* ?i))
(defrule count (position $?) =>
  (bind ?mail (getmsg))
  (while (> (length$ ?mail) 0)
    (take (expand$ ?mail))
    (bind ?mail (getmsg))))
"""
SENDS = """
(defglobal ?*n* = 0)
(defrule speak (position $?) => (bind ?*n* (+ ?*n* 1)) (send red n ?*n*) (update-sensors))
"""

# How much longer something may take here than on a machine that has nothing else to do.  Who waits
# for an event waits no longer for it than it takes.
PATIENCE = float(os.environ.get("TEST_PATIENCE", "4"))

# Blue follows red.  What a test adds begins in the eleventh line.
PAIR = f"""
name: pair
world: {ROOT}/worlds/arena.world
duration: %g
robots:
  - {{name: red,  rules: {ROOT}/rules/follower.clp}}
  - {{name: blue, rules: {ROOT}/rules/follower.clp}}
observer:
  - {{at: 0, do: red,  line: "(wander)"}}
  - {{at: 0, do: blue, line: "(follow red)"}}
"""

# Nothing of a test stays in the user's folders; who wants a store names it.
os.environ["MUSTER_STORE"] = "none"

_own = {"first": FIRST_DOMAIN, "next": 0, "claim": None}


def _domains_claim():
    """Claims a share of the domains as long as this process lives; waits for one if need be."""
    while not _own["claim"]:
        for first in range(FIRST_DOMAIN, FIRST_DOMAIN + SHARES * DOMAINS, DOMAINS):
            with contextlib.ExitStack() as claim, contextlib.suppress(OSError):
                for domain in range(first, first + DOMAINS):
                    held = claim.enter_context(socket.socket())
                    held.bind(("127.0.0.1", 7400 + 250 * domain + 10))
                _own.update(first=first, claim=claim.pop_all())
                return
        time.sleep(1)


def new_domain():
    """A DDS domain that no other test uses at the same time."""
    _domains_claim()
    _own["next"] = (_own["next"] + 1) % DOMAINS
    return _own["first"] + _own["next"]


def check(condition, why):
    if not condition:
        raise AssertionError(why)


def check_equal(got, want, what):
    check(got == want, f"{what}: got {got!r}, want {want!r}")


def wait_for(condition, seconds, what):
    """Waits for an event, not for a time: polls until it is true."""
    until = time.monotonic() + PATIENCE * seconds
    while time.monotonic() < until:
        value = condition()
        if value:
            return value
        time.sleep(0.01)
    raise AssertionError(f"not within {PATIENCE * seconds} s: {what}")


def whole_lines(path):
    """What a program has written so far; the last line may not be there to its end yet."""
    path = pathlib.Path(path)
    text = path.read_text(encoding="utf-8", errors="replace") if path.exists() else ""
    return text.split("\n")[:-1]


@contextlib.contextmanager
def folder():
    path = pathlib.Path(tempfile.mkdtemp(prefix="muster-test-"))
    try:
        yield path
    finally:
        shutil.rmtree(path, ignore_errors=True)


def muster(*words, timeout=180, **kwargs):
    """Runs one command to its end."""
    return subprocess.run([MUSTER, *map(str, words)], capture_output=True, text=True,
                          timeout=timeout, stdin=subprocess.DEVNULL, **kwargs)


def experiment_run(out, *words, file=FOLLOW, timeout=300):
    """Runs an experiment quietly; gives the process and, when there is one, its summary."""
    done = muster("run", file, "--quiet", "--out", out, *words, timeout=timeout)
    path = pathlib.Path(out) / "summary.json"
    summary = json.loads(path.read_text()) if path.exists() else None
    return done, summary


def pair_run(out, name, more, *words, duration_s=12):
    """Runs the pair with more lines in its file; gives what experiment_run does."""
    file = out / f"{name}.yaml"
    file.write_text(PAIR % duration_s + more)
    return experiment_run(out / name, *words, file=file)


def program(name):
    return str(BUILD / "programs" / name)


def preload(name):
    return str(BUILD / "preload" / f"{name}.so")


def tool_python(*modules):
    """The folder of a Python that has these modules (tests/python.txt); skips the test if not."""
    home = BUILD.parent / "python"
    try:
        subprocess.run([home / "bin" / "python", "-c", "import " + ", ".join(modules)], check=True,
                       capture_output=True)
    except (OSError, subprocess.CalledProcessError):
        raise Skip(f"no Python packages in {home}: tests/python.txt") from None
    return home


class Processes:
    """Processes that end with the test, however it ends."""

    def __init__(self):
        self.started = []

    def start(self, *words, **kwargs):
        kwargs.setdefault("stdout", subprocess.DEVNULL)
        kwargs.setdefault("stderr", subprocess.DEVNULL)
        kwargs.setdefault("stdin", subprocess.DEVNULL)
        p = subprocess.Popen([str(w) for w in words], **kwargs)
        self.started.append(p)
        return p

    def __enter__(self):
        return self

    def __exit__(self, *exc):
        for p in self.started:
            if p.poll() is None:
                p.send_signal(signal.SIGCONT)
                p.terminate()
        for p in self.started:
            try:
                p.wait(3)
            except subprocess.TimeoutExpired:
                p.kill()
                p.wait()


def broker_start(processes, domain, *words):
    p = processes.start(MUSTER, "broker", "main", "--domain", domain, *words)
    wait_for(lambda: muster("ps", "--domain", domain).returncode == 0, 10, "a broker that answers")
    return p


def members(domain):
    """The white pages as a dictionary by name."""
    done = muster("ps", "--json", "--domain", domain)
    check_equal(done.returncode, 0, f"muster ps: {done.stderr}")
    lines = [json.loads(line) for line in done.stdout.splitlines()]
    return {m["name"]: m for m in lines}


def places_taken(domain):
    """How many processes beside brokers and simulator are in a domain: by the ports of DDS that they have."""
    first = 7400 + 250 * domain + 10
    ports = {int(line.split()[1].split(":")[1], 16)
             for line in pathlib.Path("/proc/net/udp").read_text().splitlines()[1:]}
    return sum(first + 2 * index in ports for index in range(10, 120))


def observer_environment():
    """What a program that is not muster's needs to find everybody in a domain on loopback."""
    uri = ("<CycloneDDS><Domain><General><Interfaces><NetworkInterface address='127.0.0.1'/>"
           "</Interfaces><AllowMulticast>false</AllowMulticast></General><Discovery>"
           "<ParticipantIndex>auto</ParticipantIndex>"
           "<MaxAutoParticipantIndex>119</MaxAutoParticipantIndex>"
           "<Peers><Peer address='127.0.0.1'/></Peers></Discovery></Domain></CycloneDDS>")
    return {**os.environ, "CYCLONEDDS_URI": uri, "COLUMNS": "300"}


def children_of(pid):
    """Process ids whose parent this is, from /proc."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        if not entry.name.isdigit():
            continue
        try:
            stat = (entry / "stat").read_text()
        except OSError:
            continue
        fields = stat.rsplit(")", 1)[1].split()
        if int(fields[1]) == pid and fields[0] != "Z":
            found.append(int(entry.name))
    return found


def child_of(run, *words):
    """The process id of a run's child whose command line begins with these words, the program's
    name first, once it is that program."""
    def find():
        for pid in children_of(run.pid):
            try:
                line = pathlib.Path(f"/proc/{pid}/cmdline").read_text().split("\0")
            except OSError:
                continue
            if [pathlib.Path(line[0]).name, *line[1:len(words)]] == list(words):
                return pid
        return None
    return wait_for(find, 10, " ".join(words))


def alive(pid):
    try:
        state = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return False
    return state != "Z"


def command_of(pid):
    try:
        return pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")[0].decode()
    except OSError:
        return ""
