# SPDX-License-Identifier: Apache-2.0
"""Recordings: what `muster record` hears is in the file, and others can read it."""
import json
import os
import pathlib
import re
import resource
import signal
import socket
import subprocess
import time

from support import (FOLLOW, MUSTER, ROOT, Processes, broker_start, check, check_equal,
                     child_of, experiment_run, folder, muster, new_domain, observer_environment,
                     program, tool_python, wait_for)

DECODE = ROOT / "tests/support/system/decode.py"
READERS = ("mcap", "mcap_ros2")


def decode(path, *topics):
    """What the public Python reader makes of a recording."""
    home = tool_python(*READERS)
    done = subprocess.run([home / "bin" / "python", DECODE, path, *topics],
                          capture_output=True, text=True, timeout=120)
    check_equal(done.returncode, 0, f"decode.py {path}: {done.stderr}")
    return json.loads(done.stdout)


def record_start(processes, domain, path, *words):
    p = processes.start(MUSTER, "record", "--domain", domain, "--out", path, *words,
                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for(lambda: path.exists() and path.stat().st_size > 0, 10, "the recording")
    return p


def record_end(p):
    p.send_signal(signal.SIGINT)
    out, errors = p.communicate(timeout=60)
    check_equal((p.returncode, errors), (0, ""), "muster record")
    return out


def test_every_message_of_a_recording_is_decoded():
    tool_python(*READERS)
    domain = new_domain()
    with folder() as out, Processes() as processes:
        path = out / "a.mcap"
        record = record_start(processes, domain, path)
        broker_start(processes, domain)
        processes.start(program("pages_agent"), domain, "seeker", out / "seeker")

        def tell(word):
            return muster("send", "seeker", word, "--domain", domain).returncode == 0

        def recorded(word):
            return re.search(b"group:scouts.{1,120}" + word, path.read_bytes(), re.DOTALL)

        # It tells its group what it is told; from the first that was heard on, all are.
        wait_for(lambda: tell("early") and recorded(b"early"), 20, "the recorder to hear the seeker")
        for i in range(5):
            check(tell(f"gold{i}"), "the seeker is told")
        wait_for(lambda: recorded(b"gold4"), 10, "the recorder to hear the last of it")
        record.send_signal(signal.SIGINT)
        said, _ = record.communicate(timeout=60)
        check_equal(record.returncode, 0, "muster record")
        got = decode(path, "Up", "Pages")
        check(f"{got['count']} messages" in said, f"{said}: {got['count']}")
        check_equal(got["topics"], got["raw"], "messages that were decoded")
        for topic in ("Pages", "BrokerStatus", "PartStatus", "Beacon", "Registration", "Up",
                      "Delivery"):
            check(got["topics"].get(topic, 0) > 0, f"{topic} in {got['topics']}")
        mails = [mail["content"] for topic, _, _, up in got["messages"] if topic == "Up"
                 for act in up["acts"] for mail in act["mails"]]
        for i in range(5):
            check(any(f"gold{i}" in mail for mail in mails), f"gold{i} in {mails}")
        times = [at for _, at, _, _ in got["messages"]]
        check_equal(times, sorted(times), "the order of time")
        check_equal(got["tables"]["recording"]["domain"], str(domain), "the domain")


def test_topics_that_are_named_are_recorded_alone():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        path = out / "a.mcap"
        done = muster("record", "Pages", "--domain", domain, "--out", path, "--duration", 1)
        check_equal(done.returncode, 0, done.stderr)
        check("messages of 1 topics" in done.stdout, done.stdout)
        got = decode(path)
        check_equal(list(got["topics"]), ["Pages"], "topics")
        done = muster("record", "Pagse", "--domain", domain, "--out", path, "--duration", 1)
        check("nothing of the topic Pagse" in done.stderr, done.stderr)


def stranger_record(out, count):
    """Records what a program with types of its own writes."""
    domain = new_domain()
    path = out / "stranger.mcap"
    with Processes() as processes:
        record = record_start(processes, domain, path, "--all")
        done = subprocess.run([program("stranger"), str(domain), str(count)], capture_output=True,
                              text=True, timeout=60, env=observer_environment())
        check_equal((done.returncode, done.stdout), (0, "done\n"), done.stderr)
        wait_for(lambda: rests(path), 20, "a recorder that has heard that the writers left")
        record_end(record)
    return path


def rests(path):
    """Whether a recording, which is written each second, does not grow."""
    before = path.stat().st_size
    time.sleep(1.5)
    return path.stat().st_size == before


def samples_of(counts):
    """Those of the topics themselves, not of what has gone."""
    return {topic: count for topic, count in counts.items() if not topic.endswith("/gone")}


def test_a_stranger_is_recorded():
    """Types that we were not compiled with are found out, and every sample is there, in order."""
    tool_python(*READERS)
    count = 3000
    with folder() as out:
        got = decode(stranger_record(out, count), "Animals", "Animals/gone")
        check_equal(samples_of(got["raw"]), {"Animals": count + 1, "Feedings": count}, "samples")
        check_equal(samples_of(got["topics"]), {"Animals": count + 1},
                    "samples whose type can be said")
        animals = [animal for topic, _, _, animal in got["messages"] if topic == "Animals"]
        for n, animal in enumerate(animals):
            i = n if n < count else 3 * count
            legs = [["left", 0.5], ["right", 0.25], ["tail", 1.5], ["nose", 0.125]][:i % 5]
            want = {"cage": i % 3, "number": 10**12 + i, "name": "lion", "tag": "zoo",
                    "mood": i % 3, "awake": i % 2 == 1, "color": [1, 2, i % 256],
                    "legs": [{"name": n, "length_m": l} for n, l in legs],
                    "weights_kg": [i * 0.5, i + 0.25][:i % 3]}
            got_one = {name: value for name, value in animal.items() if not name.isupper()}
            check_equal(got_one, want, f"animal {i}")
        # The first cage was disposed twice, the second one let go of; the writer left the third.
        check_equal(gone_of(got), {0: [1, 1], 1: [2], 2: [2]}, "cages that have gone")


def gone_of(got):
    """What became of each cage, in order: 1 disposed, 2 no writer has it."""
    cages = {}
    for topic, _, _, gone in got["messages"]:
        if topic == "Animals/gone":
            cages.setdefault(gone["key"][4], []).append(gone["what"])
    return cages


def test_a_stranger_is_replayed():
    """Its own readers get what they would have got from it: the same bytes, offered the same."""
    tool_python(*READERS)
    count = 1000
    with folder() as out, Processes() as processes:
        path = stranger_record(out, count)
        domain = new_domain()
        again = out / "again.mcap"
        reader = processes.start(program("stranger"), domain, count, "read",
                                 stdout=subprocess.PIPE, text=True, env=observer_environment())
        check_equal(reader.stdout.readline(), "ready\n", "the stranger's reader")
        record = record_start(processes, domain, again, "--all")
        done = muster("replay", path, "--domain", domain, "--rate", 0, "--wait", 20)
        check_equal((done.returncode, done.stderr), (0, ""), done.stdout)
        said, _ = reader.communicate(timeout=60)
        record_end(record)
        check_equal(said, f"{count + 1} animals, {count} feedings, disposed: yes, let go of: yes\n",
                    "what the stranger has read")
        first, second = decode(path, "Animals/gone"), decode(again, "Animals/gone")
        data = [sums(p) for p in (path, again)]
        for topic in ("Animals", "Feedings"):
            one, other = ([s for t, s in d if t == topic] for d in data)
            check(one == other and len(one) >= count, f"{topic}: the bytes of every sample")
        check_equal(gone_of(first), gone_of(second), "cages that have gone")
        check_equal(first["pairs"], second["pairs"], "what is said of each channel")
        check_equal(first["files"], second["files"], "the types")


def test_a_type_that_is_damaged_is_not_replayed():
    home = tool_python(*READERS)
    script = ("import sys; from mcap.reader import make_reader; from mcap.writer import "
              "CompressionType, Writer\n"
              "r = make_reader(open(sys.argv[1], 'rb')); w = Writer(sys.argv[2], "
              "compression=CompressionType.NONE); w.start(); ids = {}\n"
              "for a in r.iter_attachments():\n"
              "  data = bytearray(a.data); data[len(data) * 2 // 3] ^= 1\n"
              "  w.add_attachment(0, 0, a.name, a.media_type, bytes(data))\n"
              "for s, c, m in r.iter_messages():\n"
              "  ids[c.id] = ids.get(c.id) or w.register_channel(c.topic, 'cdr', 0, c.metadata)\n"
              "  w.add_message(ids[c.id], m.log_time, m.data, m.publish_time)\n"
              "w.finish()")
    with folder() as out:
        path = stranger_record(out, 10)
        subprocess.run([home / "bin" / "python", "-c", script, path, out / "b.mcap"], check=True,
                       timeout=60)
        done = muster("replay", out / "b.mcap", "--domain", new_domain(), "--rate", 0, "--wait", 0)
        check_equal(done.returncode, 3, done.stderr)
        for topic in ("Animals", "Feedings"):
            check(f"{topic} is left out: what the recording says of its type is damaged" in
                  done.stderr, done.stderr)


def test_what_has_gone_is_recorded_and_replayed():
    """Our own topics, too: a program that leaves is seen to leave in a replay."""
    tool_python(*READERS)
    domain = new_domain()
    with folder() as out, Processes() as processes:
        record = record_start(processes, domain, out / "a.mcap")
        broker = broker_start(processes, domain)
        seeker = processes.start(program("pages_agent"), domain, "seeker", out / "seeker")
        wait_for(lambda: muster("lookup", "seeker", "--domain", domain).returncode == 0, 20,
                 "the seeker in the white pages")
        # The operator comes, and goes; the recorder finds the seeker, which tells its group the word.
        wait_for(lambda: muster("send", "seeker", "word", "--domain", domain).returncode == 0 and
                 b"group:scouts" in (out / "a.mcap").read_bytes(), 20, "the recorder to hear the seeker")
        seeker.kill()
        wait_for(lambda: "absent" in muster("lookup", "seeker", "--domain", domain).stdout, 20,
                 "the seeker to be missed")
        broker.terminate()
        broker.wait(30)
        wait_for(lambda: b"BrokerStatus/gone" in (out / "a.mcap").read_bytes(), 20, "the broker to be missed")
        time.sleep(0.5)  # the seeker was missed before, most likely
        record_end(record)
        got = decode(out / "a.mcap", "Registration/gone", "BrokerStatus/gone")
        check_equal(got["topics"], got["raw"], "messages that were decoded")
        what = {(topic, gone["what"]) for topic, _, _, gone in got["messages"]}
        check_equal(what, {("Registration/gone", 1), ("Registration/gone", 2),
                           ("BrokerStatus/gone", 2)}, "who took leave, and who did not")
        second = new_domain()
        record = record_start(processes, second, out / "b.mcap")
        done = muster("replay", out / "a.mcap", "--domain", second, "--rate", 0, "--wait", 20,
                      "--topics", "all")
        check_equal((done.returncode, done.stderr), (0, ""), done.stdout)
        record_end(record)
        again = decode(out / "b.mcap")
        for topic in got["raw"]:
            check(again["raw"].get(topic, 0) >= 1, f"{topic} in the replay: {again['raw']}")


PYTHON_WRITER = """
import sys, time
from dataclasses import dataclass
from cyclonedds.domain import DomainParticipant
from cyclonedds.idl import IdlStruct
from cyclonedds.idl.annotations import final, key
from cyclonedds.idl.types import sequence, int32, float64
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from cyclonedds.core import Qos, Policy

@dataclass
@final
class Reading(IdlStruct, typename="lab.Reading"):
    sensor: str
    key("sensor")
    number: int32
    values: sequence[float64]

participant = DomainParticipant(int(sys.argv[1]))
qos = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepAll,
          Policy.DataRepresentation(use_cdrv0_representation=True))
other = Qos(Policy.Reliability.Reliable(10**9), Policy.History.KeepAll,
            Policy.DataRepresentation(use_xcdrv2_representation=True))
writer = DataWriter(participant, Topic(participant, "Readings", Reading), qos=qos)
newer = DataWriter(participant, Topic(participant, "Newer", Reading), qos=other)
while not writer.get_matched_subscriptions() or not newer.get_matched_subscriptions():
    time.sleep(0.01)
for i in range(200):
    reading = Reading(sensor="s%d" % (i % 2), number=i, values=[i / 2] * (i % 4))
    writer.write(reading)
    newer.write(reading)
time.sleep(0.5)
"""


def test_a_python_program_is_recorded():
    home = tool_python(*READERS, "cyclonedds")
    domain = new_domain()
    with folder() as out, Processes() as processes:
        path = out / "a.mcap"
        record = record_start(processes, domain, path, "--all")
        done = subprocess.run([home / "bin" / "python", "-c", PYTHON_WRITER, str(domain)],
                              capture_output=True, text=True, timeout=60,
                              env=observer_environment())
        check_equal(done.returncode, 0, done.stderr)
        record_end(record)
        got = decode(path, "Readings")
        check_equal(samples_of(got["raw"]), {"Readings": 200, "Newer": 200}, "samples")
        check_equal(samples_of(got["topics"]), {"Readings": 200},
                    "samples that definitions are right for")
        first, again = replay_compare(path, out, "--rate", 0, record=("--all",))
        for topic in ("Readings", "Newer"):
            one, other = ([s for t, s in which if t == topic] for which in (first, again))
            check(one == other and len(one) == 200, f"{topic} in a replay")
        said = [(m["sensor"], m["number"], m["values"]) for _, _, _, m in got["messages"]]
        check_equal(said, [(f"s{i % 2}", i, [i / 2] * (i % 4)) for i in range(200)], "readings")


def test_a_full_disk_is_told():
    domain = new_domain()
    with Processes() as processes:
        broker_start(processes, domain)
        done = muster("record", "--domain", domain, "--out", "/dev/full", timeout=30)
        check_equal(done.returncode, 9, done.stderr)
        check("cannot write /dev/full: No space left on device" in done.stderr, done.stderr)


def test_a_recorder_that_is_killed_leaves_what_it_heard():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        path = out / "a.mcap"
        broker_start(processes, domain)
        record = record_start(processes, domain, path)
        wait_for(lambda: path.stat().st_size > 4000, 20, "a chunk of it")
        record.kill()
        record.wait()
        home = tool_python(*READERS)
        script = ("import sys; from mcap.stream_reader import StreamReader\n"
                  "from mcap.exceptions import EndOfFile\n"
                  "n = 0\n"
                  "try:\n"
                  "  for r in StreamReader(open(sys.argv[1], 'rb'), validate_crcs=True).records:\n"
                  "    n += type(r).__name__ == 'Message'\n"
                  "except EndOfFile: pass\n"
                  "print(n)")
        done = subprocess.run([home / "bin" / "python", "-c", script, path], capture_output=True,
                              text=True, timeout=60)
        check(int(done.stdout or 0) > 10, f"messages: {done.stdout} {done.stderr}")


# --- run.mcap -------------------------------------------------------------------------------------

def test_a_run_leaves_its_recording():
    tool_python(*READERS)
    with folder() as out:
        done, summary = experiment_run(out / "o", "--duration", 10, "--set",
                                       "robots.red.rules=../rules/follower.clp")
        check_equal(done.returncode, 0, done.stderr)
        got = decode(out / "o" / "run.mcap", "Frame", "Scene", "RunStatus")
        check_equal(got["topics"], {"Scene": 1, "Frame": 101, "RunStatus": 1}, "messages")
        check_equal(got["topics"], got["raw"], "messages that were decoded")
        run, end = got["tables"]["run"], got["tables"]["end"]
        check_equal((end["hash"], end["steps"], end["state"]), (summary["hash"], "100", "done"),
                    "the end")
        check_equal((run["seed"], run["set.1"]),
                    ("1", "robots.red.rules=../rules/follower.clp"), "how it was started")
        for key in ("muster", "clips", "cyclonedds", "ode", "command", "began_wall_ns"):
            check(run[key], f"{key} in {run}")
        frames = [(at, frame) for topic, at, _, frame in got["messages"] if topic == "Frame"]
        check_equal([(at, f["step"], f["time_ns"]) for at, f in frames],
                    [(10**8 * i, i, 10**8 * i) for i in range(101)], "times of the frames")
        final = {r["name"]: r["final"] for r in summary["robots"]}
        for robot in frames[-1][1]["robots"]:
            at = final[robot["name"]]
            check(abs(robot["x_m"] - at["x_m"]) < 1e-5 and abs(robot["y_m"] - at["y_m"]) < 1e-5,
                  f"where {robot['name']} is at the end: {robot} {at}")
        check(all(len(f["percepts"]) == 4 for _, f in frames), "percepts of four robots")
        status = [m for topic, _, _, m in got["messages"] if topic == "RunStatus"][0]
        check_equal(status["hash"], summary["hash"], "the hash in the last message")


def test_a_recording_has_what_the_run_was_made_of():
    tool_python(*READERS)
    with folder() as out:
        (out / "mine.clp").write_text('(extends "base.clp")\n(defrule a => (wander))\n')
        (out / "base.clp").write_text("(defrule b => (now))\n")
        experiment_run(out / "o", "--duration", 1, "--set", f"robots.red.rules={out}/mine.clp")
        files = decode(out / "o" / "run.mcap")["files"]
        for name, path in (("experiment/experiments/follow.yaml", FOLLOW),
                           ("world/worlds/arena.world", ROOT / "worlds/arena.world"),
                           ("world/worlds/pioneer.inc", ROOT / "worlds/pioneer.inc"),
                           ("library/muster.clp", ROOT / "rules/muster.clp"),
                           (f"rules/_{out}/mine.clp", out / "mine.clp"),
                           (f"rules/_{out}/base.clp", out / "base.clp")):
            check_equal(files.get(name), pathlib.Path(path).read_text(), f"{name} of {list(files)}")


def test_the_example_in_python():
    home = tool_python(*READERS, "pandas")
    with folder() as out:
        experiment_run(out / "o", "--duration", 5)
        done = subprocess.run([home / "bin" / "python", ROOT / "examples" / "recording.py",
                               out / "o" / "run.mcap"], capture_output=True, text=True, timeout=120)
        check_equal(done.returncode, 0, done.stderr)
        for name in ("red", "blue", "green", "yellow"):
            check(f"\n{name} " in done.stdout and " 51.0 " in done.stdout, done.stdout)


def test_what_is_recorded_changes_nothing():
    sizes = {}
    hashes = set()
    with folder() as out:
        for level in ("none", "run", "full"):
            _, summary = experiment_run(out / level, "--duration", 20, "--record", level)
            hashes.add(summary["hash"])
            path = out / level / "run.mcap"
            sizes[level] = path.stat().st_size if path.exists() else 0
        check_equal(len(hashes), 1, "hashes")
        check_equal(sizes["none"], 0, "nothing")
        check(0 < sizes["run"] < sizes["full"], f"percepts take room: {sizes}")
        done = muster("run", FOLLOW, "--record", "some", "--out", out / "some")
        check_equal(done.returncode, 2, done.stderr)


def test_ten_minutes_of_four_robots_are_not_large():
    with folder() as out:
        experiment_run(out / "o", "--duration", 600)
        size = (out / "o" / "run.mcap").stat().st_size
        check(10**6 < size < 60 * 10**6, f"{size} bytes")


def test_a_full_disk_ends_the_recording_and_not_the_run():
    def limit():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))

    with folder() as out:
        whole, summary = experiment_run(out / "whole")
        check_equal(whole.returncode, 0, whole.stderr)
        done = subprocess.run([MUSTER, "run", FOLLOW, "--out", out / "o"], capture_output=True,
                              text=True, timeout=120, stdin=subprocess.DEVNULL, preexec_fn=limit)
        check_equal(done.returncode, 9, done.stderr)
        check("run.mcap: File too large" in done.stderr, done.stderr)
        cut = json.loads((out / "o" / "summary.json").read_text())
        check_equal((cut["hash"], cut["sim_time_s"]), (summary["hash"], 120.0), "the run")
        check((out / "o" / "run.mcap").stat().st_size <= 1 << 20, "the limit")


# --- replay ---------------------------------------------------------------------------------------

def sums(path):
    """Topic and sum of the bytes of each sample, in order; what has gone is left out."""
    script = ("import json, sys, hashlib; from mcap.reader import make_reader\n"
              "print(json.dumps([[c.topic, hashlib.sha256(m.data).hexdigest()] for _, c, m in "
              "make_reader(open(sys.argv[1], 'rb')).iter_messages() "
              "if not c.topic.endswith('/gone')]))")
    home = tool_python(*READERS)
    return json.loads(subprocess.run([home / "bin" / "python", "-c", script, path],
                                     capture_output=True, text=True, timeout=60).stdout)


def test_a_recorder_hears_what_the_run_records():
    tool_python(*READERS)
    domain = new_domain()
    with folder() as out, Processes() as processes:
        record = record_start(processes, domain, out / "heard.mcap", "Frame")
        _, summary = experiment_run(out / "o", "--duration", 20, "--rate", 10, "--domain", domain)
        record_end(record)
        _, alone = experiment_run(out / "alone", "--duration", 20, "--record", "none")
        check_equal(summary["hash"], alone["hash"], "the hash")
        frames = iter(s for s in sums(out / "o" / "run.mcap") if s[0] == "Frame")
        heard = sums(out / "heard.mcap")
        check(len(heard) > 100, f"frames that were heard: {len(heard)} of 201")
        check(all(one in frames for one in heard), "each is in the run's recording, in this order")


def replay_compare(path, out, *words, record=()):
    """Records the replay of a recording; gives what is in the one and in the other."""
    domain = new_domain()
    again = out / "again.mcap"
    with Processes() as processes:
        recorder = record_start(processes, domain, again, *record)
        done = muster("replay", path, "--domain", domain, "--topics", "all", "--wait", 20, *words)
        check_equal(done.returncode, 0, done.stderr)
        record_end(recorder)
    return sums(path), sums(again)


def test_a_replay_is_the_recording():
    tool_python(*READERS)
    with folder() as out:
        experiment_run(out / "o", "--duration", 120)
        first, again = replay_compare(out / "o" / "run.mcap", out, "--rate", 0)
        check_equal((len(first), len(again)), (1203, 1203), "messages")
        check(again == first, "every message, in order")


def test_a_replay_in_real_time_is_the_recording():
    tool_python(*READERS)
    with folder() as out:
        experiment_run(out / "o", "--duration", 2)
        began = time.monotonic()
        first, again = replay_compare(out / "o" / "run.mcap", out, "--rate", 1)
        check(time.monotonic() - began >= 2.0, "it takes as long as it took")
        check_equal((len(first), len(again)), (23, 23), "messages")
        check(again == first, "every message, in order")


def test_who_watches_frames_sees_a_replay():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        experiment_run(out / "o", "--duration", 5)
        watchers = [processes.start(program("frame_watcher"), domain, which,
                                    stdout=subprocess.PIPE, text=True)
                    for which in ("every", "latest")]
        done = muster("replay", out / "o" / "run.mcap", "--domain", domain, "--rate", 10,
                      "--topics", "Scene", "--topics", "Frame", "--topics", "RunStatus",
                      "--wait", 20)
        check_equal((done.returncode, done.stdout), (0, "53 messages of 3 topics\n"), done.stderr)
        for watcher in watchers:
            said, _ = watcher.communicate(timeout=60)
            lines = said.splitlines()
            check_equal(lines[0].split()[:2], ["scene", "arena.world"], "the world")
            steps = [int(l.split()[1]) for l in lines if l.startswith("frame ")]
            check_equal(steps, list(range(51)), "steps")
            check_equal(lines[-1].split()[:1], ["end"], "the end")


def simulator_place_taken(domain):
    """Whether somebody has the port of the participant index that a simulator has."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(("127.0.0.1", 7400 + 250 * domain + 10 + 2 * 1))
        except OSError:
            return True
    return False


def test_times_that_a_recording_does_not_have():
    with folder() as out:
        experiment_run(out / "o", "--duration", 1)
        for words, wanted in ((("--from", 3), "run.mcap has 1.0 s"),
                              (("--from", 1, "--to", 0.5), "expected more than --from, 1")):
            done = muster("replay", out / "o" / "run.mcap", "--domain", new_domain(), *words)
            check_equal(done.returncode, 2, done.stderr)
            check(wanted in done.stderr, done.stderr)


def test_a_replay_is_refused_beside_a_simulator():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        experiment_run(out / "o", "--duration", 1)
        broker_start(processes, domain)
        processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--domain", domain, "--wait")
        wait_for(lambda: simulator_place_taken(domain), 20, "the simulator")
        done = muster("replay", out / "o" / "run.mcap", "--domain", domain, "--wait", 0)
        check_equal(done.returncode, 4, done.stderr)
        check(f"a simulator or another replay is in domain {domain}" in done.stderr, done.stderr)


def test_a_damaged_recording_is_replayed_as_far_as_it_goes():
    domain = new_domain()
    with folder() as out:
        experiment_run(out / "o", "--duration", 60)
        whole = (out / "o" / "run.mcap").read_bytes()
        (out / "cut.mcap").write_bytes(whole[:len(whole) * 2 // 3])
        (out / "no.mcap").write_text("time_s,robot\n")
        done = muster("replay", out / "cut.mcap", "--domain", domain, "--rate", 0, "--wait", 0)
        check_equal(done.returncode, 0, done.stderr)
        check("has no end" in done.stderr, done.stderr)
        count = int(done.stdout.split()[0])
        check(200 < count < 600, f"messages: {done.stdout}")
        done = muster("replay", out / "no.mcap", "--domain", domain)
        check_equal(done.returncode, 3, done.stderr)
        check("expected an MCAP file" in done.stderr, done.stderr)


def test_a_replay_goes_round():
    domain = new_domain()
    with folder() as out, Processes() as processes:
        experiment_run(out / "o", "--duration", 1)
        p = processes.start(MUSTER, "replay", out / "o" / "run.mcap", "--domain", domain, "--rate",
                            20, "--wait", 20, "--loop", stdout=subprocess.PIPE, text=True)
        watch = processes.start(program("frame_watcher"), domain, "every", stdout=subprocess.PIPE,
                                text=True)
        watch.communicate(timeout=60)  # it ends with the first round
        again = processes.start(program("frame_watcher"), domain, "every", stdout=subprocess.PIPE,
                                text=True)
        said, _ = again.communicate(timeout=60)
        check("\nframe 10 " in said, f"the end of a later round: {said[-500:]}")
        p.send_signal(signal.SIGINT)
        said, _ = p.communicate(timeout=60)
        check_equal(p.returncode, 130, "interrupted")
        check(int(said.split()[0]) > 26, f"two rounds and more: {said}")


def test_a_run_that_breaks_leaves_its_recording():
    """Whoever dies: what was recorded until then can be read, and looked at again."""
    for who in ("muster-robot red", "muster-sim"):
        domain = new_domain()
        with folder() as out, Processes() as processes:
            run = processes.start(MUSTER, "run", FOLLOW, "--rate", 20, "--out", out / "o",
                                  "--domain", domain)
            path = out / "o" / "run.mcap"
            wait_for(lambda: path.exists() and path.stat().st_size > 200000, 20, "a part of it")
            os.kill(child_of(run, *who.split()), signal.SIGKILL)
            run.wait(60)
            check_equal(run.returncode, 5, who)
            done = muster("replay", path, "--domain", domain, "--rate", 0, "--wait", 0)
            check_equal(done.returncode, 0, f"{who}: {done.stderr}")
            check_equal("has no end" in done.stderr, who == "muster-sim", f"{who}: its end")
            check(int(done.stdout.split()[0]) > 20, f"{who}: {done.stdout}")


PYTHON_RECORDER = """
import sys
from mcap.writer import CompressionType, Writer
for name, words in (("plain", {"compression": CompressionType.NONE}),
                    ("zstd", {"compression": CompressionType.ZSTD}),
                    ("flat", {"compression": CompressionType.NONE, "use_chunking": False})):
    w = Writer(sys.argv[1] + "/" + name + ".mcap", **words)
    w.start()
    schema = w.register_schema("lab/msg/Reading", "ros2msg", b"string a")
    channel = w.register_channel("Readings", "cdr", schema)
    for i in range(100):
        w.add_message(channel, i, b"abc", i, i)
    w.finish()
"""


def test_recordings_of_others_are_read_or_refused():
    home = tool_python(*READERS)
    with folder() as out:
        subprocess.run([home / "bin" / "python", "-c", PYTHON_RECORDER, out], check=True,
                       timeout=60)
        for name, why in (("plain", "Readings is left out: the recording does not say what its "
                           "type is on DDS"),
                          ("zstd", "its chunks are compressed"),
                          ("flat", "its messages are in no chunks")):
            done = muster("replay", out / f"{name}.mcap", "--domain", new_domain())
            check_equal(done.returncode, 3, f"{name}: {done.stderr}")
            check(why in done.stderr, f"{name}: {done.stderr}")
