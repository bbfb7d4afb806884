# SPDX-License-Identifier: Apache-2.0
"""Agents that are launched, move, are cloned and disposed of; and what dies on the way."""
import contextlib
import signal
import subprocess
import time

from support import (COUNTS, MUSTER, ROOT, SENDS, Processes, broker_start, check, check_equal,
                     experiment_run, folder, members, muster, new_domain, wait_for)

class Team:
    """A broker, two hosts, a simulator with the body of red, and red in a process of its own."""

    def __init__(self, processes, out, bodies=("red",)):
        self.processes, self.out, self.domain = processes, out, new_domain()
        self.broker = broker_start(processes, self.domain)
        self.hosts = {name: self.host_start(name) for name in ("north", "south")}
        robots = [word for name in bodies for word in ("--robots", name)]
        if bodies:
            processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", *robots, "--free",
                            "--domain", self.domain)

    def host_start(self, name, *words):
        host = self.processes.start(MUSTER, "host", name, "--domain", self.domain, *words)
        wait_for(lambda: name in members(self.domain), 10, f"the host {name}")
        return host

    def robot_start(self, name, rules='(extends "follower.clp")'):
        path = self.out / f"{name}.clp"
        path.write_text(rules)
        robot = self.processes.start(MUSTER, "robot", name, "--rules", path, "--domain", self.domain)
        wait_for(lambda: name in members(self.domain), 10, name)
        return robot

    def muster(self, *words):
        return muster(*words, "--domain", self.domain)

    def done(self, *words):
        done = self.muster(*words)
        check_equal(done.returncode, 0, f"muster {' '.join(map(str, words))}: {done.stderr}")
        return done.stdout

    def ask(self, name, line):
        """What a robot prints, without its name."""
        return self.done("do", name, line).split(": ", 1)[1].strip()

    def place_of(self, name):
        """The name of the host in whose process an agent lives; None: no host's."""
        pages = members(self.domain)
        if name not in pages or pages[name]["state"] == "absent":
            return None
        pids = {pages[host]["pid"]: host for host in self.hosts if host in pages}
        place = pids.get(pages[name]["pid"], "elsewhere")
        check_equal(pages[name]["host"] or "elsewhere", place, "the host in the pages")
        return place

    def set_out(self, name, host, *words):
        """Sends an agent to a host that takes nothing in.  When this is back the agent is on its way, the broker
        has its capsule, and the host is stopped and not missed yet.  It would be within a second: on a busy
        machine that takes several tries.  @return the command that waits for the end of the move"""
        for _ in range(20):
            self.hosts[host].send_signal(signal.SIGSTOP)
            move = self.begin("move", name, host, *words)
            if self.is_on_its_way(name, host, move):
                return move
            move.communicate(timeout=60)
            self.hosts[host].send_signal(signal.SIGCONT)
            wait_for(lambda: members(self.domain)[host]["state"] == "running", 10, f"{host} again")
            wait_for(lambda: members(self.domain)[name]["state"] != "moving", 10, f"{name} again")
        raise AssertionError(f"{name} never was on its way before {host} was missed")

    def is_on_its_way(self, name, host, move):
        """Waits until it is, and a moment longer: the pieces of the capsule are at the broker then."""
        def look():
            pages = members(self.domain)
            return pages[name]["state"] == "moving" and any(n.startswith("envoy.") for n in pages)

        wait_for(lambda: look() or move.poll() is not None, 20, f"{name} on its way")
        time.sleep(0.1)
        return look() and members(self.domain)[host]["state"] == "running"

    def begin(self, *words):
        """The same, without waiting for its end."""
        return self.processes.start(MUSTER, *words, "--domain", self.domain, stdout=subprocess.PIPE,
                                    stderr=subprocess.PIPE, text=True)


@contextlib.contextmanager
def team(**kwargs):
    with folder() as out, Processes() as processes:
        yield Team(processes, out, **kwargs)


def test_a_robot_moves_with_all_that_it_knows():
    with team() as t:
        robot = t.robot_start("red", '(extends "follower.clp")'
                                     "(defrule come (event on-arrive) (never) =>)")
        t.done("start", "red")
        t.done("do", "red", "(wander)")
        t.done("do", "red", "(bind ?*mate* green)")
        t.done("do", "red", '(assert (kept "a b" 0.1))')
        t.done("group", "join", "scouts", "--as", "red")
        wait_for(lambda: "(position" in t.ask("red", "(facts)"), 10, "its senses")
        before = float(t.ask("red", "(nth$ 1 (position))"))
        for host in ("north", "south", "north"):
            check_equal(t.done("move", "red", host), f"red at {host}\n", "the answer")
            check_equal(t.place_of("red"), host, "its platform")
            check_equal(t.ask("red", "(lookup red)"), f"(red robot running {host})", "to rules")
            check_equal(t.ask("red", "(nth$ 4 (lookup operator))"), '""', "who lives on none")
            check_equal(members(t.domain)["red"]["state"], "running", "its state")
            check_equal(t.ask("red", "?*mate*"), "green", "a global")
            check('(kept "a b" 0.1)' in t.ask("red", "(facts)"), "a fact is lost")
            wait_for(lambda: "(event on-arrive)" in t.ask("red", "(facts)"), 10,
                     "the event of its arrival, in its first step here")
        check_equal(robot.wait(30), 0, "the process that it left")
        check("red" in t.done("group", "members", "scouts").split(), "it is no longer in its group")
        wait_for(lambda: float(t.ask("red", "(nth$ 1 (position))")) > before + 2, 10, "new senses")
        x, y = (float(v) for v in t.ask("red", "(subseq$ (position) 2 3)").strip("()").split())
        wait_for(lambda: t.ask("red", f"(> (distance {x} {y} (nth$ 2 (position))"
                               " (nth$ 3 (position))) 100)") == "TRUE", 20, "that it drives on")


def test_mail_on_the_way_arrives_in_order_and_once():
    with team(bodies=("red", "blue")) as t:
        t.robot_start("red", COUNTS)
        t.robot_start("blue", SENDS)
        t.done("start", "red,blue")
        wait_for(lambda: int(t.ask("red", "?*last*")) > 3, 10, "the first mail")
        for host in ("north", "south", "north", "south", "north", "south"):
            t.done("move", "red", host)
        sent = int(t.ask("blue", "?*n*"))
        wait_for(lambda: int(t.ask("red", "?*last*")) > sent, 10, "all mail")
        check_equal(t.ask("red", "?*wrong*"), "0", "mails out of order")


def test_rules_move_clone_and_dispose():
    with team(bodies=("red", "green")) as t:
        rules = ("(defrule go (declare (salience -1)) (never) =>)"
                 "(deffacts f (x 1))")
        t.robot_start("red", rules)
        check_equal(t.ask("red", "(moveTo nowhere)"), "TRUE", "the wish")
        wait_for(lambda: "(event refused moveTo nowhere unknown-host)" in t.ask("red", "(facts)"), 10,
                 "the refusal")
        t.ask("red", "(moveTo north)")
        wait_for(lambda: t.place_of("red") == "north", 10, "its platform")
        t.ask("red", "(clone green)")
        wait_for(lambda: t.place_of("green") == "north", 10, "the clone")
        check_equal(t.ask("green", "?*my-name*"), "green", "the clone's name")
        wait_for(lambda: "(event on-clone)" in t.ask("green", "(facts)"), 10, "the clone's event")
        check_equal(t.done("clone", "red", "rosa", "south"), "rosa at south\n", "the answer")
        check_equal(t.place_of("rosa"), "south", "the second clone")
        t.done("send", "red", "south", "--layer", 1, "--performative", "dispatch", "--wait", 10)
        check_equal(t.place_of("red"), "south", "who was asked to go")
        t.done("send", "red", "north", "--layer", 1, "--performative", "retract", "--wait", 10)
        check_equal(t.place_of("red"), "north", "who was called back")
        t.ask("green", "(dispose)")
        wait_for(lambda: t.place_of("green") is None, 10, "the end of green")
        t.done("dispose", "rosa")
        wait_for(lambda: t.place_of("rosa") is None, 10, "the end of rosa")
        check_equal(t.place_of("red"), "north", "who was copied")


def test_rules_may_refuse_to_go():
    """A mail of layer 1 is a request; a handler of the rules comes before what a robot does by itself."""
    with team(bodies=()) as t:
        t.robot_start("red", """
            (deffunction granted (?id ?from ?performative ?content)
              (if (eq ?performative dispatch) then (reply ?id never) else FALSE))
            (on-layer 1 granted)""")
        done = t.muster("send", "red", "south", "--layer", 1, "--performative", "dispatch", "--wait", 10)
        check("never" in done.stdout + done.stderr, f"its answer: {done.stdout} {done.stderr}")
        t.done("send", "red", "ruby", "south", "--layer", 1, "--performative", "clone", "--wait", 10)
        check_equal((t.place_of("red"), t.place_of("ruby")), ("elsewhere", "south"), "who went")


def test_a_host_that_is_disposed_of_ends_with_its_agents():
    """They do not move first; what it has written stays."""
    with team(bodies=()) as t:
        store = t.out / "store"
        store.mkdir()
        t.hosts["east"] = t.host_start("east", "--checkpoint", "60", "--folder", store)
        (t.out / "red.clp").write_text("(deffacts f (kept 1.5))")
        t.done("launch", "red", "east", "--rules", t.out / "red.clp", "--quiet")
        wait_for(lambda: (store / "red.capsule").exists(), 10, "a checkpoint")
        t.done("dispose", "east")
        check_equal(t.hosts["east"].wait(10), 0, "the host's end")
        check_equal(t.place_of("red"), None, "where red lives")
        check((store / "red.capsule").exists(), "its file has gone")
        t.hosts["east"] = t.host_start("east", "--restore", "--folder", store)
        wait_for(lambda: t.place_of("red") == "east", 10, "red again")
        check("(kept 1.5)" in t.ask("red", "(facts)"), "a fact")


def test_launch():
    with team(bodies=()) as t:
        path = t.out / "big.clp"
        path.write_text('(extends "follower.clp")\n' + "".join(
            f"(defrule r{i} (never {i} \u00e4) => (printout t \"{'x' * 100}\" crlf))\n"
            for i in range(400)) + '(deffacts f (launched well)) (defglobal ?*place* = 0)\n')
        for name in ("red", "blue"):
            check_equal(t.done("launch", name, "north", "--rules", path, "--quiet"),
                        f"north: {name} at north\n", "the answer")
        check_equal(members(t.domain)["red"]["state"], "standby", "its state")
        check("(launched well)" in t.ask("red", "(facts)"), "its facts")
        again = t.muster("launch", "red", "south", "--rules", path)
        check_equal((again.returncode, "name-taken" in again.stdout + again.stderr), (6, True),
                    f"a second red: {again.stdout} {again.stderr}")
        t.done("launch", "green", "north", "--rules", path, "--global", "mate=red", "--global",
               'place="a b"', "--group", "scouts", "--group", "all_green", "--quiet")
        check_equal(t.ask("green", "?*mate*"), "red", "a global")
        check_equal(t.ask("green", "?*place*"), '"a b"', "a text")
        for group in ("scouts", "all_green"):
            wait_for(lambda g=group: "green" in t.muster("group", "members", g).stdout.split(), 5,
                     f"green in {group}")
        t.done("dispose", "green")
        for words, why in ((("--global", "nothing=1"), "no such global"),
                           (("--global", "mate"), "NAME=VALUE"), (("--group", "a b"), "a group")):
            wrong = t.muster("launch", "pink", "south", "--rules", path, *words)
            check(wrong.returncode in (2, 8) and why in wrong.stdout + wrong.stderr,
                  f"{words}: {wrong.stdout} {wrong.stderr}")
        (t.out / "beside.clp").write_text('(defglobal ?*place* = 1) ; the place')
        (t.out / "between.clp").write_text('(extends "beside.clp")')
        path.write_text('; (extends "none.clp") "\n(extends\n "between.clp")(extends "follower.clp")'
                        '(deffacts f "(extends \\"none.clp\\")" (place ?*place*))')
        t.done("launch", "pink", "north", "--rules", path, "--quiet")
        check("(place 1)" in t.ask("pink", "(facts)"), "a fact of two files")
        check("(goal stay)" in t.ask("pink", "(facts)"), "a fact of the library's")
        t.done("dispose", "pink")
        (t.out / "beside.clp").write_text('(extends "between.clp")')
        wrong = t.muster("launch", "pink", "north", "--rules", path)
        check_equal((wrong.returncode, "more than 16 files deep" in wrong.stderr), (3, True),
                    wrong.stderr)
        path.write_text("; " + "x" * 500000 + "\n" + '(extends "big2.clp")' * 4)
        (t.out / "big2.clp").write_text("; " + "x" * 10000)
        wrong = t.muster("launch", "pink", "north", "--rules", path)
        check_equal((wrong.returncode, "at most 512 KiB" in wrong.stderr), (3, True), wrong.stderr)
        path.write_text("(defrule broken (a) => (nonsense))")
        wrong = t.muster("launch", "green", "south", "--rules", path)
        check(wrong.returncode == 8 and "nonsense" in wrong.stdout + wrong.stderr,
              f"broken rules: {wrong.stdout} {wrong.stderr}")
        t.done("move", "red", "south")
        check_equal(t.place_of("red"), "south", "its platform")
        path.write_bytes(b"; \xff\xfe")
        for rules, why in ((path, "in UTF-8"), (t.out, "directory")):
            wrong = t.muster("launch", "green", "south", "--rules", rules)
            check_equal((wrong.returncode, why in wrong.stderr), (3, True), wrong.stderr)
        path.write_text("")
        wrong = t.muster("launch", "green", "red", "--rules", path)
        check_equal((wrong.returncode, wrong.stdout + wrong.stderr),
                    (6, "muster: red refuses: launch unsupported; it is no agent that can be told "
                         "so\n"), "red is no host")


def test_names_that_nobody_can_have():
    with team(bodies=()) as t:
        t.robot_start("red")
        for name in ("a b", "", "2x", "../x", "all", "broker.x", "x" * 32):
            for words in (("move", "red", name), ("clone", "red", name),
                          ("clone", "red", "ruby", name)):
                done = t.muster(*words)
                check_equal((done.returncode, "cannot be the name" in done.stderr), (2, True),
                            f"{words}: {done.stderr}")
        check_equal(t.muster("move", "red", "north", "south").returncode, 2, "two hosts")
        done = t.muster("move", "north", "south")
        check_equal((done.returncode, "move unsupported" in done.stderr), (6, True),
                    done.stderr)
        check("ruby" not in members(t.domain), "a clone")


def test_a_host_refuses():
    with team(bodies=()) as t:
        t.robot_start("red")
        t.hosts["small"] = t.host_start("small", "--bytes", "2000")
        t.hosts["choosy"] = t.host_start("choosy", "--take", "w_*", "--take", "blue")
        t.hosts["tight"] = t.host_start("tight", "--agents", "1")
        check_equal(t.done("clone", "red", "w_1", "choosy"), "w_1 at choosy\n", "a welcome name")
        check_equal(t.done("clone", "red", "one", "tight"), "one at tight\n", "a place")
        for host, why in (("small", "too-large"), ("choosy", "not-welcome"), ("tight", "full"),
                          ("nowhere", "unknown-host"), ("w_1", "unknown-host")):
            done = t.muster("move", "red", host)
            check_equal((done.returncode, why in done.stderr), (8, True), f"{host}: {done.stderr}")
        done = t.muster("clone", "red", "w_1", "choosy")
        check_equal((done.returncode, "name-taken" in done.stderr), (6, True), done.stderr)
        check_equal(members(t.domain)["red"]["state"], "standby", "red after all that")
        check_equal(t.ask("red", "(my-name)"), "red", "its answer")
        t.ask("red", "(defclass C (is-a USER) (role concrete))")
        t.ask("red", "(make-instance c of C)")
        done = t.muster("move", "red", "north")
        check_equal((done.returncode, "instances" in done.stderr), (8, True), done.stderr)
        done = t.muster("move", "red", "north", "--as", "blue")
        check_equal(done.returncode, 6, f"who may not direct red: {done.stderr}")


def test_moves_in_lock_step():
    """By rules and from the command line; the clock waits, and no step is lost."""
    with team(bodies=()) as t:
        t.robot_start("red", STEPS + """
(defrule away (position ?t $?) (test (= ?t 1.0)) => (moveTo north))""")
        sim = t.processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots", "red",
                                "--hosts", "2", "--rate", "2", "--duration", "12", "--domain", t.domain)
        t.done("start", "red")
        wait_for(lambda: t.place_of("red") == "north", 15, "red at north")
        check_equal(t.done("move", "red", "south"), "red at south\n", "the answer")
        check_equal(t.place_of("red"), "south", "its platform")
        check_equal(members(t.domain)["red"]["state"], "running", "its state")
        check_equal(steps_missed(t, "red"), "0", "steps that its rules have not had")
        check_equal(sim.wait(60), 0, "the run")


FOLLOWERS = """name: %s
world: {root}/worlds/arena.world
duration: 15
hosts: [north, south]
robots:
  - {{name: red, host: north, rules: {root}/rules/follower.clp, globals: {{mate: blue}}}}
  - {{name: blue, rules: {root}/rules/follower.clp}}
  - {{name: green, rules: {root}/rules/follower.clp}}
observer:
  - {{at: 0, do: red, line: "(wander)"}}
  - {{at: 0, do: blue, line: "(follow red)"}}
  - {{at: 0, do: green, line: "(follow blue)"}}
  - {{at: 9, do: red, line: "(follow green)"}}
""".format(root=ROOT)


def test_no_hash_tells_who_lives_where():
    """Two robots move, one from a host and one from a process of its own, twice in the same step."""
    with folder() as out:
        hashes = {}
        for name, moves in (("still", ""), ("moves", """
  - {at: 3.1, do: red, move: south}
  - {at: 5, do: [red, blue], move: north}
  - {at: 8.9, do: [green, blue], move: south}
  - {at: 12, do: blue, move: north}
""")):
            file = out / f"{name}.yaml"
            file.write_text(FOLLOWERS % name + moves)
            done, summary = experiment_run(out / name, "--domain", new_domain(), file=file)
            check_equal((done.returncode, done.stderr), (0, ""), f"the run {name}")
            hashes[name] = summary["hash"]
            check_equal(summary["mail"]["duplicated"] + summary["mail"]["lost"], 0, "lost or twice")
        check_equal(hashes["moves"], hashes["still"], "the hash")


STEPS = """
(defglobal ?*steps* = 0 ?*first* = -1)
(defrule count (position ?t $?) => (bind ?*steps* (+ ?*steps* 1))
  (if (< ?*first* 0) then (bind ?*first* ?t)))
"""


def steps_missed(t, name):
    return t.ask(name, "(- (integer (+ 1.5 (* 10 (- (now) ?*first*)))) ?*steps*)")


def test_the_target_dies_in_lock_step():
    """The clock waits for it, and the source goes on in the next step; then the other host dies, with
    the robot that came to it gone on, and the run ends well all the same."""
    with team(bodies=()) as t:
        t.robot_start("red", STEPS)
        sim = t.processes.start(MUSTER, "sim", ROOT / "worlds/arena.world", "--robots", "red",
                                "--hosts", "2", "--rate", "2", "--duration", "16", "--domain", t.domain)
        t.done("start", "red")
        wait_for(lambda: int(t.ask("red", "?*steps*")) > 3, 15, "a run")
        t.hosts["north"].send_signal(signal.SIGSTOP)
        move = t.begin("move", "red", "north")
        time.sleep(0.5)
        t.hosts["north"].kill()
        out, err = move.communicate(timeout=60)
        check_equal((move.returncode, "host-" in err), (8, True), f"{out} {err}")
        check_equal(t.place_of("red"), "elsewhere", "where it stays")
        check_equal(steps_missed(t, "red"), "0", "steps that were lost")
        t.done("move", "red", "south")
        check_equal(t.place_of("red"), "south", "its platform")
        check_equal(steps_missed(t, "red"), "0", "steps that were lost")
        check_equal(sim.wait(60), 0, "the run")


def test_who_lost_both_comes_back_from_the_broker():
    """Source and target die in the middle; a host that restores is handed the capsule."""
    with team(bodies=()) as t:
        robot = t.robot_start("red", '(defglobal ?*n* = 0)(deffacts f (kept "a b"))')
        t.ask("red", "(bind ?*n* 17)")
        move = t.set_out("red", "north")
        robot.kill()
        t.hosts["north"].kill()
        move.kill()
        wait_for(lambda: members(t.domain)["red"]["state"] == "absent", 10, "the end of red")
        t.done("send", "red", "waits", "--quiet", "--wait", 0)
        t.hosts["east"] = t.host_start("east", "--restore")
        wait_for(lambda: t.place_of("red") == "east", 10, "red again")
        check_equal(t.ask("red", "?*n*"), "17", "a global")
        facts = t.ask("red", "(facts)")
        check('(kept "a b")' in facts, "a fact")
        wait_for(lambda: "(message waits)" in t.ask("red", "(facts)"), 5, "mail that it was sent")
        check_equal(living(t, "red"), "east", "where it lives")


def test_a_run_goes_on_without_who_is_disposed_of():
    """Also when a process has no other robot; and twice the same."""
    with folder() as out:
        (out / "t.yaml").write_text(
            f"name: t\nworld: {ROOT}/worlds/arena.world\nduration: 6\nrobots:\n"
            f"  - {{name: red, rules: {ROOT}/rules/follower.clp}}\n"
            f"  - {{name: blue, rules: {ROOT}/rules/follower.clp}}\n"
            "observer:\n"
            "  - {at: 1, do: robots, line: \"(wander)\"}\n"
            "  - {at: 3, do: red, line: \"(dispose)\"}\n")
        hashes = []
        for i in range(2):
            done, summary = experiment_run(out / str(i), "--domain", new_domain(), file=out / "t.yaml")
            check_equal(done.returncode, 0, f"the run: {done.stderr}")
            check_equal(summary["sim_time_s"], 6.0, "how long it was")
            red, blue = sorted(summary["robots"], key=lambda r: r["name"], reverse=True)
            check(0 < red["rule_firings"] < blue["rule_firings"], "red has had its end")
            hashes.append(summary["hash"])
        check_equal(hashes[0], hashes[1], "the hash")


def test_robots_leave_a_run_that_is_free():
    """They move to a host, or end; the process that stays behind empty is no crash."""
    domain = new_domain()
    with folder() as out, Processes() as processes:
        run = processes.start(MUSTER, "run", ROOT / "experiments/patrol.yaml", "--free", "--domain",
                              domain, "--duration", "6", "--out", out / "run",
                              stderr=subprocess.PIPE, text=True)
        wait_for(lambda: muster("console", "observer", "-c", "(agents)", "--domain",
                                domain).returncode == 0, 15, "a run")
        processes.start(MUSTER, "host", "north", "--domain", domain)
        wait_for(lambda: "north" in members(domain), 10, "a host")
        was = members(domain)["red"]["pid"]
        done = muster("move", "red", "north", "--domain", domain)
        check_equal((done.returncode, done.stdout), (0, "red at north\n"), done.stderr)
        check(members(domain)["red"]["pid"] != was, "red is elsewhere")
        error = run.communicate(timeout=30)[1]
        check_equal(run.returncode, 0, f"the run: {error}")


# --- several at once ---------------------------------------------------------------------------

FIVE = [f"w_{i}" for i in range(5)]


def test_all_agents_of_a_host_move_at_once():
    """By five commands at the same time, by a rule that fires in each, and to a host at another broker, to
    which they go in pieces; then five are cloned there."""
    with team() as t:
        t.processes.start(MUSTER, "broker", "other", "--domain", t.domain)
        t.hosts["far"] = t.host_start("far", "--broker", "other")
        t.robot_start("red")  # without whom there are no steps
        rules = t.out / "w.clp"
        rules.write_text("(defrule go (message go ?host) => (moveTo ?host))\n"
                         "(defrule refused (event refused $?) => (assert (wrong)))\n")
        for name in FIVE:
            t.done("launch", name, "north", "--rules", rules, "--start", "--quiet")
        all_at(t, "south", [t.begin("move", name, "south") for name in FIVE])
        t.done("broadcast", "go", "north", "--quiet", "--wait", 0)
        all_at(t, "north", [])
        all_at(t, "far", [t.begin("move", name, "far") for name in FIVE])
        done_all(t.begin("clone", name, f"c_{name}", "far") for name in FIVE)
        all_at(t, "south", [t.begin("move", name, "south") for name in FIVE])
        for name in FIVE:
            check("(wrong)" not in t.ask(name, "(facts)"), f"{name} was refused")
            check_equal(t.place_of(f"c_{name}"), "far", f"the clone of {name}")


def done_all(commands):
    for command in commands:
        out, err = command.communicate(timeout=30)
        check_equal(command.returncode, 0, f"{out} {err}")


def all_at(t, host, commands):
    done_all(commands)
    for name in FIVE:
        wait_for(lambda n=name: t.place_of(n) == host, 20, f"{name} at {host}")


# They say so when their own clone, or their move, is refused; all of them want to go in the same steps.
CREW_RULES = """
(defrule away (position ?t $?) (test (= ?t 1.0)) => (moveTo south))
(defrule copied (position ?t $?) (test (and (= ?t 2.0) (not (str-index "c_" (my-name))))) =>
  (clone (sym-cat c_ (my-name)) north))
(defrule back (position ?t $?) (test (= ?t 3.0)) => (moveTo north))
(defrule beat (position $?) => (broadcast beat (my-name)))
(defrule refused (event refused $?what) => (printout t "refused " ?what crlf))
"""


def test_who_shares_a_process_may_move_in_the_same_step():
    """Eight robots, in one process or in eight, that move, are cloned and move on, all in the same steps, are
    one and the same run."""
    with folder() as out:
        (out / "w.clp").write_text(CREW_RULES)
        hashes = set()
        for processes in (1, 8):
            (out / "t.yaml").write_text(
                f"name: t\nworld: {ROOT}/worlds/arena.world\nduration: 4\nhosts: [north, south]\nrobots:\n"
                f"  - {{name: w, rules: w.clp, count: 8, processes: {processes}, body: pioneer, place: random}}\n")
            done, summary = experiment_run(out / str(processes), "--domain", new_domain(), file=out / "t.yaml")
            check_equal((done.returncode, "refused" in done.stdout + done.stderr), (0, False),
                        f"{done.stdout} {done.stderr}")
            check_equal((summary["mail"]["lost"], summary["mail"]["duplicated"]), (0, 0), "mail")
            hashes.add(summary["hash"])
        check_equal(len(hashes), 1, "hashes")


# --- what dies on the way ----------------------------------------------------------------------


def living(t, name):
    """Where an agent answers, and only there."""
    wait_for(lambda: members(t.domain)[name]["state"] not in ("absent", "moving"), 20,
             f"{name} lives")
    check_equal(t.ask(name, "(my-name)"), name, "its answer")
    return t.place_of(name)


def test_the_target_dies_before_its_word():
    with team(bodies=()) as t:
        t.robot_start("red")
        move = t.set_out("red", "north")
        t.hosts["north"].kill()
        out, err = move.communicate(timeout=60)
        check_equal((move.returncode, "host-absent" in err), (8, True), f"{out} {err}")
        check_equal(living(t, "red"), "elsewhere", "where it stays")
        check_equal(members(t.domain)["red"]["state"], "standby", "its state")
        t.done("move", "red", "south")


def test_the_source_dies_before_its_name_is_free():
    """The host has the capsule whole: it is the agent, when the broker has lost the other."""
    with team(bodies=()) as t:
        robot = t.robot_start("red", '(deffacts f (x 1))')
        move = t.set_out("red", "north")
        robot.kill()
        move.kill()
        t.hosts["north"].send_signal(signal.SIGCONT)
        check_equal(living(t, "red"), "north", "where it lives")
        check("(x 1)" in t.ask("red", "(facts)"), "its facts")


def test_the_broker_dies_on_the_way():
    with team(bodies=()) as t:
        t.robot_start("red")
        move = t.set_out("red", "north", "--wait", 5)
        t.broker.kill()
        t.broker.wait()
        t.broker = broker_start(t.processes, t.domain)
        t.hosts["north"].send_signal(signal.SIGCONT)
        move.communicate(timeout=40)
        place = living(t, "red")
        check(place in ("north", "elsewhere"), f"red at {place}")
        wait_for(lambda: members(t.domain)["red"]["state"] == "standby", 20, "its state")
        t.done("move", "red", "south")
        check_equal(living(t, "red"), "south", "where it goes next")


def test_kill_at_any_moment():
    """After kill -9 of either platform at any moment there is never more than one, and one when the
    platform that has it lives."""
    with team(bodies=()) as t:
        t.done("launch", "red", "north", "--rules", ROOT / "rules/follower.clp")
        for number, delay_ms in enumerate((0, 10, 20, 40, 80, 15)):
            source = t.place_of("red")
            target = "south" if source == "north" else "north"
            victim = (source, target)[number % 2]
            move = t.begin("move", "red", target, "--wait", 5)
            time.sleep(delay_ms / 1000)
            t.hosts[victim].kill()
            t.hosts[victim].wait()
            move.communicate(timeout=40)
            wait_for(lambda: members(t.domain)[victim]["state"] == "absent", 10, f"{victim} gone")
            settled(t, victim == target)
            place = t.place_of("red")
            check(place != "elsewhere", f"{number} {victim}: {members(t.domain)}")
            check(place != victim, f"red on a dead platform after {delay_ms} ms")
            t.hosts[victim] = t.host_start(victim)
            if place is None:
                t.done("launch", "red", "north", "--rules", ROOT / "rules/follower.clp")
            check_equal(t.ask("red", "(my-name)"), "red", "its answer")


def settled(t, may_return):
    """Until nothing is on its way; a source may yet take back what it let go."""
    def still():
        state = members(t.domain)["red"]["state"]
        return state != "moving" and state
    seen = wait_for(still, 20, "red's state")
    until = time.monotonic() + (8 if may_return else 2)
    while seen == "absent" and time.monotonic() < until:
        seen = still() or "absent"
        time.sleep(0.1)


# --- several brokers ----------------------------------------------------------------------------


def test_a_robot_moves_to_a_host_at_another_broker():
    """And back; mail that others send it at either broker waits for it, and comes once."""
    with team(bodies=()) as t:
        t.processes.start(MUSTER, "broker", "other", "--domain", t.domain)
        t.hosts["far"] = t.host_start("far", "--broker", "other")
        t.robot_start("red", '(defglobal ?*n* = 0)(deffacts f (kept "a b"))')
        t.ask("red", "(bind ?*n* 17)")
        for host in ("far", "north", "far"):
            check_equal(t.done("move", "red", host), f"red at {host}\n", "the answer")
            check_equal(living(t, "red"), host, "where it lives")
            check_equal(t.ask("red", "?*n*"), "17", "a global")
            t.done("send", "red", f"at {host}", "--quiet", "--wait", 0)
            wait_for(lambda h=host: f"(message at {h})" in t.ask("red", "(facts)"), 10, "mail")


# --- checkpoints --------------------------------------------------------------------------------


def test_a_host_comes_back_with_its_agents():
    with team(bodies=()) as t:
        store = t.out / "store"
        store.mkdir()
        words = ("--checkpoint", "0.2", "--folder", store)
        t.hosts["east"] = t.host_start("east", *words)
        rules = t.out / "red.clp"
        rules.write_text("(defglobal ?*n* = 0)\n(deffacts f (kept 1.5))\n")
        for name in ("red", "blue"):
            t.done("launch", name, "east", "--rules", rules, "--quiet")
        t.done("launch", "gone", "north", "--rules", rules, "--quiet")
        t.done("move", "gone", "east")
        check((store / "gone.capsule").exists(), "who has come is not on disk")
        t.done("move", "gone", "north")
        t.done("dispose", "blue")
        t.ask("red", "(bind ?*n* 17)")
        wait_for(lambda: {f.name for f in store.glob("[a-z]*")} == {"red.capsule"}, 10,
                 "the files of those who are here")
        wait_for(lambda: 'y"n" one i17' in (store / "red.capsule").read_text(), 10, "a checkpoint")
        t.hosts["east"].kill()
        t.hosts["east"].wait()
        wait_for(lambda: members(t.domain)["red"]["state"] == "absent", 10, "the end of red")
        t.hosts["east"] = t.host_start("east", "--restore", *words)
        wait_for(lambda: t.place_of("red") == "east", 10, "red again")
        check_equal(t.ask("red", "?*n*"), "17", "a global")
        check("(kept 1.5)" in t.ask("red", "(facts)"), "a fact")
        check_equal(t.place_of("gone"), "north", "who had moved on")
        check_equal(t.place_of("blue"), None, "who was disposed of")
