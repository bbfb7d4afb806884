# SPDX-License-Identifier: Apache-2.0
"""A recording in the page: any moment of it, what was in minds, and nobody acts."""
import contextlib
import json

from browser import Browser
from support import ROOT, Processes, check, check_equal, experiment_run, folder, muster
from test_web import Page, Viewer

# A robot that drives at a wall.
RAM = "(defrule ram (goal ram) (position $?) => (setSpeed 400 0))\n"
BUMP = """world: {world}
duration: 20
robots:
  - {{name: ram, body: pioneer, pose: [0, 0, 0], rules: ram.clp}}
observer:
  - {{at: 1, do: ram, line: "(assert (goal ram))"}}
"""


@contextlib.contextmanager
def recording_page(*words, **kwargs):
    with folder() as out, Processes() as processes:
        done, summary = experiment_run(out / "run", *words, **kwargs)
        check(summary is not None, f"a run without a summary: {done.stderr}")
        yield Page(processes, 0, "--read-only", out / "run" / "run.mcap"), out, summary


def bump(out):
    (out / "ram.clp").write_text(RAM)
    (out / "bump.yaml").write_text(BUMP.format(world=ROOT / "worlds" / "arena.world"))
    return out / "bump.yaml"


def moment(page, step, robot=""):
    done = page.ask("GET", f"/moments/{step}/{robot}")
    check_equal(done.status, 200, f"step {step}: {done.text[:99]}")
    return json.loads(done.text)


def rows(out):
    """run.csv by step and robot."""
    lines = (out / "run" / "run.csv").read_text().splitlines()
    names = lines[0].split(",")
    made = [dict(zip(names, line.split(","))) for line in lines[1:]]
    return {(round(float(r["time_s"]) * 10), r["robot"]): r for r in made}


# --- by HTTP -------------------------------------------------------------------------------------


def test_every_moment_is_as_it_was():
    with recording_page("--duration", 60) as (page, out, _):
        whole = json.loads(page.ask("GET", "/recording").text)
        check_equal((whole["first"], whole["last"], whole["step_ms"]), (0, 600, 100), "its time")
        check_equal(sorted(whole["robots"]), ["blue", "green", "red", "yellow"], "diaries")
        names = [r["name"] for r in json.loads(page.ask("GET", "/scene").text)["robots"]]
        track = rows(out)
        for step in (600, 0, 1, 300, 299, 301, 40, 599):  # there and back
            seen = moment(page, step, "red")
            check_equal(seen["frame"]["step"], step, "the step")
            check(step == 0 or len(seen["frame"]["lists"]["sonar"]) == 4, "beams of all")
            for name, robot in zip(names, seen["frame"]["robots"]):
                there = track[step, name]
                near = abs(robot[0] - 1000 * float(there["x_m"]))
                check(near <= 1, f"{name} at step {step}: {robot[0]} mm, {there['x_m']} m")
            check(all(step - 30 <= m[0] < step for m in seen["lately"]), f"{seen['lately'][:3]}")
            check_equal(seen["mind"]["robot"], "red", "whose mind")
        late = moment(page, 300, "blue")
        facts = [text for _, text in late["mind"]["facts"]]
        check(any(f.startswith("(position 30.0 ") for f in facts), f"its percept: {facts}")
        check_equal(len([f for f in facts if f.startswith("(position ")]), 1, "and no old one")
        check(late["mind"]["fired"][0][0] <= 300, f"{late['mind']['fired'][0]}")
        check(len({m[0] for m in late["lately"]}) == 30, "mail of each of the steps before")
        blue = names.index("blue")
        goal = f"(goal {late['frame']['goals'][blue]})"
        check(goal in facts, f"{goal} in {facts}")


def test_tracks():
    with recording_page("--duration", 30) as (page, out, _):
        tracks = json.loads(page.ask("GET", "/tracks").text)
        names = [r["name"] for r in json.loads(page.ask("GET", "/scene").text)["robots"]]
        check_equal(tracks["steps"], list(range(301)), "each step")
        for (step, name), row in rows(out).items():
            track = tracks["robots"][names.index(name)]
            for at, key in ((2 * step, "x_m"), (2 * step + 1, "y_m")):
                check(abs(track[at] - 1000 * float(row[key])) <= 1, f"{name} at {step}: {track[at]}")


def test_where_there_is_none():
    with recording_page("--duration", 5) as (page, _, _):
        for path, status in (("/moments/", 404), ("/moments/x", 404), ("/moments/1x", 404),
                             ("/moments/-1", 404), ("/why/", 404), ("/why/3", 404),
                             ("/why/3/nobody", 404), ("/why/3/red", 200)):
            check_equal(page.ask("GET", path).status, status, path)
        check_equal(moment(page, 10**17)["frame"]["step"], 50, "behind the end: the end")
        nobody = moment(page, 3, "nobody")["mind"]
        check_equal((nobody["step"], nobody["facts"]), (-1, []), "a mind that nobody has")
        check("mind" not in moment(page, 3), "nobody's was asked for")


def test_a_recording_without_diaries():
    with recording_page("--duration", 5, "--no-diary") as (page, _, _):
        check_equal(json.loads(page.ask("GET", "/recording").text)["robots"], [], "no diaries")
        seen = moment(page, 40, "red")
        check_equal((seen["mind"]["step"], seen["mind"]["facts"]), (-1, []), "no mind")
        check_equal(len(seen["frame"]["goals"]), 4, "goals are in Frames")
        check(seen["frame"]["lists"]["sonar"] and seen["lately"], "but all else")


def test_a_recording_that_was_cut_off():
    """It is shown as far as it goes; of bytes that are no recording nothing is."""
    with folder() as out, Processes() as processes:
        experiment_run(out / "run", "--duration", 60)
        data = (out / "run" / "run.mcap").read_bytes()
        for name, part in (("half", data[:len(data) // 2]), ("none", b""), ("junk", b"x" * 5000)):
            (out / name).write_bytes(part)
        page = Page(processes, 0, "--read-only", out / "half")
        last = json.loads(page.ask("GET", "/recording").text)["last"]
        check(100 < last < 600, f"half of 600 steps: {last}")
        check_equal(moment(page, 600, "red")["frame"]["step"], last, "the last one")
        for name in ("none", "junk"):
            done = muster("web", "--port", 0, out / name)
            check_equal(done.returncode, 3, f"{name}: {done.stderr}")
            check(str(out / name) in done.stderr, done.stderr)


def test_nobody_commands_a_recording():
    with recording_page("--duration", 5) as (page, _, _):
        check_equal(page.token, None, "there is no token")
        for path in ("/lines/red", "/watch/red", "/leave/red"):
            check_equal(page.ask("POST", path, "(facts)", X_Muster_Token="0" * 32).status, 403, path)
        viewer = Viewer(page)
        check(viewer.next("hello")[1]["read_only"], "the page is told")
        viewer.close()
        check_equal(page.ask("GET", "/moments/3", Origin="http://evil.example").status, 403,
                    "another site reads")
        check_equal(page.ask("POST", "/moments/3", "").status, 405, "a moment is no act")


def test_a_page_of_a_run_has_no_moments():
    from test_web import page_open
    with page_open() as (page, _, _):
        check_equal(page.ask("GET", "/recording").text, "null\n", "no recording")
        check_equal(page.ask("GET", "/moments/3/red").status, 404, "no moment")
        check_equal(page.ask("GET", "/tracks").status, 404, "no tracks")
        check_equal(page.ask("GET", "/why/3/red").status, 404, "no chain")


def test_why_is_what_the_command_says():
    with folder() as out:
        with recording_page(file=bump(out)) as (page, there, _):
            stalls = json.loads(page.ask("GET", "/recording").text)["stalls"]
            names = [r["name"] for r in json.loads(page.ask("GET", "/scene").text)["robots"]]
            check(stalls and names[stalls[0][0]] == "ram", f"it is stalled: {stalls}")
            start = stalls[0][1]
            told = json.loads(muster("why", there / "run" / "run.mcap", "ram", f"{(start - 1) / 10}",
                                     "--json").stdout)
            check_equal(page.ask("GET", f"/why/{start - 1}/ram").text, told["chain"], "the chain")
            check("(goal ram)" in told["chain"], told["chain"])
            track = rows(there)
            stood = {step for (step, name), row in track.items() if row["stalled"] == "1"}
            check_equal({step for _, first, last in stalls for step in range(first, last + 1)}, stood,
                        "the steps in which it was")


# --- in a browser --------------------------------------------------------------------------------

OUTPUT = "document.querySelector('.panel:not([hidden]) .output').textContent"
STEP = "Number(document.getElementById('step').textContent)"


def drag(browser, share):
    """Takes the slider's thumb and moves it to a share of its length, by the mouse."""
    box = browser.value("""(() => {
        const s = document.getElementById('slider'), b = s.getBoundingClientRect();
        const at = (s.value - s.min) / (s.max - s.min);
        return {x: b.x + 8 + at * (b.width - 16), y: b.y + b.height / 2, left: b.x, width: b.width};
    })()""")
    to = box["left"] + 8 + share * (box["width"] - 16)
    mouse = lambda kind, x, **more: browser.call(  # noqa: E731
        "Input.dispatchMouseEvent", type=kind, x=x, y=box["y"], **more)
    mouse("mouseMoved", box["x"])
    mouse("mousePressed", box["x"], button="left", clickCount=1)
    for i in range(1, 6):
        mouse("mouseMoved", box["x"] + (to - box["x"]) * i / 5, button="left", buttons=1)
    mouse("mouseReleased", to, button="left", clickCount=1)


def test_a_person_drags_the_slider():
    with recording_page("--duration", 60) as (page, _, _):
        with Browser(page.url) as browser:
            browser.wait("document.querySelectorAll('tbody tr').length === 4")
            browser.wait("!document.getElementById('past').hidden")
            check_equal(browser.value("document.querySelectorAll('[data-do]').length"), 0, "no buttons")
            browser.click("[data-tab='agent red']")
            browser.wait(f"{OUTPUT}.includes('(initial-fact)')")
            drag(browser, 0.5)
            browser.wait(f"Math.abs({STEP} - 300) <= 3")
            step = browser.value(STEP)
            browser.wait(f"{OUTPUT}.includes('(position {step / 10:.1f} ')")
            known = {f"{i:<8}{text}" for i, text in moment(page, step, "red")["mind"]["facts"]}
            check_equal(set(browser.value(OUTPUT).splitlines()), known, "its facts")
            browser.click("[data-view='Fired']")
            browser.wait(f"{OUTPUT}.includes('{step / 10:.1f} s')")
            drag(browser, 0.1)
            browser.wait(f"Math.abs({STEP} - 60) <= 3")
            browser.click("[data-view='Why']")
            browser.wait(f"{OUTPUT}.includes('rule ')")
            said = browser.value(OUTPUT)
            drag(browser, 0.3)
            browser.wait(f"{OUTPUT}.includes('rule ') && {OUTPUT} !== {json.dumps(said)}")
            drag(browser, 0.1)
            browser.wait(f"Math.abs({STEP} - 60) <= 3")
            browser.click("[data-tab=Mail]")
            browser.wait("document.querySelector('.log li')?.textContent.includes('mate-pos')")
            browser.click("#play")
            browser.wait(f"{STEP} > 75")
            browser.click("#play")
            browser.wait("document.getElementById('play').textContent === 'Play'")
            browser.click("[data-tab=Robots]")
            browser.wait("+document.querySelector('tbody tr').children[2].textContent > 0")
            check_equal(browser.said, [], "the page had no fault")


GROUND = "document.getElementById('ground').toDataURL()"


def test_trails_lead_to_where_the_slider_is():
    with recording_page("--duration", 60) as (page, _, _):
        with Browser(page.url) as browser:
            browser.wait(f"{STEP} === 0 && document.querySelectorAll('tbody tr').length === 4")
            drag(browser, 0.9)
            browser.wait(f"Math.abs({STEP} - 540) <= 3")
            far = browser.value(f"new Promise(r => setTimeout(() => r({GROUND}), 500))")
            browser.click("[data-tool=trails]")
            browser.wait(f"{GROUND} !== {json.dumps(far)}")
            browser.click("[data-tool=trails]")
            browser.wait(f"{GROUND} === {json.dumps(far)}")
            drag(browser, 0.2)
            browser.wait(f"{GROUND} !== {json.dumps(far)}")
            check_equal(browser.said, [], "the page had no fault")


def test_a_click_on_a_stall_says_why():
    with folder() as out:
        with recording_page(file=bump(out)) as (page, _, _):
            with Browser(page.url) as browser:
                browser.click(".stall")
                browser.wait(f"{OUTPUT}.includes('(goal ram)')")
                first = json.loads(page.ask("GET", "/recording").text)["stalls"][0][1]
                browser.wait(f"{STEP} === {first}")
                check_equal(browser.said, [], "the page had no fault")
