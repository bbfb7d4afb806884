# SPDX-License-Identifier: Apache-2.0
"""The live page: what the server refuses, what viewers get, and what a person does in a browser."""
import contextlib
import http.client
import json
import re
import socket
import subprocess
import threading
import time

from browser import Browser
from support import (FOLLOW, MUSTER, PATIENCE, Processes, broker_start, check, check_equal,
                     experiment_run, folder, members, new_domain, program, wait_for)

SCRIPT = "<img src=x onerror=alert()>"


class Page:
    """A running muster web."""

    def __init__(self, processes, domain, *words):
        self.process = processes.start(MUSTER, "web", "--port", 0, "--domain", domain, *words,
                                       stdout=subprocess.PIPE, text=True)
        self.url = self.process.stdout.readline().strip()
        found = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/(?:#token=([0-9a-f]{32}))?", self.url)
        check(found, f"it prints its address: {self.url!r}")
        self.port, self.token = int(found[1]), found[2]
        self.host = f"127.0.0.1:{self.port}"

    def ask(self, method, path, body=None, **headers):
        """One request; headers by name, with _ for -, None to leave one out."""
        given = {"Host": self.host} | {k.replace("_", "-"): v for k, v in headers.items()}
        c = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        try:
            c.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
            data = body.encode() if body is not None else b""
            if method == "POST" and "Content-Length" not in given:
                given["Content-Length"] = str(len(data))
            for name, value in given.items():
                if value is not None:
                    c.putheader(name, value)
            c.endheaders(data or None)
            answer = c.getresponse()
            answer.text = answer.read().decode()
            return answer
        finally:
            c.close()

    def act(self, path, body="", **headers):
        good = {"X_Muster_Token": self.token, "X_Muster_Viewer": "1", "X_Muster_Ask": "1"}
        return self.ask("POST", path, body, **(good | headers))


class Viewer:
    """Reads the stream of events as a browser does."""

    def __init__(self, page, receive_bytes=0):
        self.socket = socket.socket()
        if receive_bytes:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_bytes)
        self.socket.settimeout(20)
        self.socket.connect(("127.0.0.1", page.port))
        # HTTP/1.0: the body is not in chunks, which would only be in the way here.
        self.socket.sendall(f"GET /events HTTP/1.0\r\nHost: {page.host}\r\n\r\n".encode())
        self.file = self.socket.makefile("rb")
        self.last = {}  # by event
        self.kept = {"ordered": []}  # all of them
        self.head = []
        while (line := self.file.readline().strip()):
            self.head.append(line.decode())

    def next(self, wanted=None):
        """The next event, or the next of that name: (name, data)."""
        name = data = None
        while True:
            line = self.file.readline()
            if not line:
                raise AssertionError("the stream has ended")
            line = line.decode().rstrip("\n")
            if line.startswith("event: "):
                name = line[7:]
            elif line.startswith("data: "):
                data = json.loads(line[6:])
            elif not line and name:
                self.last[name] = data
                if name in self.kept:
                    self.kept[name].append(data)
                if wanted in (None, name):
                    return name, data
                name = data = None

    def until(self, wanted, good, seconds=30):
        """The last event of that name, when it is as wanted; what is the same is not sent again."""
        end = time.monotonic() + PATIENCE * seconds
        while time.monotonic() < end:
            if wanted in self.last and good(self.last[wanted]):
                return self.last[wanted]
            self.next()
        raise AssertionError(f"no such {wanted} within {seconds} s: {str(self.last)[:400]}")

    def first(self, wanted, good, seconds=30):
        """The first event of that name that is as wanted, among those that have come, too."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for data in self.kept[wanted]:
                if good(data):
                    return data
            self.next()
        raise AssertionError(f"no such {wanted} within {seconds} s: {str(self.kept[wanted])[:400]}")

    def close(self):
        self.file.close()
        self.socket.close()


@contextlib.contextmanager
def page_open(*words):
    domain = new_domain()
    with Processes() as processes:
        yield Page(processes, domain, *words), processes, domain


def follow_start(processes, domain, out, *words):
    return processes.start(MUSTER, "run", FOLLOW, "--domain", domain, "--out", out, "--quiet", *words)


# --- requests ------------------------------------------------------------------------------------


def test_who_is_refused_and_how():
    with page_open() as (page, _, _):
        evil = "evil.example"
        for what, method, path, headers, status in (
                ("the page", "GET", "/", {}, 200),
                ("a link from elsewhere", "GET", "/", {"Sec_Fetch_Site": "cross-site"}, 200),
                ("through a tunnel", "GET", "/", {"Host": "localhost:9000"}, 200),
                ("another name for us", "GET", "/", {"Host": f"{evil}:{page.port}"}, 403),
                ("no name for us", "GET", "/", {"Host": None}, 403),
                ("another site reads", "GET", "/scene", {"Origin": f"http://{evil}"}, 403),
                ("another site's script", "GET", "/main.js", {"Sec_Fetch_Site": "cross-site"}, 403),
                ("another site's stream", "GET", "/events", {"Origin": "null"}, 403),
                ("no world yet", "GET", "/scene", {}, 404),
                ("no such page", "GET", "/passwd", {}, 404),
                ("out of the folder", "GET", "/../../etc/passwd", {}, 404),
                ("the same, encoded", "GET", "/%2e%2e/%2e%2e/etc/passwd", {}, 404),
                ("a zero in it", "GET", "/page.css%00.js", {}, 404),
                ("another method", "DELETE", "/", {}, 405),
                ("a page is no act", "POST", "/", {}, 405),
                ("an act is no page", "GET", "/lines/red", {}, 405),
                ("a header that is too long", "GET", "/", {"X_Long": "x" * 60000}, 431)):
            done = page.ask(method, path, **headers)
            check_equal(done.status, status, f"{what}: {done.text[:99]!r}")


def test_who_may_act():
    with page_open() as (page, _, _):
        viewer = Viewer(page)
        number = viewer.next("hello")[1]["viewer"]
        for what, path, body, headers, status in (
                ("no token", "/lines/red", "(facts)", {"X_Muster_Token": None}, 403),
                ("a wrong one", "/lines/red", "(facts)", {"X_Muster_Token": "0" * 32}, 403),
                ("another site", "/lines/red", "(facts)", {"Origin": "http://evil.example"}, 403),
                ("nobody we know", "/lines/red", "(facts)", {"X_Muster_Viewer": "77"}, 409),
                ("too long, and says so", "/lines/red", None, {"Content_Length": "16385"}, 413),
                ("no agent's name", "/lines/9", "(facts)", {"X_Muster_Viewer": number}, 404),
                ("up", "/lines/../main.js", "(facts)", {"X_Muster_Viewer": number}, 404),
                ("no broker", "/lines/red", "(facts)", {"X_Muster_Viewer": number}, 503)):
            done = page.act(path, body, **headers)
            check_equal(done.status, status, f"{what}: {done.text[:99]!r}")
        c = http.client.HTTPConnection("127.0.0.1", page.port, timeout=20)
        c.request("POST", "/lines/red", iter([b"(" * 9000] * 2), {
            "X-Muster-Token": page.token, "X-Muster-Viewer": number}, encode_chunked=True)
        check_equal(c.getresponse().status, 413, "too long, in chunks")
        c.close()
        viewer.close()


def test_nobody_acts_on_a_page_to_read():
    with page_open("--read-only") as (page, _, _):
        check_equal(page.token, None, "there is no token to print")
        check_equal(page.act("/lines/red", "(facts)", X_Muster_Token="0" * 32).status, 403, "an act")
        viewer = Viewer(page)
        check(viewer.next("hello")[1]["read_only"], "and the page is told")
        viewer.close()


def test_every_answer_says_what_a_browser_may_do_with_it():
    with page_open() as (page, _, _):
        for path in ("/", "/main.js", "/nothing", "/scene"):
            headers = page.ask("GET", path).headers
            policy = headers["Content-Security-Policy"]
            for word in ("default-src 'none'", "script-src 'self'", "frame-ancestors 'none'"):
                check(word in policy, f"{path}: {policy}")
            check("unsafe" not in policy and "http" not in policy, policy)
            check_equal(headers["X-Content-Type-Options"], "nosniff", path)
            check_equal(headers["X-Frame-Options"], "DENY", path)
            check_equal(headers["Cache-Control"], "no-store", path)
            check_equal(headers["Referrer-Policy"], "no-referrer", path)
        check("token" not in page.ask("GET", "/").text, "the page has no token in it")
        viewer = Viewer(page)
        check(any("text/event-stream" in line for line in viewer.head), f"{viewer.head}")
        viewer.close()


def test_it_listens_on_this_machine_alone():
    with page_open() as (page, _, _):
        listening = subprocess.run(["ss", "-Hltn", f"sport = :{page.port}"], capture_output=True,
                                   text=True).stdout
        check_equal([line.split()[3] for line in listening.splitlines()], [page.host], "its socket")


def drip(connections, stop):
    """A byte of a header now and then, so that none of them is idle."""
    while not stop.wait(0.3):
        for c in connections:
            with contextlib.suppress(OSError):
                c.sendall(b"x")


def test_half_open_connections_keep_nobody_out():
    with page_open() as (page, _, _), contextlib.ExitStack() as held:
        halves, stop = [], threading.Event()
        dripping = threading.Thread(target=drip, args=(halves, stop))
        dripping.start()
        try:
            for _ in range(150):
                half = held.enter_context(socket.create_connection(("127.0.0.1", page.port), 5))
                half.sendall(b"GET / HTTP/1.1\r\nHost: ")
                halves.append(half)
            for _ in range(3):
                check_equal(page.ask("GET", "/").status, 200, "the page beside 150 half requests")
        finally:
            stop.set()
            dripping.join()


def test_garbage_is_the_library_s_and_it_lives():
    with page_open() as (page, _, _):
        for bytes_sent in (b"\0" * 20000, b"GET / HTTP/9.9\r\n\r\n", b"GET\r\n\r\n", b"\xff\xfe\r\n\r\n",
                           b"GET / HTTP/1.1\r\nHost: localhost\r\nHost: localhost\r\n\r\n",
                           b"POST /lines/red HTTP/1.1\r\nContent-Length: -1\r\n\r\n"):
            with socket.create_connection(("127.0.0.1", page.port), 20) as s:
                with contextlib.suppress(OSError):
                    s.sendall(bytes_sent)
                    s.shutdown(socket.SHUT_WR)
                    answer = s.recv(4096)
                    check(b" 200 " not in answer[:20], f"{bytes_sent[:30]}: {answer[:60]}")
        check_equal(page.ask("GET", "/").status, 200, "and then")


def test_usage():
    domain = new_domain()
    with Processes() as processes:
        page = Page(processes, domain)
        for words, code, said in ((("--port", page.port, "--domain", new_domain()), 4, "is taken"),
                                  (("--port", 70000), 2, "port"), (("red", "blue"), 2, "one recording at most"),
                                  (("/no/such.mcap",), 3, "/no/such.mcap")):
            done = subprocess.run([MUSTER, "web", *map(str, words)], capture_output=True, text=True,
                                  timeout=30, stdin=subprocess.DEVNULL)
            check_equal(done.returncode, code, f"{words}: {done.stderr}")
            check(said in done.stderr, done.stderr)
        page.process.terminate()
        check_equal(page.process.wait(30), 0, "ended by a signal")


# --- the stream ----------------------------------------------------------------------------------


def test_a_run_is_the_same_with_viewers():
    with folder() as out, page_open() as (page, processes, domain):
        viewers = [Viewer(page) for _ in range(3)]
        watched, with_it = experiment_run(out / "with", "--domain", domain)
        check_equal(watched.returncode, 0, watched.stderr)
        for viewer in viewers:
            end = viewer.until("run", lambda run: run["state"] == "done")
            check_equal(end["hash"], with_it["hash"], "the hash that viewers see")
            viewer.close()
        _, without = experiment_run(out / "without", "--domain", new_domain())
        check_equal(with_it["hash"], without["hash"], "with viewers and without")


def test_what_a_viewer_sees_of_a_run_and_of_the_next():
    with folder() as out, page_open() as (page, processes, domain):
        viewer = Viewer(page)
        check_equal(viewer.until("run", lambda run: True)["state"], "none", "before")
        for number in (1, 2):
            run = follow_start(processes, domain, out / str(number), "--rate", 10, "--duration", 20,
                               *("--no-diary" if number == 2 else "--quiet",))
            viewer.until("scene", lambda s: s["number"] == number)
            scene = json.loads(page.ask("GET", "/scene").text)
            names = [robot["name"] for robot in scene["robots"]]
            check_equal(sorted(names), ["blue", "green", "red", "yellow"], "robots")
            first = viewer.until("frame", lambda f: f["step"] < 100)
            later = viewer.until("frame", lambda f: f["step"] > first["step"] + 50)
            check(first["robots"] != later["robots"], "they move")
            check(later["lists"]["sonar"] and len(later["lists"]["sonar"][0][1]) == 32, f"16 sonars: {later['lists']}")
            check(viewer.until("frame", lambda f: f["mails"])["mails"][0][1] == "all", "mail")
            check_equal(later["goals"][names.index("blue")], "follow", "what blue wants")
            agents = viewer.until("agents", lambda a: "red" in [line[0] for line in a["agents"]])
            check("observer" in [line[0] for line in agents["agents"]], f"{agents}")
            viewer.until("run", lambda r: r["state"] == "done" and len(r["hash"]) == 64)
            totals = viewer.until("statistics", lambda s: s["time_ms"] >= 19000)
            check(all(robot[0] > 500 for robot in totals["robots"]), f"they drove: {totals}")
            check_equal(run.wait(30), 0, "the run")
        viewer.close()


def test_a_viewer_that_does_not_read_holds_up_nobody():
    with page_open() as (page, processes, domain):
        stuck, good = Viewer(page, receive_bytes=4096), Viewer(page)
        feeder = processes.start(program("frame_feeder"), domain, 100, 250, 8)
        frames = 0
        while good.next("frame")[1]["step"] < 1900:
            frames += 1
        check(frames > 500, f"the good one got {frames} of 2000")
        feeder.wait(20)
        missed = stuck.until("missed", lambda m: m["frames"] > 100)
        check(missed["frames"] < 2000, f"{missed}")
        newest = stuck.until("frame", lambda f: f["step"] > 1900)
        check(newest["step"] < 2000, "and then the stuck one sees how it is now")
        stuck.close()
        good.close()


def test_thirty_two_viewers_and_no_more():
    with page_open() as (page, _, _):
        viewers = [Viewer(page) for _ in range(32)]
        check_equal(page.ask("GET", "/events").status, 503, "one too many")
        check_equal(page.ask("HEAD", "/events").status, 503, "and it can be asked why")
        check_equal(page.ask("GET", "/").status, 200, "but the page is there")
        for viewer in viewers:
            viewer.next("hello")
            viewer.close()
        again = wait_for(lambda: page.ask("HEAD", "/events").status == 200 and try_viewer(page), 20,
                         "places are free again")
        again.close()


def try_viewer(page):
    viewer = Viewer(page)
    if " 200 " in viewer.head[0]:
        return viewer
    viewer.close()
    return None


def test_the_broker_goes_and_comes_back():
    with page_open() as (page, processes, domain):
        viewer = Viewer(page)
        check_equal(viewer.until("run", lambda run: True)["broker"], "", "before")
        for _ in range(2):
            broker = broker_start(processes, domain)
            viewer.until("run", lambda run: run["broker"] == "main")
            broker.kill()
            broker.wait()
            viewer.until("run", lambda run: run["broker"] == "")
        viewer.close()


# --- consoles ------------------------------------------------------------------------------------


def said_to(viewer, ask):
    """What agents said to one question, and whether it ended well."""
    text = ""
    while True:
        name, data = viewer.next()
        if name == "said" and data["ask"] == ask:
            text += data["text"]
        elif name == "ended" and data["ask"] == ask:
            return data["good"], text


def act(page, number, path, body="", ask=1):
    def tried():
        done = page.act(path, body, X_Muster_Viewer=number, X_Muster_Ask=str(ask))
        return done if done.status not in (503, 429) else None
    return wait_for(tried, 15, f"{path} is taken")


def test_each_viewer_has_its_own_answers():
    with folder() as out, page_open() as (page, processes, domain):
        follow_start(processes, domain, out / "run", "--rate", 10, "--duration", 600)
        one, two = Viewer(page), Viewer(page)
        first, second = (v.next("hello")[1]["viewer"] for v in (one, two))
        one.until("frame", lambda f: f["step"] > 5)
        for number, line, ask in ((first, '(str-cat "a" b)', 7), (second, "(+ 1 2)", 8),
                                  (first, "(nonsense)", 9), (first, "(+ 1 1) (+ 2 2)", 10)):
            check_equal(act(page, number, "/lines/red", line, ask).status, 202, line)
        check_equal(said_to(one, 7), (True, '"ab"\n'), "the first")
        good, text = said_to(one, 9)
        check(not good and "Missing function" in text, text)
        check_equal(said_to(one, 10), (True, "2\n4\n"), "two forms, one end")
        check_equal(said_to(two, 8), (True, "3\n"), "the second")
        check_equal(act(page, first, "/lines/red", "(facts", 11).status, 400, "an open parenthesis")
        check_equal(act(page, first, "/lines/observer", "(agents) (agents)", 11).status, 400, "it takes one")
        check_equal(act(page, first, "/lines/nobody", "(facts)", 12).status, 202, "who is that")
        good, text = said_to(one, 12)
        check(not good and "unknown-name" in text, text)
        check_equal(act(page, first, "/watch/red").status, 202, "one watches")
        act(page, second, "/lines/red", "(watch rules)", 13)
        trace = one.until("said", lambda s: s["kind"] == "trace")
        check_equal(trace["ask"], 0, f"nobody has asked for it: {trace}")
        act(page, first, "/leave/red")
        for line, reason in (("(suspend)", "(suspend) was called"),
                             ("(break follow-robot) (follow blue) (resume)", "break: follow-robot"),
                             ("(remove-break) (step 1)", "as many rules fired as it was told")):
            act(page, second, "/lines/red", line, 20)
            one.until("agents", lambda a, why=reason: ["red", why] in
                      [[line[0], line[4]] for line in a["agents"]])
        act(page, second, "/lines/red", "(resume)", 21)
        act(page, second, "/lines/red", "(unwatch all)", 14)
        act(page, first, "/lines/observer", "(suspend robots)", 15)
        good, text = said_to(one, 15)
        check(good and "blue: done" in text, f"the observer: {text}")
        wait_for(lambda: members(domain)["blue"]["state"] == "suspended", 10, "blue is suspended")
        one.close()
        two.close()


def test_words_of_a_line_are_completed():
    with folder() as out, page_open() as (page, processes, domain):
        follow_start(processes, domain, out / "run", "--rate", 10, "--duration", 600)
        viewer = Viewer(page)
        number = viewer.next("hello")[1]["viewer"]
        viewer.until("frame", lambda f: f["step"] > 5)
        for agent, line, ask, rest, word in (("red", "(show-br", 1, "eaks ", None),
                                             ("red", "(assert (posit", 2, "ion ", None),
                                             ("red", "x" * 300 + " (ppdefrule follow-r", 3, "obot ", None),
                                             ("red", "(fol", 4, "low", "follow"),
                                             ("red", "(nothing-of-that", 5, "", None),
                                             ("observer", "(you-", 6, "do ", None)):
            check_equal(act(page, number, f"/words/{agent}", line, ask).status, 202, line)
            done = viewer.until("completed", lambda c, n=ask: c["ask"] == n)
            check(done["rest"].startswith(rest) if word else done["rest"] == rest, f"{line}: {done}")
        act(page, number, "/words/red", "(s", 7)
        done = viewer.until("completed", lambda c: c["ask"] == 7)
        check(done["rest"] == "" and {"send", "stay", "suspend"} <= set(done["words"]), f"{done}")
        act(page, number, "/lines/red", "(deffunction zzz () 1)", 8)
        act(page, number, "/words/red", "(zz", 9)
        viewer.until("completed", lambda c: c["ask"] == 9 and c["rest"] == "z ")
        viewer.close()


# --- hands on the world --------------------------------------------------------------------------


def test_hands_move_bodies_and_are_part_of_the_run():
    with folder() as out, page_open() as (page, processes, domain):
        run = follow_start(processes, domain, out / "run", "--rate", 10, "--duration", 30)
        viewer = Viewer(page)
        number = viewer.next("hello")[1]["viewer"]
        first = viewer.until("frame", lambda f: f["step"] > 5)
        names = [r["name"] for r in json.loads(page.ask("GET", "/scene").text)["robots"]]
        red = names.index("red")
        check_equal(act(page, number, "/world", "place red 3 -3 90", 1).status, 202, "an order")
        done = viewer.until("ordered", lambda o: o["ask"] == 1)
        check(done["good"] and done["step"] >= first["step"], f"{done}")
        viewer.until("frame", lambda f: abs(f["robots"][red][0] - 3000) < 500
                     and abs(f["robots"][red][1] + 3000) < 500)
        for line, said in (("sensor red sonar off", ""), ("push red 50 0", ""), ("reset", ""),
                           ("place red 3 -3", ""), ("place nobody 0 0", "no robot or object"),
                           ("place red 1e6 0", "")):
            check_equal(act(page, number, "/world", line, 2).status, 202, line)
            done = viewer.next("ordered")[1]
            check_equal(done["good"], not said and "1e6" not in line, f"{line}: {done}")
        other = Viewer(page)
        for ask, line in ((3, "sensor red laser off\nat 20"), (4, "reset\nat 0\nwhen time > 21"),
                          (5, "push red 50 0\nwhen red near nobody 1"), (6, "pace 2\nat 25"),
                          (7, "place red 0 0\nat 1000")):
            check_equal(act(page, number, "/world", line, ask).status, 202, line)
        for ask, good, step, said in ((3, True, 200, ""), (4, True, 211, ""), (5, False, None, "nobody"),
                                      (6, False, None, "at once")):
            done = viewer.first("ordered", lambda o, n=ask: o["ask"] == n)
            check_equal(done["good"], good, f"{done}")
            check(step in (None, done["step"]) and said in done["text"], f"{done}")
        seen = other.first("ordered", lambda o: o["order"] == "reset")
        check_equal((seen["ask"], seen["at_s"], seen["when"]), (0, 0, "time > 21"), "another page sees it")
        other.close()
        viewer.until("later", lambda w: [o["order"] for o in w["orders"]] == ["place red 0 0"])
        for line, status, said in (("", 400, "expected place"), ("place red 1", 400, "expected place NAME"),
                                   ("reset\nat noon", 400, "seconds"), ("reset\nat -1", 400, "seconds"),
                                   ("reset\nsoon", 400, "at SECONDS"), ("reset\nwhen " + "x" * 128, 400, "that long"),
                                   ("save /tmp/here", 400, "expected place, push"),
                                   ("place red 1 2 3 4 5 6 7 8 9", 400, "expected"),
                                   ("reset " + "x" * 300, 400, "that long"),
                                   ("reset\0red", 400, "expected text")):
            refused = page.act("/world", line, X_Muster_Viewer=number)
            check_equal(refused.status, status, line)
            check(said in refused.text, f"{line}: {refused.text}")
        check_equal(page.act("/world", "reset", X_Muster_Token=None).status, 403, "no token")
        end = viewer.until("run", lambda r: r["state"] == "done" and len(r["hash"]) == 64, 60)
        check_equal(run.wait(30), 0, "the run")
        done = viewer.first("ordered", lambda o: o["ask"] == 7)
        check_equal((done["good"], done["text"]), (False, "the run has ended"), "its time did not come")
        viewer.until("later", lambda w: w["orders"] == [])
        late = page.act("/world", "reset", X_Muster_Viewer=number)
        check_equal((late.status, late.text), (404, "no run lives\n"), "too late")
        viewer.close()
        again = subprocess.run([MUSTER, "verify", str(out / "run" / "run.mcap")],
                               capture_output=True, text=True, timeout=120)
        check_equal(again.returncode, 0, again.stdout + again.stderr)
        check(end["hash"] in again.stdout, f"the same with the same hands: {again.stdout}")


# --- a person at a browser -----------------------------------------------------------------------


def test_a_click_suspends_a_robot():
    with folder() as out, page_open() as (page, processes, domain):
        follow_start(processes, domain, out / "run", "--rate", 2, "--duration", 600)
        viewer = Viewer(page)
        with Browser(page.url) as browser:
            browser.wait("document.querySelectorAll('tbody tr').length === 4")
            check_equal(browser.value("location.hash"), "", "the token is not left in the address")
            browser.wait("Number(document.getElementById('time').textContent) > 3")
            metres = "[...document.querySelectorAll('tbody tr')].map(r => +r.children[2].textContent)"
            moved = browser.wait(f"{metres}.every(m => m > 0.1) && {metres}", 40)
            check_equal(len(moved), 4, "four robots drive")
            browser.click("[data-tab='agent red']")
            browser.click(".panel:not([hidden]) [data-do='Suspend']")
            wait_for(lambda: members(domain)["red"]["state"] == "suspended", 15, "the white pages")
            browser.wait("document.querySelector('.panel:not([hidden]) .state').dataset.state"
                         " === 'suspended'")
            names = [r["name"] for r in json.loads(page.ask("GET", "/scene").text)["robots"]]
            red = names.index("red")
            stands = viewer.until("frame", lambda f: f["robots"][red][7] & 7 == 2
                                  and abs(f["robots"][red][3]) < 5)
            later = viewer.until("frame", lambda f: f["step"] >= stands["step"] + 20)
            near = [abs(a - b) for a, b in zip(stands["robots"][red][:2], later["robots"][red][:2])]
            check(max(near) < 20, f"red stands: {near} mm in 2 s")
            others = [i for i in range(4) if i != red]
            check(any(stands["robots"][i][:2] != later["robots"][i][:2] for i in others), "alone")
            browser.click(".panel:not([hidden]) [data-view='Facts']")
            browser.wait("document.querySelector('.panel:not([hidden]) .output').textContent"
                         ".includes('(goal ')")
            browser.click(".panel:not([hidden]) .line input")
            browser.type("(+ 20 3)")
            browser.key("Enter")
            browser.wait("document.querySelector('.panel:not([hidden]) .output').textContent"
                         ".includes('23')")
            browser.click(".panel:not([hidden]) [data-do='Resume']")
            wait_for(lambda: members(domain)["red"]["state"] == "running", 15, "it goes on")
            # The tab in front is the robot that keys are about, and the other way round.
            browser.click("[data-tab='agent blue']")
            browser.value("document.activeElement.blur()")
            browser.key("s")
            wait_for(lambda: members(domain)["blue"]["state"] == "suspended", 15, "the tab in front")
            browser.key("j")
            front = "document.querySelector('[role=tab][aria-selected=true]').dataset.tab"
            browser.wait(f"{front} === 'agent {names[(names.index('blue') + 1) % 4]}'")
            check_equal(members(domain)["red"]["state"], "running", "it alone")
            check_equal(browser.said, [], "the page had no fault")
        viewer.close()


SCREEN = """(() => {
    const box = document.getElementById('live').getBoundingClientRect();
    return {x: box.x, y: box.y, width: box.width, height: box.height};
})()"""


def test_hands_of_a_person_at_the_page():
    with folder() as out, page_open() as (page, processes, domain):
        follow_start(processes, domain, out / "run", "--rate", 2, "--duration", 600)
        viewer = Viewer(page)
        names = []

        def red(frame):
            return [x / 1000 for x in frame["robots"][names.index("red")][:2]]

        with Browser(page.url) as browser:
            browser.wait("document.querySelectorAll('tbody tr').length === 4")
            names += [r["name"] for r in json.loads(page.ask("GET", "/scene").text)["robots"]]
            browser.click("[data-tab='agent red']")
            browser.click(".panel:not([hidden]) .line input")
            browser.type("(show-br")
            browser.key("Tab")
            browser.wait("document.querySelector('.panel:not([hidden]) .line input').value === '(show-breaks '")
            act(page, viewer.next("hello")[1]["viewer"], "/lines/observer", "(suspend robots)")
            browser.wait("document.querySelector('.panel:not([hidden]) .state').textContent"
                         ".includes('told by observer')")
            stood = viewer.until("frame", lambda f: f["step"] > 20 and f["robots"][names.index("red")][7] & 7 == 2
                                 and abs(f["robots"][names.index("red")][3]) < 5)
            pose = "document.querySelector('.panel:not([hidden]) .pose').textContent" # x 1.50 m   y ...
            browser.wait(f"Math.abs(parseFloat({pose}.slice(2)) - {red(stood)[0]}) < 0.05")
            # All of the world is shown; the scale is that of the narrower side.
            browser.click("#tools [data-tool=fit]")
            browser.click("#tools [data-tool=hands]")
            middle, scale = place_of(page, browser)
            x, y = red(stood)
            start = (middle[0] + x * scale, middle[1] - y * scale)
            browser.drag(start, (middle[0] + 1.5 * scale, middle[1] + 2.5 * scale)) # where nothing is
            viewer.until("frame", lambda f: abs(red(f)[0] - 1.5) < 0.1 and abs(red(f)[1] + 2.5) < 0.1)
            browser.wait(f"Math.abs(parseFloat({pose}.slice(2)) - 1.5) < 0.1")
            now = viewer.last["frame"]
            start = (middle[0] + red(now)[0] * scale, middle[1] - red(now)[1] * scale)
            browser.drag(start, (start[0], start[1] - 1.2 * scale), shift=True)
            pushed = viewer.until("frame", lambda f: abs(red(f)[1] - red(now)[1]) > 0.01)
            check(abs(red(pushed)[1] - red(now)[1]) < 1, "it was pushed, not placed")
            browser.click_at(*start)
            browser.click("[data-tab='World']")
            browser.wait("document.querySelectorAll('.panel:not([hidden]) .output .answer').length === 2")
            browser.click("[data-tab='agent red']")
            browser.click(".panel:not([hidden]) summary")
            browser.click(".panel:not([hidden]) [data-hand=Block]")
            browser.click("[data-tab='Robots']")
            browser.click(f"tbody tr:nth-child({names.index('red') + 1})")
            browser.value("document.getElementById('live').focus(), 1")
            browser.key("ArrowRight")
            browser.key("[")
            browser.click("[data-tab='World']")
            browser.wait("document.querySelectorAll('.panel:not([hidden]) .output :is(.answer, .failure)').length === 5")
            said = browser.value("document.querySelector('.panel:not([hidden]) .output').textContent")
            check_equal(said.count("done at step"), 5, said)
            for word in ("place red", "push red 0 1", "sensor red all off"):
                check(f"world> {word}" in said, said)
            check_equal(browser.said, [], "the page had no fault")
        viewer.close()


SHOWN = ".panel:not([hidden])"
WAITING = f"document.querySelector('{SHOWN} .waiting').textContent"
WORLD_SAID = f"document.querySelector('{SHOWN} .output').textContent"


def world_order(browser, line, at="", when=""):
    for selector, text in ((".line input", line), (".later .seconds", at), (".later .rest input", when)):
        browser.click(f"{SHOWN} {selector}")
        browser.type(text)
    browser.key("Enter")  # in the last of the fields


def test_orders_for_later_of_a_person_at_the_page():
    with folder() as out, page_open() as (page, processes, domain):
        run = follow_start(processes, domain, out / "run", "--rate", 0.25, "--duration", 150)
        viewer = Viewer(page)
        with Browser(page.url) as browser:
            browser.wait("document.querySelectorAll('tbody tr').length === 4")
            browser.click("[data-tab='World']")
            browser.wait("Number(document.getElementById('time').textContent) > 0")
            world_order(browser, "sensor red sonar off", at="30")
            browser.wait(f"{WAITING} === 'waits sensor red sonar off, at 30 s'")
            empty = "[...document.querySelectorAll('.panel:not([hidden]) .later input')].every(i => !i.value)"
            browser.wait(empty)
            world_order(browser, "reset", when="time > 35")
            browser.wait(f"{WAITING}.includes('waits reset, when time > 35')")
            world_order(browser, "reset", at="soon")
            browser.wait(f"{WORLD_SAID}.includes('reset, at soon s: at: expected seconds')")
            check(not browser.value(empty), "what was refused can be mended")
            number = viewer.next("hello")[1]["viewer"]
            act(page, number, "/world", "pace 20")
            browser.click("[data-tab='Robots']")
            browser.wait("document.getElementById('said').textContent.includes(': done at step ')")
            browser.click("[data-tab='World']")
            browser.wait(f"{WORLD_SAID}.includes('sensor red sonar off, at 30 s: done at step 300')")
            browser.wait(f"{WORLD_SAID}.includes('reset, when time > 35: done at step 351')")
            browser.wait(f"{WAITING} === ''")
            act(page, number, "/world", "pace 0.25")
            browser.click("[data-tab='agent red']")
            browser.click(f"{SHOWN} summary")
            browser.click(f"{SHOWN} .later .seconds")
            browser.type("5000")
            browser.click(f"{SHOWN} [data-hand=Block]")
            viewer.until("later", lambda w: [o["order"] for o in w["orders"]] == ["sensor red all off"])
            browser.call("Page.reload")  # what waits outlives the page
            browser.wait("document.querySelector('[data-tab=World]') !== null")
            browser.click("[data-tab='World']")
            browser.wait(f"{WAITING} === 'waits sensor red all off, at 5000 s'")
            act(page, number, "/world", "pace 0")
            check(run.wait(60) in (0, 1), "the run, whatever it was to come to")
            browser.wait(f"{WORLD_SAID}.includes('sensor red all off, at 5000 s: the run has ended')")
            browser.wait(f"{WAITING} === ''")
            check_equal(browser.said, [], "the page had no fault")
        viewer.close()


def place_of(page, browser):
    """Where the world's origin is on the screen, when all of it is shown, and pixels of a metre."""
    x0, y0, x1, y1 = json.loads(page.ask("GET", "/scene").text)["bounds"]
    box = browser.value(SCREEN)
    scale = min(box["width"] / ((x1 - x0) * 1.08), (box["height"] - 50) / ((y1 - y0) * 1.08))
    middle_x, middle_y = (x0 + x1) / 2, (y0 + y1) / 2 - 20 / scale
    return (box["x"] + box["width"] / 2 - middle_x * scale,
            box["y"] + box["height"] / 2 + middle_y * scale), scale


def test_a_page_that_is_opened_after_the_end_shows_how_it_ended():
    with folder() as out, page_open() as (page, processes, domain):
        run = follow_start(processes, domain, out / "run", "--duration", 3)
        run.wait(60)
        with Browser(page.url) as browser:
            browser.wait("document.getElementById('banner').textContent.includes('The run has ended')")
            browser.wait(f"document.body.textContent.includes('{out}/run')")
            browser.wait("[...document.querySelectorAll('tbody tr')]"
                         ".some(row => +row.children[2].textContent > 0.1)")
            check_equal(browser.said, [], "the page had no fault")


def test_who_has_no_token_only_looks():
    with folder() as out, page_open() as (page, processes, domain):
        follow_start(processes, domain, out / "run", "--rate", 2, "--duration", 600)
        with Browser(page.url.split("#")[0]) as browser:
            browser.click("[data-tab='agent red']")
            browser.wait("document.querySelector('.panel:not([hidden]) [data-do=Suspend]').disabled")
            said = browser.value("document.querySelector('.panel:not([hidden]) .denied').textContent")
            check("token" in said, said)


NO_SCENE = """(() => {
    const fetched = window.fetch;
    window.fetch = (path, ...rest) => (path === '/scene'
        ? Promise.resolve(new Response('the world is too large for a page\\n', {status: 404}))
        : fetched(path, ...rest));
    return 1;
})()"""


def test_a_world_that_is_too_large_for_a_page():
    with page_open() as (page, processes, domain), Browser(page.url) as browser:
        browser.value(NO_SCENE)
        processes.start(program("frame_feeder"), domain, 4, 20, 60)
        browser.wait("document.getElementById('banner').textContent.includes('too large for a page')")
        check_equal(browser.value("document.querySelectorAll('tbody tr').length"), 0, "nobody is shown")
        check_equal(browser.said, [], "the page had no fault")


NOTHING_KEPT = """for (const kind of ['localStorage', 'sessionStorage']) {
    Object.defineProperty(window, kind, {get() { throw new Error('nothing is kept here'); }});
}"""


def test_a_browser_that_keeps_nothing():
    with page_open() as (page, _, _), Browser("about:blank") as browser:
        browser.call("Page.addScriptToEvaluateOnNewDocument", source=NOTHING_KEPT)
        browser.call("Page.navigate", url=page.url)
        browser.wait("document.getElementById('banner')?.textContent.includes('no run yet')")
        dark = "document.documentElement.dataset.theme"
        check_equal(browser.value(dark), "light", "as the system says")
        browser.click("#theme")
        check_equal(browser.value(dark), "dark", "as the person says")
        browser.click("[data-tab=World]")
        browser.wait(f"document.querySelector('{SHOWN} .denied').hidden")  # it has the token
        check_equal(browser.said, [], "the page had no fault")


def test_script_in_names_and_facts_is_text():
    with page_open() as (page, processes, domain):
        processes.start(program("frame_feeder"), domain, 4, 20, 60, SCRIPT)
        with Browser(page.url) as browser:
            browser.wait("document.querySelectorAll('tbody tr').length === 4")
            browser.value("window.alert = () => { window.hacked = true; }, 1")
            text = browser.wait("document.querySelector('tbody .name').textContent")
            check_equal(text, SCRIPT + "1", "a robot's name")
            browser.click("[data-tab=Mail]")
            browser.wait("document.querySelector('.log li')?.textContent.includes('<img')")
            check_equal(browser.value("document.images.length"), 0, "no picture came of it")
            check_equal(browser.value("window.hacked"), None, "nothing ran")
            check_equal(browser.said, [], "nor tried to")


def test_script_in_a_fact_is_text():
    with folder() as out, page_open() as (page, processes, domain):
        follow_start(processes, domain, out / "run", "--rate", 2, "--duration", 600)
        with Browser(page.url) as browser:
            browser.value("window.alert = () => { window.hacked = true; }, 1")
            browser.click("[data-tab='agent red']")
            browser.click(".panel:not([hidden]) .line input")
            browser.type(f'(assert (note "{SCRIPT}"))')
            browser.key("Enter")
            browser.click(".panel:not([hidden]) [data-view=Facts]")
            browser.wait("document.querySelector('.panel:not([hidden]) .output').textContent"
                         f".includes('(note \"{SCRIPT}\")')")
            browser.click("[data-tab=World]")
            browser.click(".panel:not([hidden]) .line input")
            browser.type("reset <b>x</b>")
            browser.key("Enter")
            browser.wait("document.querySelector('.panel:not([hidden]) .failure')?.textContent"
                         ".includes('reset <b>x</b>: ')")
            check_equal(browser.value("document.querySelectorAll('.output b, #said b').length"), 0, "no markup")
            check_equal(browser.value("document.images.length"), 0, "no picture came of it")
            check_equal(browser.value("window.hacked"), None, "nothing ran")
            check_equal(browser.said, [], "nor tried to")


class Tunnel:
    """Passes on what comes to a port of its own, and can be cut."""

    def __init__(self, to):
        self.to, self.ends = to, []
        self.socket = socket.create_server(("127.0.0.1", 0))
        self.port = self.socket.getsockname()[1]

    def __enter__(self):
        threading.Thread(target=self.accept, daemon=True).start()
        return self

    def __exit__(self, *exc):
        self.socket.close()
        self.cut()

    def accept(self):
        with contextlib.suppress(OSError):
            while True:
                ends = self.socket.accept()[0], socket.create_connection(("127.0.0.1", self.to))
                self.ends += ends
                for one, other in (ends, ends[::-1]):
                    threading.Thread(target=self.pass_on, args=(one, other), daemon=True).start()

    @staticmethod
    def pass_on(one, other):
        with contextlib.suppress(OSError):
            while data := one.recv(65536):
                other.sendall(data)
        for end in (one, other):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def cut(self):
        ends, self.ends = self.ends, []
        for end in ends:
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)
            end.close()


OUTPUT = f"document.querySelector('{SHOWN} .output')"


def test_keys_scroll_what_is_read_and_do_nothing_twice():
    with folder() as out, page_open() as (page, processes, domain):
        follow_start(processes, domain, out / "run", "--rate", 2, "--duration", 600)
        with Browser(page.url) as browser:
            browser.wait("document.querySelectorAll('tbody tr').length === 4")
            browser.click("[data-tab='agent red']")
            browser.click(f"{SHOWN} [data-view=Rules]")
            browser.wait(f"{OUTPUT}.textContent.includes('safe-wander')")
            check_equal(browser.value(f"{OUTPUT}.scrollTop"), 0, "one reads from the top")
            browser.call("Emulation.setDeviceMetricsOverride", width=1400, height=420,
                         deviceScaleFactor=1, mobile=False)
            browser.value(f"{OUTPUT}.focus(), 1")
            browser.key("ArrowDown")
            browser.wait(f"{OUTPUT}.scrollTop > 0")
            browser.key("Escape")
            browser.value("document.getElementById('live').focus(), 1")
            names = "document.querySelector('[data-tool=names]').getAttribute('aria-pressed')"
            browser.key("n", repeats=3)  # held down
            check_equal(browser.value(names), "false", "names are off, whoever holds the key")
            browser.click(f"{SHOWN} [data-view=Log]")
            for _ in range(2):
                browser.click(f"{SHOWN} .line input")
                browser.type("(rules)")
                browser.key("Enter")
            end = f"{OUTPUT}.scrollTop + {OUTPUT}.clientHeight >= {OUTPUT}.scrollHeight - 20"
            browser.wait(f"{OUTPUT}.scrollHeight > 400 && {end}")
            browser.click("[data-tab='Robots']")
            browser.click("[data-tab='agent red']")
            browser.wait(end)  # it is read where it was left
            browser.click(f"{SHOWN} .line input")
            browser.type("(rules)")
            browser.key("Enter")
            browser.click(f"{SHOWN} .close")  # before the answer is there
            browser.wait("!document.querySelector('[data-tab=\"agent red\"]')")
            browser.wait("document.activeElement.dataset.tab === 'agent observer'")
            browser.key("Escape")
            browser.key("r")
            browser.click("tbody tr:nth-child(1)", 2)
            browser.wait(f"document.querySelector('{SHOWN} h2').textContent.startsWith('red')")
            browser.click(f"{SHOWN} .line input")
            browser.type("(+ 40 2)")
            browser.key("Enter")
            browser.wait(f"{OUTPUT}.textContent.includes('42')")
            said = browser.value(f"{OUTPUT}.textContent")
            check_equal(said, "red> (+ 40 2)\n42\n", "it is another console")
            check_equal(browser.said, [], "the page had no fault")


def test_the_page_goes_on_where_it_was_when_the_stream_breaks():
    with folder() as out, page_open() as (page, processes, domain), Tunnel(page.port) as tunnel:
        follow_start(processes, domain, out / "run", "--rate", 4, "--duration", 600)
        with Browser(page.url.replace(str(page.port), str(tunnel.port))) as browser:
            browser.wait("document.querySelectorAll('tbody tr').length === 4")
            browser.click("tbody tr:nth-child(2)")
            browser.click("[data-tab='agent red']")
            browser.click(f"{SHOWN} .line input")
            browser.type("(watch rules)")
            browser.key("Enter")
            browser.wait(f"{OUTPUT}.textContent.includes('FIRE')")
            tunnel.cut()
            browser.wait("document.getElementById('banner').textContent.includes('has lost')")
            browser.wait("document.getElementById('banner').hidden")
            fired = f"{OUTPUT}.textContent.split('FIRE').length"
            before = browser.value(fired)
            browser.wait(f"{fired} > {before} + 5")  # what was watched is watched again
            browser.click("[data-tab='Robots']")
            browser.wait("document.querySelector('tbody tr[aria-selected=true]')?.textContent.includes('red')")
            check_equal(browser.said, [], "the page had no fault")


def test_the_page_comes_back_with_the_server():
    with folder() as out:
        domain = new_domain()
        with Processes() as processes:
            page = Page(processes, domain)
            with Browser(page.url) as browser:
                browser.wait("document.getElementById('banner').textContent.includes('no run yet')")
                page.process.terminate()
                page.process.wait(30)
                browser.wait("document.getElementById('banner').textContent.includes('has lost')")
                follow_start(processes, domain, out / "run", "--rate", 2, "--duration", 600)
                again = processes.start(MUSTER, "web", "--port", page.port, "--domain", domain,
                                        stdout=subprocess.PIPE, text=True)
                check("token" in again.stdout.readline(), "on the same port")
                browser.wait("document.querySelectorAll('tbody tr').length === 4", 30)
                browser.wait("document.getElementById('banner').hidden", 30)
