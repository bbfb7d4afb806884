# SPDX-License-Identifier: Apache-2.0
"""A recorded run goes the same way again, and says why its robots did what they did."""
import contextlib
import json
import os
import pathlib
import re
import signal
import struct
import zlib

from support import (FOLLOW, MUSTER, ROOT, Processes, check, check_equal, experiment_run, folder,
                     muster, new_domain, wait_for)

COLLECT = str(ROOT / "experiments" / "collect.yaml")
CHANNEL, MESSAGE, CHUNK, RED = 4, 5, 6, b"red\0"

# Two robots that drive at each other and at a wall, as a person told one and a mail the other.
BUMP = """world: {world}
duration: 20
robots:
  - {{name: ram, body: pioneer, pose: [0, 0, 0], rules: ram.clp}}
  - {{name: post, body: pioneer, pose: [1.2, 0, 0], rules: post.clp}}
observer:
  - {{at: 1, do: ram, line: "(assert (goal ram))"}}
"""
RAM = """(defrule ram (goal ram) (position ?time $?) => (setSpeed 400 0)
  (if (> ?time 10.0) then (send post turn)))
"""
ASLEEP = """world: {world}
duration: 6
robots:
  - {{name: ram, body: pioneer, pose: [0, 0, 0], rules: ram.clp}}
observer:
  - {{at: 1, do: ram, line: "(send-layer 1 suspend ram)"}}
  - {{at: 3, do: ram, line: "(assert (goal look around))"}}
"""
POST = """(defrule turn (message turn) (position $?) => (setSpeed 400 0))
"""


def record(out, *words, **kwargs):
    done, summary = experiment_run(out, *words, **kwargs)
    check(summary is not None, f"a run without a summary: {done.stderr}")
    return out / "run.mcap", summary


def verify(recording, *words):
    done = muster("verify", recording, *words, timeout=120)
    return done.returncode, done.stdout, done.stderr


def bump(out):
    (out / "ram.clp").write_text(RAM)
    (out / "post.clp").write_text(POST)
    (out / "bump.yaml").write_text(BUMP.format(world=ROOT / "worlds" / "arena.world"))
    return record(out / "run", file=out / "bump.yaml")


# --- verify --------------------------------------------------------------------------------------


def test_equal():
    with folder() as out:
        for file, seed in ((None, 1), (COLLECT, 3)):
            words = ("--duration", 10, "--seed", seed)
            recording, summary = record(out / "run", *words, **({"file": file} if file else {}))
            code, said, _ = verify(recording)
            check_equal(said, f"equal  101 steps\nhash   {summary['hash']}\n", "verify")
            check_equal(code, 0, "exit code")


def test_files_from_elsewhere():
    """Relative and absolute paths, and rules that are gone since."""
    with folder() as out:
        recording, summary = bump(out)
        (out / "ram.clp").unlink()
        (out / "bump.yaml").unlink()
        code, said, why = verify(recording, "--json")
        check_equal(code, 0, f"exit code: {why}{said}")
        check_equal(json.loads(said)["hash"], summary["hash"], "hash")


def test_files_with_strange_names():
    """Blanks, quotes, equals signs and dots in names of folders and files."""
    with folder() as out:
        home = out / """it's "day" 1 = v1..2"""
        home.mkdir()
        (home / "ram = 'x' .clp").write_text(RAM)
        (home / 'po"st..clp').write_text(POST)
        (home / "bump = 1.yaml").write_text(
            BUMP.format(world=ROOT / "worlds" / "arena.world")
            .replace("ram.clp", "\"ram = 'x' .clp\"").replace("post.clp", "'po\"st..clp'"))
        done = muster("run", "bump = 1.yaml", "--quiet", "--out", "run", cwd=home)
        check_equal(done.returncode, 0, f"the run: {done.stderr}")
        code, said, why = verify(home / "run" / "run.mcap")
        check_equal(code, 0, f"exit code: {why}{said}")
        check_equal(muster("report", home / "run").returncode, 0, "the report again")


def test_files_that_are_named_by_a_step_up():
    """A world takes in one beside its folder, in two spellings."""
    with folder() as out:
        (out / "mine..too").mkdir()
        include = 'include "../robots.inc"\ninclude "../mine..too/../empty.inc"\n'
        (out / "mine..too" / "t.world").write_text(
            include + 'include "../empty.inc"\nmodel (size [8 8 0.8] boundary 1)\n')
        (out / "robots.inc").write_text(f'include "{ROOT}/worlds/../worlds/pioneer.inc"\n')
        (out / "empty.inc").write_text("")
        (out / "mine..too" / "t.yaml").write_text(
            f"name: up\nworld: t.world\nduration: 3\nrobots:\n  - {{name: red, body: pioneer, "
            f"pose: [0, 0, 0], rules: {ROOT}/rules/patrol.clp}}\n")
        recording, summary = record(out / "run", file=out / "mine..too" / "t.yaml")
        (out / "robots.inc").unlink()
        code, said, why = verify(recording, "--json")
        check_equal(code, 0, f"exit code: {why}{said}")
        check_equal(json.loads(said)["hash"], summary["hash"], "hash")


def test_files_behind_a_link():
    """Of a folder, and of the folder that the run was started in."""
    with folder() as out:
        (out / "home").mkdir()
        (out / "link").symlink_to(out / "home")
        (out / "home" / "worlds").symlink_to(ROOT / "worlds")
        (out / "home" / "t.yaml").write_text("world: worlds/arena.world\nduration: 3\nrobots:\n"
                                             f"  - {{name: red, rules: {ROOT}/rules/patrol.clp}}\n")
        recording, summary = record(out / "run", file=out / "link" / "t.yaml")
        code, said, why = verify(recording, "--json")
        check_equal(code, 0, f"exit code: {why}{said}")
        check_equal(json.loads(said)["hash"], summary["hash"], "hash")


def test_overrides():
    with folder() as out:
        recording, _ = record(out / "run", "--duration", 5, "--set", "robots.red.globals.mate=green")
        check_equal(verify(recording)[0], 0, "exit code")


def test_a_person_in_the_run():
    """Console lines, commands, mail and hands on the world come in again at their steps."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = processes.start(MUSTER, "run", str(ROOT / "experiments" / "follow.yaml"), "--rate", 20,
                              "--duration", 60, "--quiet", "--out", out / "run", "--domain", domain)
        wait_for(lambda: muster("lookup", "red", "--domain", domain).stdout.count("running"), 20,
                 "a robot that runs")
        for words in (("console", "red", "-c", "(stop)"), ("console", "red", "-c", "(wander)"),
                      ("do", "green", "(setSpeed 100 50)"), ("send", "blue", "hello"),
                      ("world", "push", "blue", 40, 0, 0), ("suspend", "yellow"),
                      ("resume", "yellow"), ("world", "place", "green", 1, 1, 90)):
            muster(*words, "--domain", domain)
        # 1: the line is pulled apart, so that what is expected of it may not come true.
        check(run.wait(30) in (0, 1), f"the run: {run.returncode}")
        plain, _ = record(out / "plain", "--duration", 60)
        code, said, why = verify(out / "run" / "run.mcap", "--json")
        check_equal(code, 0, f"exit code: {said}{why}")
        check(json.loads(said)["hash"] != json.loads(verify(plain, "--json")[1])["hash"],
              "nobody had a hand in it")


def chunks(data):
    """Where the chunks' records lie, and their checksums: (at, length, crc_at)."""
    at = 8
    while at + 9 <= len(data):
        op, length = data[at], struct.unpack_from("<Q", data, at + 1)[0]
        if op == CHUNK:
            body = at + 9
            compression = struct.unpack_from("<I", data, body + 28)[0]
            records = body + 32 + compression
            size = struct.unpack_from("<Q", data, records)[0]
            yield records + 8, size, body + 24
        at += 9 + length


def records(data, at, size):
    """The records of a chunk: (kind, at, length)."""
    end = at + size
    while at < end:
        length = struct.unpack_from("<Q", data, at + 1)[0]
        yield data[at], at + 9, length
        at += 9 + length


def frames_of(data, chunks):
    """Where the Frames lie: (at, length, their chunk)."""
    channel = None
    for chunk in chunks:
        for kind, at, length in records(data, *chunk[:2]):
            number = struct.unpack_from("<H", data, at)[0]
            if kind == CHANNEL and b"Frame" in data[at:at + length]:
                channel = number
            elif kind == MESSAGE and number == channel:
                yield at, length, chunk


def test_a_suspended_robot_shows_the_goal_that_it_is_given():
    with folder() as out:
        (out / "ram.clp").write_text(RAM)
        (out / "asleep.yaml").write_text(ASLEEP.format(world=ROOT / "worlds" / "arena.world"))
        recording, _ = record(out / "run", file=out / "asleep.yaml")
        data = recording.read_bytes()
        shows = [b"look around\0" in data[at:at + length]
                 for at, length, _ in frames_of(data, chunks(data))]
        check_equal(shows, [False] * 30 + [True] * 31, "Frames with the goal")


def changed(data, share):
    """One byte of a number of red's changed, in the Frame so far into the run, and the chunk's
    checksum made right again."""
    data = bytearray(data)
    every = list(frames_of(data, chunks(data)))
    at, length, (chunk_at, size, crc_at) = every[int(len(every) * share)]
    # The robots come first: name, state, x, y, heading, forward, turn, command.  A number begins at
    # a multiple of 8 from the body of the message on; 60 bytes further is one whatever the place.
    data[data.index(RED, at, at + length) + 60] ^= 0x10
    struct.pack_into("<I", data, crc_at, zlib.crc32(data[chunk_at:chunk_at + size]))
    return bytes(data)


def test_a_changed_byte_is_found():
    with folder() as out:
        recording, _ = record(out / "run", "--duration", 10)
        (out / "changed.mcap").write_bytes(changed(recording.read_bytes(), 0.5))
        code, said, _ = verify(out / "changed.mcap", "--json")
        check_equal(code, 1, "exit code")
        found = json.loads(said)
        check(not found["equal"] and 10 < found["step"] < 90, f"a step in the middle: {found}")
        check_equal(found["who"], "red", "who")
        check(not found["changed"], "the checksum is right")


def noted(data, key, old, new):
    """A recording with another value of one length behind a key of its notes."""
    def pair(value):
        return b"".join(struct.pack("<I", len(word)) + word for word in (key, value))
    check(len(old) == len(new) and data.count(pair(old)) == 1, f"{key} is noted once")
    at = data.index(pair(old))
    return data[:at] + pair(new) + data[at + len(pair(old)):]


def test_another_version_that_goes_another_way():
    with folder() as out:
        recording, _ = record(out / "run", "--duration", 5)
        data = recording.read_bytes()
        ode = re.search(rb"\x03\0\0\0ode(.)\0\0\0([0-9.]+)", data, re.S)[2]
        other = b"9" + ode[1:]
        (out / "other.mcap").write_bytes(noted(data, b"ode", ode, other))
        check_equal(verify(out / "other.mcap")[0], 0, "another version that goes the same way")
        (out / "other.mcap").write_bytes(noted(changed(data, 0.5), b"ode", ode, other))
        code, said, why = verify(out / "other.mcap")
        check_equal((code, said.startswith("different at step ")), (13, True), said)
        check(f"made with ode {other.decode()}, and this is {ode.decode()}" in why, why)


def test_a_wrong_checksum_is_told():
    with folder() as out:
        recording, _ = record(out / "run", "--duration", 5)
        data = bytearray(recording.read_bytes())
        _, _, crc_at = next(iter(chunks(data)))
        data[crc_at] ^= 1
        (out / "changed.mcap").write_bytes(data)
        code, said, _ = verify(out / "changed.mcap")
        check_equal(code, 1, "exit code")
        check("has been changed" in said, said)


def test_a_cut_recording():
    with folder() as out:
        recording, _ = record(out / "run", "--duration", 60)
        data = recording.read_bytes()
        (out / "cut.mcap").write_bytes(data[:len(data) * 3 // 4])
        code, said, _ = verify(out / "cut.mcap")
        check_equal(code, 0, f"exit code: {said}")
        check(said.startswith("equal  to step ") and "the recording is cut off there" in said, said)


def broken_off(out, name, blow):
    """A run that somebody ends from outside.  @return its recording"""
    domain = new_domain()
    with Processes() as processes:
        run = processes.start(MUSTER, "run", FOLLOW, "--rate", 20, "--duration", 600, "--quiet",
                              "--out", out / name, "--domain", domain)
        path = out / name / "run.mcap"
        wait_for(lambda: path.exists() and path.stat().st_size > 300000, 20, "some steps of it")
        run.send_signal(blow)
        run.wait(20)
    return path


def test_a_run_that_was_stopped_is_equal_as_far_as_it_went():
    with folder() as out:
        for blow in (signal.SIGINT, signal.SIGTERM):
            recording = broken_off(out, blow.name, blow)
            rows = (out / blow.name / "run.csv").read_text().splitlines()
            check_equal(len(rows), len(set(rows)), "each step's tracks stand once")
            code, said, why = verify(recording)
            check_equal(code, 0, f"exit code: {said}{why}")
            check(said.startswith("equal  to step ") and "the run was stopped there" in said, said)
            found = json.loads(verify(recording, "--json")[1])
            check_equal((found["equal"], found["ended"]), (True, "stopped"), "JSON")
            done = muster("report", out / blow.name)
            check_equal(done.returncode, 0, f"no expectation had its time: {done.stdout}")
            check("where it broke off" in done.stdout, done.stdout)


def test_a_run_that_was_killed_is_equal_as_far_as_its_recording_goes():
    with folder() as out:
        code, said, why = verify(broken_off(out, "killed", signal.SIGKILL))
        check_equal(code, 0, f"exit code: {said}{why}")
        check("the recording is cut off there" in said, said)


def unpacked(pid):
    """The folder of a process that verifies: the lock in it is open there."""
    for link in (pathlib.Path("/proc") / str(pid) / "fd").iterdir():
        with contextlib.suppress(OSError):
            target = pathlib.Path(os.readlink(link))
            if target.name == ".owner":
                return target.parent
    return None


def test_a_killed_verify_is_cleared_away_by_the_next():
    with folder() as out, Processes() as processes:
        recording, _ = record(out / "run", "--duration", 60)
        killed = processes.start(MUSTER, "verify", recording)
        left = wait_for(lambda: unpacked(killed.pid), 20, "its folder")
        living = processes.start(MUSTER, "verify", recording)
        kept = wait_for(lambda: unpacked(living.pid), 20, "another one's folder")
        living.send_signal(signal.SIGSTOP)
        killed.kill()
        killed.wait()
        check(left.exists(), "a killed one leaves its folder")
        code, said, why = verify(recording)
        check_equal(code, 0, f"exit code: {said} {why}")
        check(not left.exists(), "the next one clears it")
        check(kept.exists(), "and leaves what somebody has")
        living.send_signal(signal.SIGCONT)
        check_equal(living.wait(60), 0, "who has it goes on")
        check(not kept.exists(), "and clears it itself")


def test_what_cannot_be_verified():
    with folder() as out:
        free, _ = record(out / "free", "--free", "--duration", 1)
        code, _, why = verify(free)
        check_equal(code, 2, "exit code of free running")
        check("--free" in why, why)
        (out / "junk.mcap").write_bytes(b"\x89MCAP0\r\n" + bytes(range(200)))
        for file in (out / "junk.mcap", out / "none.mcap"):
            check_equal(verify(file)[0], 3, f"exit code of {file}")
        check_equal(muster("verify").returncode, 2, "exit code without a file")
        plain, _ = record(out / "plain", "--duration", 1)
        data = plain.read_bytes().replace(b"seed\x01\0\0\x001", b"seed\x01\0\0\x00x")
        (out / "changed.mcap").write_bytes(data)
        code, _, why = verify(out / "changed.mcap")
        check_equal(code, 3, "exit code of a seed that is none")
        check("--seed" in why, why)
        code, _, why = verify(out / "free")
        check_equal(code, 3, "exit code of a folder")
        check("such as run.mcap in the folder of a run" in why, why)


# --- why -----------------------------------------------------------------------------------------


def test_why_down_to_a_person_and_a_mail():
    with folder() as out:
        recording, _ = bump(out)
        ram = [json.loads(line) for line in
               muster("why", recording, "ram", "--json").stdout.splitlines()]
        check(ram and ram[0]["near"] == "post", f"ram runs into post: {ram[:1]}")
        chain = ram[0]["chain"]
        check("rule ram " in chain and "a line: (assert (goal ram))" in chain and "sensed" in chain,
              chain)
        post = muster("why", recording, "post", "15").stdout
        check("a mail of ram" in post and "sent by ram:" in post and "a line:" in post, post)


def test_why_a_fact():
    with folder() as out:
        recording, _ = bump(out)
        first = muster("why", recording, "ram", "5").stdout
        fact = next(word for word in first.split() if word.startswith("f-"))
        told = muster("why", recording, "ram", f"{fact}@5").stdout
        check("a line: (assert (goal ram))" in told or "sensed" in told, told)
        check("had no such fact" in muster("why", recording, "ram", "f-999999@5").stdout, "no fact")


def test_why_of_a_clone():
    """A clone has a mind in the recording, and no body."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = processes.start(MUSTER, "run", ROOT / "experiments" / "travel.yaml", "--rate", 5,
                              "--duration", 20, "--out", out / "o", "--domain", domain, "--quiet")
        path = out / "o" / "run.mcap"
        wait_for(lambda: path.exists() and path.stat().st_size > 200000, 20, "some steps of it")
        wait_for(lambda: muster("clone", "red", "rosa", "south", "--domain",
                                domain).returncode == 0, 20, "the clone")
        check_equal(run.wait(60), 0, "the run")
        told = muster("why", path, "rosa", "19")
        check_equal((told.returncode, told.stderr), (0, ""), "why")
        check(told.stdout.startswith("rosa at 19.0 s\n"), told.stdout)
        never = muster("why", path, "rosa")
        check_equal((never.returncode, never.stdout), (0, "rosa was stalled 0 times\n"), never.stderr)


def test_why_usage():
    with folder() as out:
        recording, _ = record(out / "run", "--duration", 1)
        done = muster("why", recording, "it's \"nobody\"")
        check_equal(done.returncode, 7, "no such robot")
        check("it has red, blue, green, yellow" in done.stderr, done.stderr)
        late = muster("why", recording, "red", "3000")
        check(late.stdout.startswith("red at 1.0 s, where the recording ends\n"), late.stdout)
        for words in ((), ("red", "a@b"), ("red", "stalled@"), ("red", "1", "2"), ("red", "-1"),
                      ("red", "f--3@1"), ("red", "nan")):
            check_equal(muster("why", recording, *words).returncode, 2, f"exit code of {words}")
        check_equal(muster("why", out / "none.mcap", "red").returncode, 3, "no such file")
        check_equal(muster("why", "red", cwd=out).returncode, 3, "no recording here")
        plain, _ = record(out / "plain", "--duration", 1, "--no-diary")
        done = muster("why", plain, "red", "0.5")
        check_equal(done.returncode, 3, "no diary")
        check("no diary" in done.stderr, done.stderr)
