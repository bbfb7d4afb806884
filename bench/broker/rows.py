# SPDX-License-Identifier: Apache-2.0
"""What is measured, a function each, and what is wanted of it."""
import os
import signal
import statistics
import typing

import brokers

PINGS, CROWD, STORED = 2000, 100, 10000
PACE_S, PACED = 1000, 3000
FLOOD = {"ours": 200000, "mqtt": 100000, "nats": 100000}  # mails: a second or less
PAIRS, TRIPS, TRIPS_MEMORY = 50, 200, 4000  # round trips of a pair
NAMES_MANY, NAMES_FEW, CACHED = 10000, 100, 1000000


def both(here):
    """Ours and mosquitto, each with its prefix, for what is measured of both."""
    return (("ours", here.ours), ("mqtt", here.mosquitto))


def every(here):
    """The same with NATS; in each round another one is first."""
    those = [*both(here), ("nats", here.nats)]
    first = here.turn % len(those)
    return those[first:] + those[:first]


def prefixed(prefix, numbers):
    return {f"{prefix}_{key}": value for key, value in numbers.items()}


def paced(here):
    found = {}
    for prefix, start in every(here):
        with start() as broker, broker.crowd(1):
            found.update(prefixed(f"{prefix}_paced", broker.load("pace", "a0", PACE_S, PACED)))
    return found


def roundtrip(here):
    found = {"direct_us": here.direct_us()}
    for prefix, start in every(here):
        with start() as broker, broker.crowd(1):
            found.update(prefixed(f"{prefix}_trip", broker.load("ping", PINGS, 1)))
    return found


def throughput(here):
    found = {}
    for prefix, start in every(here):
        with start() as broker, broker.crowd(1):
            broker.load("flood", "a0", 5000, 16)
            for batch in (16, 1):
                numbers = broker.load("flood", "a0", FLOOD[prefix], batch)
                found.update(prefixed(f"{prefix}_flood{batch}", numbers))
    return found


def pairs(here):
    found = {}
    for prefix, start in every(here):
        with start() as broker, broker.crowd(PAIRS):
            found.update(prefixed(f"{prefix}_pairs", broker.load("pairs", PAIRS, TRIPS)))
    return found


def memory(here):
    """What 100 processes, 50 that ask and 50 that answer, leave behind in a broker."""
    found = {}
    for prefix, start in every(here):
        with start() as broker, broker.crowd(PAIRS):
            broker.load("pairs", PAIRS, TRIPS)
            found[f"{prefix}_few_mb"] = broker.resident_kb() / 1024
            broker.load("pairs", PAIRS, TRIPS_MEMORY)
            found[f"{prefix}_many_mb"] = broker.resident_kb() / 1024
    return found


def crowd(here):
    found = {}
    for prefix, start in every(here):
        with start() as broker, broker.crowd(1):
            found[f"{prefix}_of1_p50_us"] = broker.load("ping", PINGS, 1)["p50_us"]
        # Another broker: at ours, a name of somebody who was killed is held until his lease ends.
        with start() as broker:
            idle_kb = broker.resident_kb()
            with broker.crowd(CROWD) as those:
                found[f"{prefix}_ready_s"] = those.said["ready_s"]
                found[f"{prefix}_process_kb"] = (broker.resident_kb() - idle_kb) / CROWD
                found.update(prefixed(f"{prefix}_all", broker.load("tell", CROWD, those.board)))
                found.update(prefixed(f"{prefix}_same", broker.load("ping", PINGS, 1)))
                found.update(prefixed(f"{prefix}_of100", broker.load("ping", PINGS, CROWD)))
    with here.direct(CROWD) as nobody, nobody.crowd(CROWD) as those:
        found.update(prefixed("direct_all", nobody.load("tell", CROWD, those.board)))
    with here.star() as hub, hub.crowd(CROWD) as those:
        found["star_ready_s"] = those.said["ready_s"]
    return found


def names(here):
    """The directory, and what an agent costs; only ours has one."""
    found = {}
    with here.ours() as broker:
        found["idle_mb"] = broker.resident_kb() / 1024
        if not brokers.NAMES.exists():
            return found

        def ask(mode, agents, count=1):
            return brokers.measure(brokers.NAMES, mode, broker.where, agents, count)

        before_kb = broker.resident_kb()
        found["names_s"] = ask("register", NAMES_MANY)
        found["agent_kb"] = (broker.resident_kb() - before_kb) / NAMES_MANY
        found["direct_us"] = here.direct_us()
        # As there: one pair may happen to share a processor, or not.
        asked = [(ask("lookup", NAMES_FEW, PINGS), ask("lookup", NAMES_MANY, PINGS))
                 for _ in range(9)]
        found["lookup_few_us"], found["lookup_us"] = map(statistics.median, zip(*asked))
        found["cached_ns"] = ask("cached", NAMES_MANY, CACHED)
    return found


# As in enum mu_level.  What mosquitto stores is not on a disk, and its quality of service is 1.
LEVELS = {"ram": 0, "logged": 1, "synced": 2}


def stored(here):
    """Mail to somebody who is away, and the way back."""
    found = {}
    levels = LEVELS if here.broker_has("--store") else {"ram": 0}
    for level, number in levels.items():
        with here.ours() as broker:
            broker.load("visit", "away")
            put = broker.load("store", "away", STORED, number)
            found.update(prefixed(f"ours_{level}", put))
            found.update(prefixed(f"ours_{level}", broker.load("drain", "away", STORED)))
    with here.mosquitto() as broker:
        broker.load("visit", "away")
        found.update(prefixed("mqtt_stored", broker.load("store", "away", STORED, 1)))
        found.update(prefixed("mqtt_stored", broker.load("drain", "away", STORED)))
    with here.redis() as broker:
        found.update(prefixed("redis_stored", broker.load("store", "away", STORED, 2)))
    return found


POUR_S = 2000  # mails a second to somebody who does not take them


def bystanders(here):
    """Two who have nothing to do with it, while something happens to others."""
    found = {}
    for prefix, start in both(here):
        with start() as broker, broker.crowd(2):

            def note(what):
                numbers = broker.load("ping", PINGS, 1)
                found[f"{prefix}_by_{what}_us"] = numbers["p99_us"]

            note("quiet")
            with broker.beside("deaf", "asleep", says=True) as deaf:
                os.kill(deaf.pid, signal.SIGSTOP)
                try:
                    with broker.beside("pour", "asleep", POUR_S):
                        note("stopped")
                finally:
                    os.kill(deaf.pid, signal.SIGKILL)
            with broker.beside("deaf", "deaf", says=True):
                with broker.beside("pour", "deaf", POUR_S):
                    note("deaf")
            with broker.beside("flood", "a1", 10000000, 16):
                note("flood")
        unfair(found, prefix, start)
    return found


def unfair(found, prefix, start):
    """A hundred: one is stopped, one takes nothing, one floods another; the rest are asked in turn."""
    those = CROWD - 3
    with start() as broker, broker.crowd(those + 1):
        found[f"{prefix}_fair_us"] = broker.load("ping", PINGS, those)["p99_us"]
        with broker.beside("deaf", "asleep", says=True) as asleep, broker.beside("deaf", "deaf", says=True):
            os.kill(asleep.pid, signal.SIGSTOP)
            try:
                with broker.beside("pour", "asleep", POUR_S), broker.beside("pour", "deaf", POUR_S), \
                        broker.beside("flood", f"a{those}", 10000000, 16):
                    found[f"{prefix}_unfair_us"] = broker.load("ping", PINGS, those)["p99_us"]
            finally:
                os.kill(asleep.pid, signal.SIGKILL)


# ms: pings and mails that take about a second
INTERVALS = {0: (1000, 50000), 1: (300, 50000), 5: (100, 20000), 20: (40, 10000), 100: (10, 3000)}


def interval(here):
    found = {}
    if not here.broker_has("--delivery-interval"):
        return found
    for ms, (pings, mails) in INTERVALS.items():
        with here.ours("--delivery-interval", ms) as broker, broker.crowd(1):
            found[f"interval_{ms}_delay_us"] = broker.load("ping", pings, 1)["p50_us"] / 2
            numbers = broker.load("flood", "a0", mails, 16)
            found[f"interval_{ms}_mails_s"] = numbers["mails_s"]
            found[f"interval_{ms}_cpu_us"] = numbers["cpu_us"]
    return found


GROUPS = {"paced": paced, "roundtrip": roundtrip, "throughput": throughput, "pairs": pairs,
          "crowd": crowd, "memory": memory, "names": names, "stored": stored, "bystanders": bystanders, "interval": interval}

DIGITS = {"us": 1, "MB": 1, "kB": 1, "s": 3, "ms": 1, "ns": 0}


class Line(typing.NamedTuple):
    """One line of the table; most and least bound the ratio, or ours where there is no other."""
    group: str
    what: str
    unit: str
    ours: str
    against: str = ""
    peer: str = ""
    most: float = None
    least: float = None
    why: str = ""  # it may be missing

    def wanted(self):
        unit = "" if self.peer else f" {self.unit}"
        if self.most is not None:
            return f"at most {self.most:g}{unit}"
        return f"at least {self.least:g}{unit}" if self.least is not None else ""

    def met(self, value):
        if self.most is not None:
            return value <= self.most
        return value >= self.least if self.least is not None else None


NO_STORE = "muster-broker has no --store"
NO_NAMES = "runtime_names is not there"
MQ0, MQ1 = "mosquitto QoS 0:", "mosquitto QoS 1:"
NATS = "NATS:"


def beside(group, what, unit, key, most=None, least=None, nats_least=None):
    """Two lines: ours beside mosquitto, and beside NATS."""
    return (Line(group, what, unit, f"ours_{key}", MQ0, f"mqtt_{key}", most, least),
            Line(group, what, unit, f"ours_{key}", NATS, f"nats_{key}", None, nats_least))


LINES = (
    *beside("paced", "paced 1,000/s, broker CPU per mail", "us", "paced_cpu_us", 0.95),
    *beside("paced", "paced 1,000/s, all CPU per mail", "us", "paced_all_cpu_us", 0.9),
    *beside("roundtrip", "round trip p50", "us", "trip_p50_us", 0.65),
    *beside("roundtrip", "round trip p99", "us", "trip_p99_us", 1),
    *beside("roundtrip", "round trip, broker CPU", "us", "trip_cpu_us"),
    *beside("roundtrip", "round trip, all CPU", "us", "trip_all_cpu_us", 0.65),
    Line("roundtrip", "round trip p50", "us", "ours_trip_p50_us", "no broker:", "direct_us", 2.2),
    *beside("throughput", "flood, 16 at a time", "1/s", "flood16_mails_s", least=5),
    *beside("throughput", "flood, 16 at a time, broker CPU per mail", "us", "flood16_cpu_us"),
    *beside("throughput", "flood, one at a time", "1/s", "flood1_mails_s", None, 2.8, 1.1),
    *beside("throughput", "flood, one at a time, broker CPU per mail", "us", "flood1_cpu_us"),
    *beside("throughput", "flood, one at a time, all CPU per mail", "us", "flood1_all_cpu_us"),
    *beside("pairs", "50 pairs at once, round trips", "1/s", "pairs_trips_s", None, 1.3, 1.15),
    *beside("pairs", "50 pairs at once, p50", "us", "pairs_p50_us"),
    *beside("pairs", "50 pairs at once, p99", "us", "pairs_p99_us", 1.1),
    *beside("pairs", "50 pairs at once, broker CPU per round trip", "us", "pairs_cpu_us"),
    *beside("pairs", "50 pairs at once, all CPU per round trip", "us", "pairs_all_cpu_us", 0.7),
    *beside("crowd", "each of 100 in turn, p50", "us", "of100_p50_us", 1),
    *beside("crowd", "each of 100 in turn, p99", "us", "of100_p99_us", 1.2),
    *beside("crowd", "each of 100 in turn, broker CPU", "us", "of100_cpu_us", 1.1),
    *beside("crowd", "each of 100 in turn, all CPU", "us", "of100_all_cpu_us"),
    *beside("crowd", "broadcast to 100, complete p50", "us", "all_p50_us", 0.75),
    *beside("crowd", "broadcast to 100, complete p99", "us", "all_p99_us", 1.2),
    *beside("crowd", "broadcast to 100, broker CPU", "us", "all_cpu_us"),
    *beside("crowd", "broadcast to 100, all CPU", "us", "all_all_cpu_us"),
    *beside("crowd", "broadcasts in a flood, deliveries", "1/s", "all_deliveries_s", None, 4, 0.5),
    *beside("memory", "broker's memory after 10,000 round trips of 100", "MB", "few_mb"),
    *beside("memory", "broker's memory after 200,000 more", "MB", "many_mb"),
    Line("memory", "broker's memory after 200,000 more", "MB", "ours_many_mb", most=20),
    Line("memory", "broker's memory after 200,000 more", "MB", "ours_many_mb", "ours, before:",
         "ours_few_mb"),
    Line("crowd", "broadcast to 100, complete p50", "us", "ours_all_p50_us", "no broker:",
         "direct_all_p50_us"),
    Line("crowd", "no broker, to 100, complete p50", "us", "direct_all_p50_us", MQ0,
         "mqtt_all_p50_us"),
    Line("crowd", "no broker, to 100, complete p99", "us", "direct_all_p99_us", MQ0,
         "mqtt_all_p99_us"),
    Line("crowd", "round trip p50, one among 100", "us", "ours_same_p50_us", "ours, among 1:",
         "ours_of1_p50_us", 1.8),
    Line("crowd", "round trip p50, each of 100 in turn", "us", "ours_of100_p50_us",
         "ours, among 1:", "ours_of1_p50_us"),
    Line("crowd", "100 processes started and reachable", "s", "ours_ready_s", most=0.6),
    Line("crowd", "100 processes started and reachable", "s", "ours_ready_s", "a bare DDS star:",
         "star_ready_s", 1.5),
    Line("crowd", "broker's memory per process", "kB", "ours_process_kb", most=80),
    Line("names", "broker's memory, idle", "MB", "idle_mb", most=10),
    Line("names", "broker's memory per agent", "kB", "agent_kb", most=1, why=NO_NAMES),
    Line("names", "10,000 registrations", "1/s", "names_s", least=50000, why=NO_NAMES),
    Line("names", "lookup mail among 10,000", "us", "lookup_us", "no broker:", "direct_us", 1.2,
         why=NO_NAMES),
    Line("names", "lookup mail among 10,000", "us", "lookup_us", "ours, among 100:",
         "lookup_few_us", 1.1, why=NO_NAMES),
    Line("names", "cached lookup", "ns", "cached_ns", most=1000, why=NO_NAMES),
    Line("stored", "stored for the absent, ram", "1/s", "ours_ram_mails_s", MQ1,
         "mqtt_stored_mails_s"),
    Line("stored", "stored for the absent, logged", "1/s", "ours_logged_mails_s", MQ1,
         "mqtt_stored_mails_s", least=1.5, why=NO_STORE),
    Line("stored", "stored for the absent, synced", "1/s", "ours_synced_mails_s",
         "Redis, fsync always:", "redis_stored_mails_s", least=0.5, why=NO_STORE),
    Line("stored", "10,000 drained, ram", "s", "ours_ram_drain_s", MQ1, "mqtt_stored_drain_s", 0.5),
    Line("stored", "10,000 drained, logged", "s", "ours_logged_drain_s", MQ1,
         "mqtt_stored_drain_s", 0.5, why=NO_STORE),
    Line("stored", "the same from the reader's start, ram", "s", "ours_ram_whole_s", MQ1,
         "mqtt_stored_whole_s"),
    Line("bystanders", "bystanders' p99, a receiver stopped", "us", "ours_by_stopped_us",
         "undisturbed:", "ours_by_quiet_us", 2),
    Line("bystanders", "bystanders' p99, a receiver deaf", "us", "ours_by_deaf_us",
         "undisturbed:", "ours_by_quiet_us", 2),
    Line("bystanders", "bystanders' p99, a flood", "us", "ours_by_flood_us", "undisturbed:",
         "ours_by_quiet_us", 2),
    Line("bystanders", "bystanders' p99, a flood", "us", "ours_by_flood_us",
         "mosquitto QoS 0, a flood:", "mqtt_by_flood_us"),
    Line("bystanders", "each of 97, p99: 3 more stopped, deaf, flooding", "us", "ours_unfair_us",
         "undisturbed:", "ours_fair_us", 2),
    Line("bystanders", "each of 97, p99: 3 more stopped, deaf, flooding", "us", "ours_unfair_us",
         MQ0, "mqtt_unfair_us"),
)

INTERVAL_HEAD = ["delivery interval", "median delay of a mail", "mails", "broker CPU per mail"]


def interval_lines(rounds):
    lines = []
    for ms in INTERVALS:
        there = [r for r in rounds if f"interval_{ms}_delay_us" in r]
        if there:
            delay, mails, cpu = (statistics.median(r[f"interval_{ms}_{what}"] for r in there)
                                 for what in ("delay_us", "mails_s", "cpu_us"))
            lines.append([f"{ms} ms", f"{delay / 1000:.2f} ms", f"{mails:.0f} 1/s",
                          f"{cpu:.2f} us"])
    return lines
