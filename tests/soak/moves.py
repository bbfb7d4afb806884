#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Robots that move, and agents that are cloned, a hundred times each way.

lockstep: the follow experiment with one move at a random moment, and the same with none: the robots are
asked for their facts and agendas at the end, and their answers are in the hash, which is the same.
clones: agents that are cloned, launched, move and are disposed of at random moments of a run in lock step,
often several in one step and of one name: the same run twice, the second time paced, has one hash.
free: a robot that drives in a circle in real time and moves; how long its motors are off, from the record
of the run: with the usual steps of 100 ms, and with such of 20 ms, for a closer look.
kills: kill -9 of source, target or both at random instants of a move, with mail on the way all the
time; whoever was killed comes back with --restore.  One agent lives, and no mail is lost or twice.  A
platform that dies when the move is over, or was refused, comes back with what it wrote last: that is not counted.

`make soak-moves`, or tests/soak/moves.py [PART...] [--count N] [--seed N]; about twelve minutes.
"""
import argparse
import collections
import csv
import pathlib
import random
import statistics
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "support" / "system"))
from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, experiment_run,  # noqa: E402
                     folder, members, muster, new_domain, wait_for)
from support import COUNTS, SENDS  # noqa: E402

STEP_S, END_S = 0.1, 119.8
SPEED_M_S = 0.3
MOVE_S = 0.01  # as long as a move takes in free running, or a little longer


# --- in lock step ------------------------------------------------------------------------------


def experiment(out, name, moves):
    """follow.yaml with two hosts, red on one of them, a question at the end, and moves."""
    text = (ROOT / "experiments/follow.yaml").read_text().replace("../", f"{ROOT}/")
    text = text.replace("name: follow", f"name: {name}\nhosts: [north, south]", 1)
    text = text.replace("{name: red, ", "{name: red, host: north, ", 1)
    asked = "".join(f"  - {{at: {END_S}, do: robots, line: \"({what})\"}}\n" for what in ("facts", "agenda"))
    text = text.replace("\nexpect:", f"{asked}{''.join(moves)}\nexpect:", 1)
    path = out / f"{name}.yaml"
    path.write_text(text)
    return path


def run_hash(out, file):
    done, summary = experiment_run(out / file.stem, "--domain", new_domain(), file=file)
    check_equal(done.returncode, 0, f"{file.stem}: {done.stderr}")
    check_equal("could not" in done.stderr, False, f"{file.stem}: {done.stderr}")
    mail = summary["mail"]
    check_equal((mail["lost"], mail["duplicated"]), (0, 0), "mail lost, and twice")
    return summary["hash"]


def lockstep(count, dice):
    with folder() as out:
        still = run_hash(out, experiment(out, "still", []))
        equal = 0
        for i in range(count):
            robot = dice.choice(("red", "red", "blue", "green", "yellow"))
            at = dice.randrange(1, int(END_S / STEP_S)) * STEP_S
            host = "south" if robot == "red" else dice.choice(("north", "south"))
            move = f"  - {{at: {at:.1f}, do: {robot}, move: {host}}}\n"
            value = run_hash(out, experiment(out, f"move{i}", [move]))
            equal += value == still
            if value != still:
                print(f"another hash: {robot} to {host} at {at:.1f} s: {value}")
        print(f"lock step: {count} moves, {equal} with the hash of the run without one, {still}")
        return equal == count


# --- new agents in lock step -------------------------------------------------------------------

# Each hears of each, and says so; clones end when they are told that their turn has come.
BREED = """
(deffunction is-clone () (str-index "c_" (my-name)))
(defrule beat (position ?t $?) (test (= (mod (integer (+ 0.5 (* 10 ?t))) 7) 0)) => (broadcast beat ?t))
(defrule heard ?m <- (message beat ?t) (test (is-clone)) => (retract ?m) (broadcast heard ?t))
(defrule ended (message end ?name) (test (eq ?name (my-name))) => (dispose))
(defrule refused (event refused $?what) => (broadcast refused ?what))
"""
NAMES = ("c_1", "c_2", "c_3", "c_4")
HOSTS = ("north", "south")


def deed(dice):
    robot, name, host = dice.choice(("red", "blue", "green")), dice.choice(NAMES), dice.choice(HOSTS)
    return dice.choice((f'do: {robot}, line: "(clone {name} {host})"', f'do: {robot}, line: "(clone {name} {host})"',
                        f'do: {host}, launch: {name}, rules: breed.clp', f'do: {robot}, move: {host}',
                        f'do: {robot}, line: "(broadcast end {name})"'))


def clones(count, dice):
    with folder() as out:
        (out / "breed.clp").write_text(BREED)
        equal = 0
        for i in range(count):
            moments = [f"{dice.randrange(1, 40) * STEP_S:.1f}" for _ in range(8)]
            deeds = "".join(f"  - {{at: {dice.choice(moments)}, {deed(dice)}}}\n" for _ in range(16))
            file = out / f"clones{i}.yaml"
            file.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 5\nhosts: [north, south]\nrobots:\n"
                            "  - {name: red, host: north, rules: breed.clp}\n"
                            "  - {name: blue, rules: breed.clp}\n  - {name: green, rules: breed.clp}\n"
                            f"observer:\n{deeds}")
            hashes = []
            for name, words in (("fast", ()), ("paced", ("--rate", dice.choice(("10", "20", "50"))))):
                done, summary = experiment_run(out / f"{name}{i}", "--domain", new_domain(), *words, file=file)
                # Chance wants things that cannot be: a name twice, a robot where it is.
                check(done.returncode in (0, 12), f"{deeds}: {done.returncode} {done.stderr}")
                hashes.append(summary["hash"])
            equal += hashes[0] == hashes[1]
            if hashes[0] != hashes[1]:
                print(f"two hashes: {hashes}\n{deeds}")
        print(f"clones: {count} runs of 16 clones, launches, moves and ends, {equal} with one hash when done again")
        return equal == count


# --- a team that runs free ---------------------------------------------------------------------


class Host:
    """A host whose log is read as it is written."""

    def __init__(self, team, name, *words):
        self.name, self.lines, self.news = name, [], threading.Condition()
        self.process = team.processes.start(MUSTER, "host", name, "--verbose", "--domain", team.domain,
                                            *words, stderr=subprocess.PIPE, text=True)
        self.reader = threading.Thread(target=self.read, daemon=True)
        self.reader.start()

    def read(self):
        for line in self.process.stderr:
            with self.news:
                self.lines.append(line)
                self.news.notify_all()

    def saw(self, what, seconds, since=0):
        """Waits for a line of the log, from the since-th on."""
        with self.news:
            return self.news.wait_for(lambda: any(what in line for line in self.lines[since:]), seconds)


class Team:
    def __init__(self, processes, out, step_ms, robots, minutes):
        self.processes, self.out, self.domain = processes, out, new_domain()
        self.broker, self.all = broker_start(processes, self.domain), []
        self.hosts = {name: self.host_start(name) for name in ("north", "south")}
        for name, rules in robots.items():
            (out / f"{name}.clp").write_text(rules)
            processes.start(MUSTER, "robot", name, "--rules", out / f"{name}.clp", "--domain", self.domain)
        wait_for(lambda: set(robots) < set(members(self.domain)), 20, "the robots")
        self.sim = processes.start(
            MUSTER, "sim", ROOT / "worlds/arena.world", "--free", "--step", step_ms, "--csv", out / "run.csv",
            "--duration", 60 * minutes, "--domain", self.domain,
            *(word for name in robots for word in ("--robots", name)))
        self.done("start", ",".join(robots))

    def host_start(self, name, *words):
        store = self.out / f"store.{name}"
        store.mkdir(exist_ok=True)
        host = Host(self, name, "--checkpoint", 1, "--folder", store, *words)
        self.all.append(host)
        wait_for(lambda: members(self.domain).get(name, {"state": "absent"})["state"] == "running", 10, name)
        return host

    def log(self):
        """The last lines of all hosts there have been, in order of time."""
        return "".join(sorted(line for host in self.all for line in host.lines)[-20:])

    def done(self, *words):
        done = muster(*words, "--domain", self.domain)
        check_equal(done.returncode, 0, f"muster {' '.join(map(str, words))}: {done.stderr}")
        return done.stdout

    def ask(self, name, line):
        return self.done("do", name, line).split(": ", 1)[1].strip()

    def place_of(self, name):
        pages = members(self.domain)
        if pages[name]["state"] in ("absent", "moving"):
            return None
        pids = {pages[host]["pid"]: host for host in self.hosts if pages[host]["state"] != "absent"}
        return pids.get(pages[name]["pid"])


# --- free running ------------------------------------------------------------------------------


def idle_ms(path, step_ms):
    """How long the motors were off each time, once the body had come to its speed: the body gets
    slower, or stands still."""
    with open(path) as f:
        speeds = [float(row["forward_m_s"]) for row in csv.DictReader(f) if row["robot"] == "red"]
    first = next(i for i, speed in enumerate(speeds) if speed > SPEED_M_S - 0.01)
    idle = "".join("0" if now < before - 0.001 or now < 0.01 else "1"
                   for before, now in zip(speeds[first:], speeds[first + 1:]))
    return [len(times) * step_ms for times in idle.split("1") if times]


def free(count, dice):
    return all([free_at(count, dice, step_ms) for step_ms in (100, 20)])


def free_at(count, dice, step_ms):
    with folder() as out, Processes() as processes:
        t = Team(processes, out, step_ms, {"red": "(defrule circle (position $?) => (setSpeed 300 40))"}, 60)
        t.done("move", "red", "north")
        took = []
        for i in range(count):
            time.sleep(dice.uniform(0.1, 0.3))
            host = ("south", "north")[i % 2]
            began = time.monotonic()
            check_equal(t.done("move", "red", host), f"red at {host}\n", "the answer")
            took.append(time.monotonic() - began)
        t.done("suspend", "red")  # so that the record has one stop at least
        time.sleep(0.5)
        t.done("resume", "red")
        time.sleep(0.5)
        t.sim.terminate()
        t.sim.wait()
        stops = idle_ms(out / "run.csv", step_ms)
        check(max(stops, default=0) >= 400, "a suspended robot goes on in the record")
        stops.remove(max(stops))
        stops += [0] * (count - len(stops))
        print(f"free, steps of {step_ms} ms: {count} moves; the motors were off for {statistics.median(stops):.0f}"
              f" ms (median), {max(stops)} ms (worst): {dict(sorted(collections.Counter(stops).items()))};"
              f" the command took {1000 * statistics.median(took):.0f} ms (median)")
        return max(stops) <= 200


# --- kills -------------------------------------------------------------------------------------


def place_settled(t, seconds):
    """Where red lives, when it does and nothing is on its way."""
    def there():
        return members(t.domain)["red"]["state"] == "running" and t.place_of("red")
    return wait_for(there, seconds, "red lives")


def killed(t, dice, which):
    """One move in which somebody dies.  @return what became of it, and whether that was in time"""
    source = t.place_of("red")
    target = "south" if source == "north" else "north"
    victims = {"source": [source], "target": [target], "both": [source, target]}[which]
    since = {name: len(t.hosts[name].lines) for name in (source, target)}
    move = t.processes.start(MUSTER, "move", "red", target, "--wait", 3, "--domain", t.domain)
    check(t.hosts[source].saw("name=red state=moving", 10, since[source]), "red on its way")
    time.sleep(dice.uniform(0, MOVE_S))
    for name in victims:
        t.hosts[name].process.kill()
    for name in victims:
        t.hosts[name].process.wait()
        t.hosts[name].reader.join()  # it has read the last words
    move.wait()
    over = any(t.hosts[name].saw("name=red state=running", 0, since[name]) and name in victims
               for name in (source, target))  # it lived there, or, after a refusal, where it was
    for name in victims:
        wait_for(lambda n=name: members(t.domain)[n]["state"] == "absent", 10, f"{name} gone")
        t.hosts[name] = t.host_start(name, "--restore")
    try:
        place = place_settled(t, 20)
    except AssertionError as why:
        files = sorted(str(f.relative_to(t.out)) for f in t.out.glob("store.*/*"))
        raise AssertionError(f"{which} killed on the way from {source}: {why}\n{t.log()}{files}\n"
                             f"{members(t.domain)['red']}") from None
    return "stayed" if place == source else "went on", not over


def kills(count, dice):
    with folder() as out, Processes() as processes:
        t = Team(processes, out, 20, {"red": COUNTS, "blue": SENDS}, 60)
        t.done("move", "red", "north")
        wait_for(lambda: int(t.ask("red", "?*last*")) > 3, 10, "the first mail")
        fates, wrong, late = collections.Counter(), 0, 0
        while sum(fates.values()) < count:
            which = ("source", "target", "both")[(sum(fates.values()) + late) % 3]
            before = int(t.ask("red", "?*wrong*"))
            fate, in_time = killed(t, dice, which)
            sent = int(t.ask("blue", "?*n*"))
            wait_for(lambda s=sent: int(t.ask("red", "?*last*")) >= s, 20, "the mail of the move")
            if in_time:
                fates[which, fate] += 1
                bad = int(t.ask("red", "?*wrong*")) - before
                wrong += bad
                if bad:
                    print(f"{which} killed, red {fate}: {bad} mails\n" + t.log())
            late += not in_time
        told = ", ".join(f"{which} killed, red {fate}: {n}" for (which, fate), n in sorted(fates.items()))
        print(f"kills: {count} ({late} more came when the move was over); {told}; one agent after each;"
              f" mails lost, twice or out of order: {wrong}")
        return wrong == 0


PARTS = {"lockstep": lockstep, "clones": clones, "free": free, "kills": kills}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("parts", nargs="*", choices=[[], *PARTS], metavar="PART")
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=random.randrange(1 << 30))
    words = parser.parse_args()
    print(f"seed {words.seed}", flush=True)
    dice = random.Random(words.seed)
    results = [PARTS[part](words.count, dice) for part in words.parts or PARTS]
    print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
    return not all(results)


if __name__ == "__main__":
    sys.exit(main())
