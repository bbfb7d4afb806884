# SPDX-License-Identifier: Apache-2.0
"""Addresses that programs resolve: role, task, near, and one of somebody's own."""
import contextlib
import json
import os
import signal

import pytest

from support import (BUILD, MUSTER, ROOT, Processes, broker_start, check, check_equal,
                     experiment_run, folder, members, muster, new_domain, program, wait_for)

# Every robot says every step to whoever is near that it is there, and prints whom it hears.
RULES = """; SPDX-License-Identifier: Apache-2.0
(defrule call
    (position ?time $?)
    =>
    (bind ?sent (send "near:2.3" here)))
(defrule hear
    ?m <- (mail (from ?from) (content here))
    =>
    (retract ?m)
    (printout t "hears " ?from crlf))
"""


def near_experiment(path):
    """red, blue and green in a line, 2.2 m from one to the next."""
    (path / "near.clp").write_text(RULES)
    robots = "".join(f"  - {{name: {name}, pose: [{x}, 4.5, 0], rules: near.clp}}\n"
                     for name, x in (("red", -2.2), ("blue", 0), ("green", 2.2)))
    file = path / "near.yaml"
    file.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 3\nresolvers: [near, role]\n"
                    f"robots:\n{robots}")
    return file


def heard(done):
    """Who hears whom, of all that the robots have printed."""
    return {line.replace(" hears ", " ") for line in (done.stdout + done.stderr).splitlines()
            if " hears " in line}


NEIGHBOURS = {"red: blue", "blue: red", "blue: green", "green: blue"}


def test_near_in_lock_step_is_the_same_every_time():
    with folder() as out:
        file = near_experiment(out)
        runs = []
        for i in range(2):
            done = muster("run", file, "--out", out / f"run-{i}", "--domain", new_domain())
            check_equal(done.returncode, 0, done.stderr)
            check_equal(heard(done), NEIGHBOURS, "who hears whom")
            runs.append(json.loads((out / f"run-{i}" / "summary.json").read_text()))
        check_equal(runs[0]["hash"], runs[1]["hash"], "the hash")
        check_equal(runs[0]["mail"], runs[1]["mail"], "the mail")
        # 30 steps, of which the last two cannot be heard any more, and the answer takes one.
        check(all(r["mail_sent"] == 30 for r in runs[0]["robots"]), runs[0]["robots"])


def test_near_in_a_free_run():
    with folder() as out:
        done = muster("run", near_experiment(out), "--free", "--duration", 2, "--out", out / "run",
                      "--domain", new_domain())
        check_equal(done.returncode, 0, done.stderr)
        check_equal(heard(done), NEIGHBOURS, "who hears whom")


def observer_experiment(path, target):
    (path / "told.clp").write_text('(deffunction told () (assert (told (gensym*))))\n'
                                   '(defrule told (told ?) => (printout t "is told" crlf))\n')
    robots = "".join(f"  - {{name: {name}, rules: told.clp, groups: [{group}], "
                     f"services: [map role={role}]}}\n"
                     for name, group, role in (("red", "g", "scout"), ("blue", "g", "miner"),
                                               ("green", "h", "scout"), ("yellow", "h", "cook")))
    file = path / "observer.yaml"
    file.write_text(f"world: {ROOT}/worlds/arena.world\nduration: 1\nresolvers: [role]\n"
                    f"robots:\n{robots}observer:\n"
                    f"  - {{at: 0.5, do: {target}, line: (told)}}\n")
    return file


def test_the_observer_commands_groups_and_addresses():
    with folder() as out:
        for target, want in (("'role:scout'", ["green", "red"]), ("'group:g'", ["blue", "red"]),
                             ("[yellow, 'role:miner', blue]", ["blue", "blue", "yellow"])):
            done = muster("run", observer_experiment(out, target), "--out", out / "run",
                          "--domain", new_domain())
            check_equal(done.returncode, 0, done.stderr)
            told = sorted(line.split(":")[0] for line in (done.stdout + done.stderr).splitlines()
                          if "is told" in line)
            check_equal(told, want, f"who is told by {target}")
        done = muster("run", observer_experiment(out, "'role:nobody'"), "--out", out / "run",
                      "--domain", new_domain())
        check_equal(done.returncode, 7, done.stderr)


def test_a_resolver_that_there_is_not():
    with folder() as out:
        file = near_experiment(out)
        file.write_text(file.read_text().replace("[near, role]", "[far]"))
        done = muster("run", file, "--out", out / "run", "--domain", new_domain())
        check_equal(done.returncode, 3, done.stderr)
        check("near.yaml:3:13: expected a scheme of addresses: role, task or near" in done.stderr,
              done.stderr)
        file.write_text(file.read_text().replace("[far]", "[near, near]"))
        done = muster("run", file, "--out", out / "run", "--domain", new_domain())
        check_equal(done.returncode, 3, done.stderr)
        check(f"{file}:3:" in done.stderr, done.stderr)
        file.write_text(file.read_text().replace("[near, near]", "[]"))
        done, summary = experiment_run(out / "none", "--domain", new_domain(), file=file)
        check_equal(done.returncode, 0, done.stderr)
        check(all(r["mail_received"] <= 1 for r in summary["robots"]), summary["robots"])


@contextlib.contextmanager
def scouts(*attributes):
    """A broker and agents that offer something, and note what they hear; gives what they heard."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        broker_start(processes, domain)
        for i, offer in enumerate(attributes):
            processes.start(program("pages_agent"), domain, f"agent{i}", out / f"{i}", offer)

        def said(index):
            path = out / f"{index}"
            return path.read_text() if path.exists() else ""

        for i in range(len(attributes)):
            wait_for(lambda i=i: said(i), 10, f"agent{i} is there")
        yield processes, domain, said


def resolver_start(processes, domain, *words):
    name = f"resolver.{words[-1] if len(words) > 1 else words[0].name}"
    resolver = processes.start(*words, *(["--domain"] if len(words) > 1 else []), domain)
    wait_for(lambda: name in members(domain), 10, f"{name} is there")
    return resolver


def send(domain, to, *words):
    return muster("send", to, *words, "--domain", domain).returncode


def resolves(domain, to, said, index):
    """What is offered may still be under way when a name is there."""
    def arrives():
        return send(domain, to, "knock", to) == 0 and f"mail operator knock {to}" in said(index)

    wait_for(arrives, 10, f"mail to {to} arrives")


def test_roles_and_tasks_on_the_command_line():
    with scouts("role=scout", "role=digger task=map") as (processes, domain, said):
        check_equal(send(domain, "role:scout", "too early"), 7, "nobody resolves it yet")
        resolver_start(processes, domain, MUSTER, "resolver", "role")
        resolver_start(processes, domain, MUSTER, "resolver", "task")
        resolves(domain, "role:scout", said, 0)
        resolves(domain, "task:map", said, 1)
        check_equal(send(domain, "role:scout", "hello"), 0, "mail to a role")
        check_equal(send(domain, "task:map", "draw"), 0, "mail to a task")
        check_equal(send(domain, "role:cook", "nobody is one"), 7, "mail that nobody fits")
        check_equal(send(domain, "near:2", "nobody resolves it"), 7, "another scheme")
        wait_for(lambda: "mail operator hello" in said(0), 10, "the scout has its mail")
        wait_for(lambda: "mail operator draw" in said(1), 10, "the map maker, too")
        check("hello" not in said(1) and "draw" not in said(0), "each has its own alone")


def test_a_resolver_that_sleeps():
    with scouts("role=scout") as (processes, domain, said):
        resolver = resolver_start(processes, domain, MUSTER, "resolver", "role")
        resolves(domain, "role:scout", said, 0)
        resolver.send_signal(signal.SIGSTOP)
        check_equal(send(domain, "role:scout", "hello"), 7, "no answer, or nobody to ask")
        check_equal(send(domain, "agent0", "by name"), 0, "the broker goes on")
        resolver.send_signal(signal.SIGCONT)
        wait_for(lambda: send(domain, "role:scout", "awake") == 0, 10, "it answers again")
        wait_for(lambda: "mail operator awake" in said(0), 10, "mail arrives again")
        check("hello" not in said(0), "what was refused does not arrive later")


@pytest.mark.parametrize("language", ("c", "rules"))
def test_a_resolver_of_ones_own(language):
    with scouts("battery=0.2", "battery=0.8") as (processes, domain, said):
        if language == "c":
            resolver_start(processes, domain, BUILD / "examples" / "battery")
        else:
            processes.start(MUSTER, "agent", "resolver.battery", "--rules", ROOT / "examples/battery.clp",
                            "--domain", domain)
        resolves(domain, "battery:low", said, 0)
        resolves(domain, "battery:1", said, 1)
        check_equal(send(domain, "battery:low", "home"), 0, "mail to who has little left")
        check_equal(send(domain, "battery:0.9", "all"), 0, "mail to both")
        check_equal(send(domain, "battery:x", "none"), 7, "no such address")
        for i in range(2):
            wait_for(lambda i=i: "mail operator all" in said(i), 10, f"agent{i} has its mail")
        check("mail operator home" in said(0) and "home" not in said(1), said(1))


# A resolver in rules, and a customer that always asks for the one with the least to do.
TEAM = """world: {root}/worlds/arena.world
duration: 30
agents:
  - {{name: dispatcher, rules: {root}/rules/least_busy.clp}}
robots:
  - {{name: red, rules: {root}/rules/customer.clp}}
  - {{name: blue, rules: {root}/rules/worker.clp}}
  - {{name: green, rules: {root}/rules/worker.clp}}
{more}"""


def team_run(out, name, more, *words):
    file = out / f"{name}.yaml"
    file.write_text(TEAM.format(root=ROOT, more=more))
    return experiment_run(out / name, "--domain", new_domain(), *words, file=file)


def test_a_resolver_in_rules_is_killed_in_lock_step():
    """With a checkpoint after each step it comes back with all that it has counted, and the run is the
    same.  It dies while the mail waits whose address it is asked about, too."""
    comes_back = "on-crash: restart\ncheckpoint: 0.1\n"
    with folder() as out:
        _, calm = team_run(out, "calm", "")
        done, wild = team_run(out, "wild", comes_back + "chaos:\n  - {at: 5, kill: dispatcher}\n"
                              "  - {at: 10, kill: dispatcher}\n  - {at: 10.1, kill: dispatcher}\n")
        check_equal(done.returncode, 0, done.stderr)
        check_equal([(r["process"], r["count"]) for r in wild["restarts"]], [("dispatcher", 3)], "who came back")
        check_equal(wild["hash"], calm["hash"], "the hash")
        done, lost = team_run(out, "lost", comes_back.replace("0.1", "0") + "chaos:\n  - {at: 5, kill: dispatcher}\n")
        check_equal(done.returncode, 0, done.stderr)
        check("nobody for" not in done.stdout + done.stderr, "it has called the roll, and resolves again")
        check(lost["hash"] != calm["hash"], "what it had counted was lost")


def test_a_resolver_process_is_killed_in_lock_step():
    """It knows nothing that it is not told anew: what was asked while it was away it answers then."""
    with folder() as out, Processes() as processes:
        file = near_experiment(out)
        file.write_text(file.read_text().replace("duration: 3", "duration: 30").replace("[near, role]", "[near]"))
        _, calm = experiment_run(out / "calm", "--domain", new_domain(), file=file)
        domain = new_domain()
        run = processes.start(MUSTER, "run", file, "--quiet", "--rate", "10", "--set", "on-crash=restart",
                              "--out", out / "wild", "--domain", domain)
        before = 0
        for _ in range(2):
            wait_for(lambda: members(domain).get("resolver.near", {}).get("pid", before) != before, 10, "a resolver")
            before = members(domain)["resolver.near"]["pid"]
            os.kill(before, signal.SIGKILL)
        check_equal(run.wait(60), 0, "the run")
        wild = json.loads((out / "wild" / "summary.json").read_text())
        check_equal([(r["process"], r["count"]) for r in wild["restarts"]], [("resolver.near", 2)], "who came back")
        check_equal(wild["hash"], calm["hash"], "the hash")


@pytest.mark.parametrize("more", ["on-crash: restart\nchaos:\n  - {at: 1, kill: resolver.near}\n",
                                  "chaos:\n  - {at: 1, kill: resolver.near, wall_s: 1}\n"
                                  "  - {at: 2, stop: resolver.near, wall_s: 1}\n"
                                  "  - {at: 2.5, cut: [resolver.near, broker], wall_s: 1}\n"])
def test_chaos_strikes_a_resolver_and_the_hash_stays(more):
    with folder() as out:
        file = near_experiment(out)
        file.write_text(file.read_text() + 'expect:\n  - {sequence: ["red told here to near:2.3"]}\n')
        _, calm = experiment_run(out / "calm", "--domain", new_domain(), file=file)
        file.write_text(file.read_text() + more)
        done, wild = experiment_run(out / "wild", "--domain", new_domain(), file=file)
        check_equal(done.returncode, 0, done.stderr)
        check(all(c["done"] for c in wild["chaos"]), wild["chaos"])
        check_equal(wild["hash"], calm["hash"], "the hash")


def test_chaos_on_a_resolver_in_free_running():
    """While it is away mail to its addresses is refused; then it answers again."""
    with folder() as out:
        file = near_experiment(out)
        file.write_text(file.read_text().replace("duration: 3", "duration: 11") +
                        "chaos:\n  - {at: 2, kill: resolver.near, for: 2}\n")
        done, summary = experiment_run(out / "free", "--free", "--domain", new_domain(), file=file)
        check_equal(done.returncode, 0, done.stderr)
        check(summary["mail"]["refused"] > 0, summary["mail"])
        received = [r["mail_received"] for r in summary["robots"]]
        check(all(r > 30 for r in received), f"before, at most 20, and after: {received}")


def test_chaos_on_a_resolver_that_there_is_not():
    with folder() as out:
        file = near_experiment(out)
        file.write_text(file.read_text() + "chaos:\n  - {at: 1, kill: resolver.task}\n")
        done = muster("run", file, "--out", out / "run", "--domain", new_domain())
        check_equal(done.returncode, 3, done.stderr)
        check("no part 'resolver.task' in this run" in done.stderr and "resolver.SCHEME" in done.stderr, done.stderr)


DESK = """
(defglobal ?*given* = 0)
(deffunction desk (?rest ?sender)
  (switch ?rest
    (case next then (bind ?*given* (+ ?*given* 1)) (nth$ ?*given* (create$ blue green blue green)))
    (case both then (create$ blue green))
    (case nobody then (create$))
    (case wrong then (lookup ?*given*))
    (default FALSE)))
(on-resolve desk desk)
"""


def test_a_resolver_in_rules_in_free_running():
    """Its answers, its mistakes, its death, its next life, and a second one in its place."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        (out / "desk.clp").write_text(DESK)
        broker_start(processes, domain)
        for name in ("blue", "green"):
            processes.start(MUSTER, "robot", name, "--rules", ROOT / "rules/follower.clp", "--domain", domain)
            wait_for(lambda name=name: name in members(domain), 10, name)

        def desk(name, *words):
            started = processes.start(MUSTER, "robot", name, "--rules", out / "desk.clp", "--domain", domain,
                                      "--checkpoint", "0.1", "--folder", out, *words)
            wait_for(lambda: members(domain).get(name, {}).get("pid") == started.pid, 10, name)
            wait_for(lambda: send(domain, "desk:both", "knock") == 0, 10, "its offer is there")
            return started

        first = desk("desk_a")
        for address, code in (("next", 0), ("next", 0), ("next", 0), ("nobody", 7), ("wrong", 7), ("elsewhere", 7)):
            check_equal(send(domain, f"desk:{address}", "hello"), code, address)
        check_equal(muster("do", "desk_a", "?*given*", "--domain", domain).stdout.split()[-1], "3", "it counts")
        wait_for(lambda: (out / "desk_a.capsule").exists(), 10, "a checkpoint")
        muster("do", "desk_a", "(assert (later))", "--domain", domain)
        wait_for(lambda: "later" in (out / "desk_a.capsule").read_text(), 10, "the checkpoint has it")
        first.kill()
        wait_for(lambda: send(domain, "desk:both", "hello") == 7, 10, "nobody resolves it")
        second = desk("desk_a", "--restore")
        check_equal(muster("do", "desk_a", "?*given*", "--domain", domain).stdout.split()[-1], "3",
                    "what it had counted")
        desk("desk_b")
        second.kill()
        wait_for(lambda: send(domain, "desk:next", "hello") == 0, 10, "the second one answers")
        check_equal(muster("do", "desk_b", "?*given*", "--domain", domain).stdout.split()[-1], "1", "it is asked now")
