# SPDX-License-Identifier: Apache-2.0
"""What goes wrong on purpose, and what is expected of a run in spite of it."""
import re

from support import ROOT, check, check_equal, experiment_run, folder, muster, pair_run as run


def test_the_world_goes_wrong_the_same_way_every_time():
    with folder() as out:
        _, plain = run(out, "plain", "")
        text = """
chaos:
  - {at: 3, push: red, force: [0, 80], for: 0.5}
  - {when: "red.distance_m > 1", block: blue, sensor: sonar, for: 2}
  - {when: "red told mate-pos", push: blue, force: [2, 0]}
  - {at: 8, place: blue, pose: [0, 2, 90]}
  - {when: "red near blue 0.1", push: red, force: [1, 0]}
"""
        _, first = run(out, "a", text)
        _, second = run(out, "b", text, "--rate", "20")
        check(first["hash"] != plain["hash"], "chaos changes the hash")
        check_equal(second["hash"], first["hash"], "the same chaos, paced")
        chaos = first["chaos"]
        check_equal([c["done"] for c in chaos], [True, True, True, True, False], "what was done")
        check_equal((chaos[0]["at_s"], chaos[3]["at_s"], chaos[4]["at_s"]), (3, 8, None), "when")
        check_equal(chaos[1]["text"], "block blue's sonar for 2 s when red.distance_m > 1", "text")
        check(0 < chaos[1]["at_s"] < 8, f"the condition came true: {chaos[1]}")
        page = (out / "a/report.html").read_text()
        check("push red with 0, 80 N for 0.5 s" in page, "the report tells of it")
        final = {r["name"]: r["final"] for r in first["robots"]}
        check(final["blue"]["y_m"] > 0, f"blue was put elsewhere: {final}")
        done = muster("verify", out / "a/run.mcap")
        check_equal(done.returncode, 0, f"the recording, done again: {done.stdout} {done.stderr}")


def test_who_is_placed_has_not_driven_there():
    """Neither in the report nor while the run lives; a report that is made again says the same."""
    with folder() as out:
        (out / "still.clp").write_text("(defrule nothing (position $?) =>)\n")
        (out / "still.yaml").write_text(f"""
world: {ROOT}/worlds/arena.world
duration: 4
robots:
  - {{name: red, rules: still.clp}}
  - {{name: blue, rules: still.clp}}
chaos:
  - {{at: 1, place: red, pose: [0, -2, 90]}}
  - {{at: 2, place: blue, pose: [2, 2, 90]}}
  - {{at: 3, place: red, pose: [0, 2, 90]}}
expect:
  - {{never: "red.distance_m > 0.5"}}
""")
        done, summary = experiment_run(out / "a", file=out / "still.yaml")
        check_equal(done.returncode, 0, done.stderr)
        for robot in summary["robots"]:
            check(robot["distance_m"] < 0.01 > robot["mean_speed_m_s"], robot)
        placements = (out / "a/placements.csv").read_text()
        check_equal(placements, "time_s,robot\n1.100000,red\n2.100000,blue\n3.100000,red\n", "when")
        before = (out / "a/summary.json").read_bytes()
        for name in ("run.csv", "placements.csv"):
            (out / "a" / name).unlink()
        check_equal(muster("report", out / "a").returncode, 0, "the report again")
        check_equal((out / "a/placements.csv").read_text(), placements, "out of the recording")
        check((out / "a/summary.json").read_bytes() == before, "the same figures")


def test_lost_and_late_packets_change_nothing():
    """Reliable topics send again what is lost, and lock step waits for it."""
    with folder() as out:
        _, plain = run(out, "plain", "", "--duration", "6")
        _, struck = run(out, "struck", """
chaos:
  - {at: 1, lose: [red, all], share: 0.1}
  - {at: 1, lose: [broker, all], share: 0.1}
  - {at: 2, delay: [blue, simulator], by_ms: 5}
  - {at: 4, cut: [blue, broker], wall_s: 0.5}
""", "--duration", "6")
        check_equal(struck["hash"], plain["hash"], "the hash with one packet of ten lost")
        check(struck["packets_struck"] > 50, f"packets struck: {struck['packets_struck']}")
        check_equal([c["at_s"] for c in struck["chaos"]], [1, 1, 2, 4], "when")
        check_equal((struck["mail"]["lost"], struck["mail"]["duplicated"]), (0, 0), "mail")


def test_a_stopped_process_is_waited_for():
    with folder() as out:
        _, plain = run(out, "plain", "", "--duration", "5")
        _, stopped = run(out, "stopped", """
chaos:
  - {at: 2, stop: blue, wall_s: 0.4}
  - {at: 3, stop: broker, wall_s: 0.4}
""", "--duration", "5")
        check_equal(stopped["hash"], plain["hash"], "the hash with a process that stood still")
        check_equal([c["done"] for c in stopped["chaos"]], [True, True], "they were stopped")


def test_a_robot_that_came_back_may_stand_still():
    """Who has come back once is not given up when it is silent later."""
    with folder() as out:
        _, plain = run(out, "plain", "")
        done, both = run(out, "both", """
on-crash: restart
checkpoint: 0.1
chaos:
  - {at: 2, kill: blue, wall_s: 0.2}
  - {at: 3, stop: blue, wall_s: 1.5}
  - {at: 4, kill: blue, wall_s: 0.2}
  - {at: 4.5, stop: blue, wall_s: 1.5}
""")
        check_equal(done.returncode, 0, done.stderr)
        check_equal(both["hash"], plain["hash"], "the hash")


def test_a_killed_robot_comes_back_in_lock_step():
    """It begins anew while the clock stands still: at the same step in every run."""
    with folder() as out:
        told = """  - {at: 6, do: blue, line: "(follow red)"}\n"""
        _, plain = run(out, "plain", told)
        text = told + "chaos:\n  - {at: 2, kill: blue}\n  - {at: 2, restart: blue}\n"
        done, first = run(out, "first", text)
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        check_equal([(c["at_s"], c["done"]) for c in first["chaos"]], [(2, True)] * 2, "what was done")
        check(first["hash"] != plain["hash"], "what it knew is lost")
        blue, was = first["robots"][1], plain["robots"][1]
        check(was["rule_firings"] - 5 < blue["rule_firings"] < was["rule_firings"],
              f"it came back at once, and had to be told to run: {blue}")
        _, second = run(out, "second", text)
        _, later = run(out, "later", told + "chaos:\n  - {at: 2, kill: blue, wall_s: 0.7}\n")
        check_equal([second["hash"], later["hash"]], [first["hash"]] * 2, "the same way every time")
        when = "chaos:\n  - {when: time >= 2, kill: blue}\n  - {when: time >= 2, restart: blue}\n"
        check_equal(run(out, "when", told + when)[1]["hash"], first["hash"], "by a condition")
        again = muster("verify", out / "first/run.mcap")
        check_equal(again.returncode, 0, f"the recording, done again: {again.stdout}")


def test_a_killed_robot_with_checkpoints_has_lost_nothing():
    with folder() as out:
        _, plain = run(out, "plain", "")
        _, killed = run(out, "killed", """
on-crash: restart
checkpoint: 0.1
chaos:
  - {at: 2, kill: blue}
  - {at: 2, restart: blue}
  - {at: 5, kill: red, wall_s: 0.2}
""")
        check_equal([c["done"] for c in killed["chaos"]], [True] * 3, "they were killed")
        check_equal(killed["hash"], plain["hash"], "the hash with two robots that died")
        check("restarts" not in killed, "and nobody came back by himself")


def test_what_lasts_in_lock_step_is_simulated_time():
    with folder() as out:
        _, plain = run(out, "plain", "", "--duration", "6")
        hashes, struck = [], []
        for lasts in ("", ", for: 1", ", for: 100"):
            _, late = run(out, f"late{len(lasts)}", f"""
chaos:
  - {{at: 2, delay: [blue, simulator], by_ms: 1{lasts}}}
""", "--duration", "6")
            hashes.append(late["hash"])
            struck.append(late["packets_struck"])
        check_equal(hashes, [plain["hash"]] * 3, "late packets change no hash")
        check(0 < struck[1] < struck[0] / 2 and struck[2] > 2 * struck[1],
              f"one second of four: {struck}")


def test_what_lock_step_cannot_do_is_refused_with_its_place():
    cases = (("kill: blue, for: 1", "13:30: 'blue': in lock step the clock waits for it"),
             ("stop: broker, for: 1", "13:32: 'broker': in lock step the clock waits for it"),
             ("cut: [red, blue], for: 1", "13:36: 'red': in lock step the clock waits for it"),
             ("lose: [red, all], share: 1, for: 1", "13:46: 'red': in lock step the clock waits"),
             ("continue: red", "13:5: 'red': in lock step the clock waits for what is stopped"),
             ("restart: red", "13:5: 'red': in lock step the clock waits for what is killed"),
             ("kill: blue", "13:5: 'blue': in lock step the run would end with it"),
             ("kill: broker", "13:5: 'broker': in lock step it does not come back"),
             ("kill: simulator", "13:5: 'simulator': it does not come back"),
             ("kill: broker, wall_s: 1", "13:5: 'broker': in lock step it does not come back"),
             ("kill: simulator, wall_s: 1", "13:5: 'simulator': it does not come back"))
    with folder() as out:
        for i, (words, why) in enumerate(cases):
            done, summary = run(out, f"c{i}", f"chaos:\n  - {{at: 3, stop: blue, wall_s: 0.1}}\n"
                                              f"  - {{at: 4, {words}}}\n", "--duration", "1")
            check_equal((done.returncode, summary), (3, None), words)
            check(f"c{i}.yaml:{why}" in done.stderr, f"{words}: {done.stderr}")
        done, _ = run(out, "apart", "chaos:\n  - {at: 3, kill: red}\n  - {at: 4, restart: red}\n")
        check_equal(done.returncode, 3, "a time that never comes")
        check("expected a kill of it before, with the same `at`" in done.stderr, done.stderr)
        free, _ = run(out, "free", "chaos:\n  - {at: 0.4, stop: red}\n  - {at: 0.6, continue: red}\n"
                                   "  - {at: 0.7, cut: [red, broker], for: 0.1}\n"
                                   "  - {at: 0.9, kill: broker, for: 0.1}\n", "--free",
                      "--duration", "1")
        check_equal(free.returncode, 0, f"in free running all of them can be done: {free.stderr}")
        free, _ = run(out, "sim", "chaos:\n  - {at: 0.4, restart: simulator}\n", "--free")
        check_equal(free.returncode, 3, "but for the simulator")


def test_a_killed_broker_comes_back_with_its_mail():
    with folder() as out:
        done, summary = run(out, "a", """
free: true
broker: {store: true}
chaos:
  - {at: 3, kill: broker, for: 1}
expect:
  - {statistic: mail.delivered, at_least: 60}
  - sequence: ["time > 8", "red told mate-pos"]
""")
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        check_equal(summary["hash"], "none", "it ran free")
        check_equal([c["done"] for c in summary["chaos"]], [True], "it was killed")
        blue = summary["robots"][1]
        check(blue["mail_received"] > 70, f"mail came through to the end: {blue}")
        check((out / "a/broker.db").exists(), "its store")


def test_a_killed_robot_comes_back_in_free_running():
    with folder() as out:
        done, summary = run(out, "a", """  - {at: 6, do: blue, line: "(wander)"}
free: true
chaos:
  - {at: 2, kill: blue, for: 1}
expect:
  - {sequence: ["time > 6", "blue told mate-pos"]}
  - {statistic: blue.distance_m, at_least: 1.2}
""")
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        check_equal([c["done"] for c in summary["chaos"]], [True], "it was killed")


def test_expectations_on_statistics_and_events():
    with folder() as out:
        done, summary = run(out, "a", """
expect:
  - {statistic: red.distance_m, at_least: 1}
  - {statistic: red.distance_m, at_most: 1}
  - {statistic: mail.lost, at_most: 0}
  - {sequence: ["red told mate-pos", "blue near red 3", "red told mate-pos"], within_s: 10}
  - {sequence: ["red told mate-pos", "red told nothing"]}
  - {never: red stalled}
  - {never: blue near red 3}
  - {statistic: red.distance_m, at_least: 100, from: 11}
""")
        check_equal(done.returncode, 1, "some are not met")
        met = [e["met"] for e in summary["expectations"]]
        check_equal(met, [True, False, True, True, False, True, False, False], "which are met")
        check("red told mate-pos, then red told nothing" in done.stdout, done.stdout)
        events = (out / "a/events.csv").read_text().splitlines()
        check_equal(events[0], "time_s,event", "the first line of events.csv")
        check_equal(sum(line.endswith(",red told mate-pos") for line in events), 120,
                    "a mail in each step")
        _, short = run(out, "short", """
expect:
  - {statistic: red.distance_m, at_least: 100, from: 11}
""", "--duration", "3")
        check_equal(short["expectations"], [], "what is later than the end is not judged")


def test_wrong_chaos_is_refused_with_its_place():
    with folder() as out:
        for text, expected in (
                ("chaos:\n  - {at: 1, push: rad, force: [1, 1]}\n", r"\.yaml:12:5: no robot or thing 'rad'"),
                ("chaos:\n  - {when: red likes blue, kill: red}\n", r"\.yaml:12:12: expected near"),
                ("expect:\n  - {never: red near puck 1}\n", r"\.yaml:12:13: no robot or thing 'puck'"),
                ("expect:\n  - {statistic: red.speed, at_least: 1}\n",
                 r"\.yaml:12:17: no statistic 'red.speed'")):
            done, _ = run(out, "wrong", text)
            check_equal(done.returncode, 3, text)
            check(re.search(expected, done.stderr), f"{text}: {done.stderr}")
