# SPDX-License-Identifier: Apache-2.0
"""Many robots in one process: nothing but the number of processes is different."""
import os
import subprocess

from support import (MUSTER, ROOT, Processes, broker_start, check, check_equal, child_of, experiment_run,
                     folder, members, muster, new_domain, wait_for)


def crowd(out, processes, robots=20):
    """An experiment with so many robots that write to each other in every step."""
    path = out / f"crowd-{processes}.yaml"
    path.write_text(f"""
world: {ROOT}/worlds/arena.world
duration: 10
robots:
  - {{name: w, count: {robots}, processes: {processes}, body: pioneer, place: random,
     rules: {ROOT}/rules/follower.clp, groups: [crowd]}}
observer:
  - {{at: 0, do: robots, line: (wander)}}
  - {{at: 4, do: [w_1, w_3], line: (follow w_2)}}
  - {{at: 6, do: 'group:crowd', line: '(send w_0 at (round (nth$ 2 (position))))'}}
  - {{at: 7, do: robots, line: '(loop-for-count (?i 40) (send w_1 burst ?i))'}}
""")
    return path


def test_the_number_of_processes_changes_nothing():
    with folder() as out:
        found = {}
        for processes in (1, 2, 4, 20):
            done, summary = experiment_run(out / str(processes), file=crowd(out, processes))
            check(summary, f"no summary: {done.stderr}")
            found[processes] = summary
        first = found[1]
        check(first["mail"]["delivered"] > 20 * 19 * 50, f"little mail: {first['mail']}")
        for processes, summary in found.items():
            check_equal(summary["hash"], first["hash"], f"the run in {processes} processes")
            for key in ("name", "distance_m", "mail_sent", "mail_received", "rule_firings", "final"):
                check_equal([r[key] for r in summary["robots"]],
                            [r[key] for r in first["robots"]], f"{key} in {processes} processes")


def test_threads_of_the_simulator_change_nothing():
    with folder() as out:
        path, hashes = crowd(out, 1, robots=40), {}
        for key in ("", "\nsimulator: {threads: 3}\n"):
            path.write_text(path.read_text() + key)
            done, summary = experiment_run(out / str(len(hashes)), "--duration", "5", file=path)
            check(summary, f"no summary: {done.stderr}")
            hashes[key] = summary["hash"]
        check_equal(len(set(hashes.values())), 1, "hashes")


def test_a_simulator_with_threads_has_all_processors():
    words = ("run", ROOT / "experiments/follow.yaml", "--quiet", "--set")
    for threads in (1, 3):
        with folder() as out, Processes() as processes:
            run = processes.start(MUSTER, *words, f"simulator.threads={threads}", "--duration", "600",
                                  "--out", out / "run", "--domain", new_domain())
            pid = child_of(run, "muster-sim")
            ours = os.sched_getaffinity(0)
            check_equal(len(os.sched_getaffinity(pid)), len(ours) if threads > 1 else 1,
                        f"processors for {threads} threads, of {len(ours)}")


def test_another_seed_is_another_place():
    with folder() as out:
        runs = {}
        for seed in (1, 2):
            words = ("--duration", "0.2", "--seed", seed)
            done, summary = experiment_run(out / str(seed), *words, file=crowd(out, 1, robots=5))
            check(summary, f"no summary: {done.stderr}")
            runs[seed] = [tuple(r["final"].values()) for r in summary["robots"]]
        check(not set(runs[1]) & set(runs[2]), f"the same places: {runs}")


def test_no_room_for_all():
    with folder() as out:
        done, summary = experiment_run(out / "a", file=crowd(out, 1, robots=900))
        check(not summary and done.returncode == 3, f"exit code {done.returncode}")
        check("no free place for robot 'w_" in done.stderr, done.stderr)


def test_more_names_than_fit_into_a_mail():
    names = [f"a_robot_with_a_long_name_{i}" for i in range(50)]
    with folder() as out:
        found = []
        for targets in ("robots", f"[{', '.join(names)}]"):
            path = crowd(out, 2, robots=50)
            text = path.read_text().replace("name: w,", "name: a_robot_with_a_long_name,")
            path.write_text(text[:text.index("observer")] +
                            f"observer:\n  - {{at: 0, do: {targets}, line: (wander)}}\n")
            done, summary = experiment_run(out / "run", "--duration", "1", file=path)
            check(summary, f"no summary: {done.stderr}")
            found.append({r["name"]: r["mail_sent"] for r in summary["robots"]})
        check(min(found[0].values()) > 5, f"a robot that did nothing: {found[0]}")
        check_equal(found[1], found[0], "what the named robots did")


def test_a_crew_lives_until_the_last_is_gone():
    with Processes() as processes:
        domain = new_domain()
        broker_start(processes, domain)
        crew = processes.start(MUSTER, "robot", "w", "--rules", ROOT / "rules/follower.clp",
                               "--count", "3", "--first", "5", "--domain", domain)
        names = {"w_5", "w_6", "w_7"}
        wait_for(lambda: names <= members(domain).keys(), 10, "the crew in the white pages")
        pids = {members(domain)[name]["pid"] for name in names}
        check_equal(len(pids), 1, "processes of the crew")
        done = muster("do", "w_5,w_6,w_7", "(my-name)", "--json", "--domain", domain)
        check(all(name in done.stdout for name in names), f"answers: {done.stdout} {done.stderr}")
        for name in sorted(names):
            check_equal(crew.poll(), None, f"before {name} is disposed of")
            muster("send", name, "now", "--layer", "1", "--performative", "dispose", "--domain", domain)
            wait_for(lambda: members(domain)[name]["state"] == "absent", 10, f"{name} gone")
        check_equal(crew.wait(30), 0, "the exit code of the crew")


def test_a_name_that_is_taken_stops_no_other():
    with Processes() as processes:
        domain = new_domain()
        broker_start(processes, domain)
        one = processes.start(MUSTER, "robot", "w_1", "--rules", ROOT / "rules/follower.clp",
                              "--domain", domain)
        wait_for(lambda: "w_1" in members(domain), 10, "w_1")
        crew = processes.start(MUSTER, "robot", "w", "--rules", ROOT / "rules/follower.clp",
                               "--count", "3", "--domain", domain, stderr=subprocess.PIPE, text=True)
        check_equal(crew.stderr.readline(), "muster robot: the broker refuses the name w_1: "
                    "held by another participant; muster lookup w_1 says where that is\n",
                    "what the crew says")
        wait_for(lambda: {"w_0", "w_2"} <= members(domain).keys(), 10, "the others")
        check_equal(members(domain)["w_1"]["pid"], one.pid, "who bears the name")
        check_equal(crew.poll(), None, "the crew")
        crew.terminate()
        check_equal(crew.wait(30), 6, "its exit code")
