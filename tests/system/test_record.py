# SPDX-License-Identifier: Apache-2.0
"""Recordings: what `muster record` hears is in the file, and others can read it."""
import json
import os
import pathlib
import subprocess

from support import (MUSTER, Processes, broker_start, check, check_equal, folder, muster, new_domain,
                     observer_environment, program, tool_python, wait_for)

HERE = pathlib.Path(__file__).resolve().parent
READERS = ("mcap", "mcap-ros2-support=mcap_ros2")


def decode(path, *topics):
    """What the public Python reader makes of a recording."""
    home = tool_python(*READERS)
    done = subprocess.run([home / "bin" / "python", HERE / "decode.py", path, *topics],
                          capture_output=True, text=True, timeout=120)
    check_equal(done.returncode, 0, f"decode.py {path}: {done.stderr}")
    return json.loads(done.stdout)


def record_start(processes, domain, path, *words):
    p = processes.start(MUSTER, "record", "--domain", domain, "--out", path, *words,
                        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    wait_for(lambda: path.exists() and path.stat().st_size > 0, 10, "the recording")
    return p


def record_end(p):
    p.send_signal(2)
    out, errors = p.communicate(timeout=20)
    check_equal((p.returncode, errors), (0, ""), "muster record")
    return out


def test_every_message_of_a_recording_is_decoded():
    tool_python(*READERS)
    domain = new_domain()
    with folder() as out, Processes() as processes, open(out / "log", "w+") as log:
        path = out / "a.mcap"
        record = processes.start(MUSTER, "record", "--domain", domain, "--out", path, "-v",
                                 stdout=subprocess.PIPE, stderr=log, text=True)
        broker_start(processes, domain)
        processes.start(program("pages_agent"), domain, "seeker", out / "seeker")

        def tell(word):
            return muster("send", "seeker", word, "--domain", domain).returncode == 0

        # It tells its group what it is told; from the first that was heard on, all are.
        wait_for(lambda: tell("early") and "topic=Up" in (out / "log").read_text(), 20,
                 "the recorder to hear of the seeker")
        for i in range(5):
            check(tell(f"gold{i}"), "the seeker is told")
        heard = lambda: "gold4" in (out / "seeker").read_text()
        wait_for(heard, 10, "the seeker to hear it")
        record.send_signal(2)
        said, _ = record.communicate(timeout=20)
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
        times = [time for _, time, _, _ in got["messages"]]
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


def test_a_stranger_is_recorded():
    """Types that we were not compiled with are found out, and every sample is there, in order."""
    tool_python(*READERS)
    domain = new_domain()
    count = 3000
    with folder() as out, Processes() as processes:
        path = out / "a.mcap"
        record = record_start(processes, domain, path, "--all")
        done = subprocess.run([program("stranger"), str(domain), str(count)], capture_output=True,
                              text=True, timeout=60, env=observer_environment())
        check_equal((done.returncode, done.stdout), (0, "done\n"), done.stderr)
        record_end(record)
        got = decode(path, "Animals")
        check_equal(got["raw"], {"Animals": count, "Feedings": count}, "samples")
        check_equal(got["topics"], {"Animals": count}, "samples whose type can be said")
        for i, (_, _, _, animal) in enumerate(got["messages"]):
            legs = [["left", 0.5], ["right", 0.25], ["tail", 1.5], ["nose", 0.125]][:i % 5]
            want = {"cage": i % 3, "number": 10**12 + i, "name": "lion", "tag": "zoo",
                    "mood": i % 3, "awake": i % 2 == 1, "color": [1, 2, i % 256],
                    "legs": [{"name": n, "length_m": l} for n, l in legs],
                    "weights_kg": [i * 0.5, i + 0.25][:i % 3]}
            got_one = {name: value for name, value in animal.items() if not name.isupper()}
            check_equal(got_one, want, f"animal {i}")


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
writer = DataWriter(participant, Topic(participant, "Readings", Reading), qos=qos)
while not writer.get_matched_subscriptions():
    time.sleep(0.01)
for i in range(200):
    writer.write(Reading(sensor="s%d" % (i % 2), number=i, values=[i / 2] * (i % 4)))
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
        check_equal(got["raw"], {"Readings": 200}, "samples")
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
