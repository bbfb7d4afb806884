# SPDX-License-Identifier: Apache-2.0
"""World files: muster world check, draw, import; other people's worlds in the simulator."""
import json
import math
import os
import pathlib
import shutil
import struct
import xml.etree.ElementTree
import zlib

from support import FOLLOW, ROOT, Skip, check, check_equal, experiment_run, folder, muster

ARENA = ROOT / "worlds" / "arena.world"


def stage_worlds():
    data = os.environ.get("MUSTER_TEST_DATA", "")
    found = sorted(pathlib.Path(data, "stage-worlds").glob("*.world")) if data else []
    if not found:
        raise Skip("no worlds of Stage: MUSTER_TEST_DATA names no folder with stage-worlds")
    return found


def check_lines(path, *words):
    done = muster("world", "check", path, "--json", *words)
    return done.returncode, [json.loads(line) for line in done.stdout.splitlines()]


def test_check_sums_a_world_up():
    done = muster("world", "check", ARENA)
    check_equal(done.returncode, 0, done.stderr)
    check("14.40 x 12.40 m" in done.stdout, done.stdout)
    code, lines = check_lines(ARENA)
    check_equal(code, 0, "the exit code")
    check_equal(len(lines), 1, "lines")
    check_equal(lines[0]["robots"], 4, "robots")
    check_equal(lines[0]["sonars"], 64, "sonars")
    check_equal(lines[0]["mistakes"], 0, "mistakes")


MISTAKEN = """\
define bot position ( size [0.4 0.4] lazer ( ) )
model ( name "hall" siez [9 9 1] size [8 8 1] boundary 1 )
bot ( name "red" pose [a 0 0 0] color "reed" )
bot ( name "all" pose [1 0 0 0] )
modle ( )
model ( size [1 1
bot ( name "blue" pose [2 2 0 0] velocity_bounds [1 2] mass -3 )
bot ( name "one" pose [-2 0 0 0] )
bot ( name "two" pose [-2 0.1 0 0] )
bot ( name "far" pose [99 0 0 0] )
"""


def test_check_names_every_mistake():
    with folder() as where:
        path = where / "bad.world"
        path.write_text(MISTAKEN.replace("model ( size [1 1\n", "\n"))
        code, lines = check_lines(path)
        check_equal(code, 3, "the exit code")
        mistakes = [(m["line"], m["column"], m["text"]) for m in lines if m["kind"] == "mistake"]
        for line, column, text in [(1, 38, "did you mean 'laser'?"), (2, 21, "mean 'size'?"),
                                   (3, 18, "found 'a'"), (3, 33, "did you mean 'red'?"),
                                   (4, 7, "reserved"), (5, 1, "did you mean 'model'?"),
                                   (7, 34, "expected 8 numbers"),
                                   (9, 1, "overlaps robot 'one'"), (10, 1, "outside")]:
            check(any(m[:2] == (line, column) and text in m[2] for m in mistakes),
                  f"{line}:{column} {text!r} in {mistakes}")
        check_equal(lines[-1]["kind"], "world", "the last line")
        check_equal(lines[-1]["mistakes"], len(mistakes), "the count")
        done = muster("world", "check", path)
        check_equal(done.returncode, 3, "the exit code")
        check(f"{path}:5:1: " in done.stdout, done.stdout)


def test_check_goes_on_behind_a_mistake_of_grammar():
    with folder() as where:
        path = where / "bad.world"
        path.write_text(MISTAKEN)
        code, lines = check_lines(path)
        check_equal(code, 3, "the exit code")
        check(any(m.get("line") == 7 and "expected a number" in m["text"] for m in lines), lines)
        check(any(m.get("line") == 9 and "overlaps" in m["text"] for m in lines), lines)
        path.write_text("model ( \n model ( size [1 1]\n")
        code, lines = check_lines(path)
        check_equal(len([m for m in lines if m["kind"] == "mistake"]), 1, "mistakes")
        none = muster("world", "check", where / "nowhere.world")
        check_equal(none.returncode, 3, "no file")
        check(none.stdout.startswith(f"{where}/nowhere.world: cannot read"), none.stdout)
        check_equal(muster("world", "check").returncode, 2, "no file named")
        check_equal(muster("world", "chek", path).returncode, 2, "no such word")


def test_check_warns_of_what_is_left_out():
    """Also when it is a definition's."""
    with folder() as where:
        path = where / "a.world"
        path.write_text("define crate model ( movable 1 size [1 1 1]\n model ( ) )\ncrate ( )\n")
        code, lines = check_lines(path)
        check_equal(code, 0, lines)
        check_equal([m["kind"] for m in lines], ["warning", "world"], "lines")
        check_equal(lines[0]["line"], 2, "where")
        check("left out" in lines[0]["text"], lines)


def test_draw_is_a_picture():
    with folder() as where:
        out = where / "arena.svg"
        check_equal(muster("world", "draw", ARENA, "--out", out).returncode, 0, "draw")
        text = out.read_text()
        xml.etree.ElementTree.fromstring(text)
        for name in ["red", "blue", "green", "yellow"]:
            check(f">{name}</text>" in text, name)
        check_equal(muster("world", "draw", ARENA).stdout, text, "the same on standard output")
        bad = muster("world", "draw", where / "none.world", "--out", where / "none.svg")
        check_equal(bad.returncode, 3, "no world")
        check_equal(sorted(p.name for p in where.iterdir()), ["arena.svg"], "files")
        check_equal(muster("world", "draw", ARENA, "--out", where / "no/a.svg").returncode, 9,
                    "no such folder")


def test_draw_shows_what_is_white_and_what_a_finder_sees():
    with folder() as where:
        path = where / "a.world"
        path.write_text('model ( size [4 4 1] boundary 1 )\nmodel ( size [1 1 1] color "white" )\n'
                        'position ( pose [1 1 0 0] fiducial ( ) )\n')
        text = muster("world", "draw", path).stdout
        check('fill="#ffffff" stroke="#999999"' in text, "a line around what is white")
        plain = path.read_text().replace("fiducial ( )", "")
        path.write_text(plain)
        less = muster("world", "draw", path).stdout
        check_equal(text.count("<path"), less.count("<path") + 1, "a field of view")


def test_what_is_no_file_stays_what_it_is():
    """A file that is written takes the place of a file, but not that of a device or a link."""
    with folder() as where:
        full = where / "full"
        full.symlink_to("/dev/full")
        done = muster("world", "draw", ARENA, "--out", full)
        check_equal(done.returncode, 9, "a full device")
        check("No space left" in done.stderr, done.stderr)
        check(full.is_symlink(), "the link is still one")
        link = where / "link.svg"
        link.symlink_to("picture.svg")
        for _ in range(2):
            check_equal(muster("world", "draw", ARENA, "--out", link).returncode, 0, "a link")
        check(link.is_symlink(), "the link is still one")
        check((where / "picture.svg").read_text().startswith("<svg"), "what it leads to")
        check_equal(sorted(p.name for p in where.iterdir()), ["full", "link.svg", "picture.svg"],
                    "files")


MAP = """\
image: map.pgm
resolution: 0.5
origin: [1.0, 2.0, {yaw}]
negate: {negate}
occupied_thresh: 0.65
free_thresh: 0.196
"""


def map_write(where, yaw=0, negate=0):
    """4 x 2 pixels: the upper left one is occupied, the next one unknown, the others free."""
    (where / "map.yaml").write_text(MAP.format(yaw=yaw, negate=negate))
    greys = [0, 205, 254, 254, 254, 254, 254, 254]
    if negate:
        greys = [255 - g for g in greys]
    (where / "map.pgm").write_bytes(b"P5\n4 2\n255\n" + bytes(greys))


def test_import_of_a_map():
    with folder() as where:
        for negate in 0, 1:
            map_write(where, negate=negate)
            out = where / "map.world"
            done = muster("world", "import", where / "map.yaml", "--out", out)
            check_equal(done.returncode, 0, done.stderr)
            check('bitmap "map.pgm"' in out.read_text(), out.read_text())
            code, lines = check_lines(out)
            check_equal((code, lines[-1]["obstacles"]), (0, 1), lines)
            for key, want in [("min_x_m", 1), ("max_x_m", 1.5), ("min_y_m", 2.5), ("max_y_m", 3)]:
                check(abs(lines[-1][key] - want) < 1e-9, f"{key}: {lines[-1]}")
        # Elsewhere the picture is called by its whole path; turned by a quarter, left is below.
        map_write(where, yaw=math.pi / 2)
        elsewhere = where / "elsewhere"
        elsewhere.mkdir()
        for words in [["--out", elsewhere / "m.world"], []]:
            done = muster("world", "import", where / "map.yaml", *words)
            if not words:
                (elsewhere / "m.world").write_text(done.stdout)
            code, lines = check_lines(elsewhere / "m.world")
            check_equal(code, 0, lines)
            for key, want in [("min_x_m", 0), ("max_x_m", 0.5), ("min_y_m", 2), ("max_y_m", 2.5)]:
                check(abs(lines[-1][key] - want) < 1e-9, f"{key}: {lines[-1]}")


def test_import_says_what_is_wrong_with_a_map():
    with folder() as where:
        for old, new, says in [("map.pgm", "none.pgm", "1:8: cannot read the picture"),
                               ("0.5", "fast", "2:13: expected 'resolution'"),
                               ("[1.0, 2.0, 0]", "[1.0]", "expected 'origin'"),
                               ("negate: 0", "mode: raw", "4:7: expected a mode"),
                               ("free_thresh: 0.196", "free_thresh: 0.9", "6:14: expected"),
                               ("0.65\nfree_thresh: 0.196", "0.1", "1:1: expected 'free_thresh'"),
                               ("image", ": [", ":")]:
            map_write(where)
            path = where / "map.yaml"
            path.write_text(path.read_text().replace(old, new))
            done = muster("world", "import", path, "--out", where / "map.world")
            check_equal(done.returncode, 3, f"{new}: {done.stderr}")
            check(f"{path}:" in done.stderr and says in done.stderr, done.stderr)
            check(not (where / "map.world").exists(), "nothing is left behind")


def png_chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, depth, color, rows, interlaced=0, extra=b""):
    """A PNG picture of rows of bytes, each as the format has it; interlaced ones are 1 x 1."""
    head = struct.pack(">IIBBBBB", width, height, depth, color, 0, 0, interlaced)
    data = zlib.compress(b"".join(b"\0" + bytes(row) for row in rows))
    return (b"\x89PNG\r\n\x1a\n" + png_chunk(b"IHDR", head) + extra + png_chunk(b"IDAT", data) +
            png_chunk(b"IEND", b""))


def obstacles_of(where, picture):
    """The exit code of a check of a floor plan, and how many pieces it has or what is wrong."""
    (where / "plan.png").write_bytes(picture)
    world = where / "plan.world"
    world.write_text('model (\n  size [2 1 1] bitmap "plan.png" )\n')
    code, lines = check_lines(world)
    if code == 0:
        return code, lines[-1]["obstacles"]
    check((lines[0]["line"], lines[0]["column"]) in [(1, 1), (2, 16)], lines)
    return code, lines[0]["text"]


def test_every_kind_of_png_is_read():
    """Two pixels, black and white, in all the ways that PNG has for them."""
    black, white = [0], [255]
    palette = png_chunk(b"PLTE", bytes([255, 255, 255, 0, 0, 0]))
    kinds = {
        "1 bit": png(2, 1, 1, 0, [[0x40]]), "2 bits": png(2, 1, 2, 0, [[0x30]]),
        "8 bits": png(2, 1, 8, 0, [black + white]),
        "16 bits": png(2, 1, 16, 0, [black * 2 + white * 2]),
        "colours": png(2, 1, 8, 2, [black * 3 + white * 3]),
        "16 bits of colours": png(2, 1, 16, 2, [black * 6 + white * 6]),
        "a palette": png(2, 1, 8, 3, [[1, 0]], extra=palette),
        "alpha": png(2, 1, 8, 4, [black + white + black * 2]),  # what is transparent is no wall
        "colours and alpha": png(2, 1, 8, 6, [black * 3 + white + black * 4]),
        "interlaced": png(2, 1, 8, 0, [black, white], interlaced=1),
    }
    with folder() as where:
        for kind, picture in kinds.items():
            check_equal(obstacles_of(where, picture), (0, 1), kind)


def test_bad_pictures_are_named():
    good = png(2, 1, 8, 0, [[0, 255]])
    long = png(64, 64, 8, 0, [[(x * y * 7919) % 256 for x in range(64)] for y in range(64)])
    huge = png(50000, 50000, 8, 0, [[0]])
    large = png(16000, 16000, 1, 0, [[0]])  # 32 MB as it is packed, 256 MB unpacked
    holes = png(1024, 1024, 8, 0, [[0, 255] * 512, [255, 0] * 512] * 512)
    with folder() as where:
        for picture, says in [(huge, "too large"), (large, "too large"), (good[:40], "PNG"),
                              (long[:-500], "damaged"), (b"", "neither"), (good[1:], "neither"),
                              (good.replace(b"IDAT", b"IDXT"), "PNG"),
                              (png(0, 0, 8, 0, []), "PNG"), (holes, "more than 65536 obstacles")]:
            code, text = obstacles_of(where, picture)
            check_equal(code, 3, f"{says}: {text}")
            check(says in text, f"{says}: {text}")


def test_too_many_things_are_refused():
    with folder() as where:
        world = where / "many.world"
        world.write_text("define p model ( movable 1 )\n" + "p ( )\n" * 100000)
        code, lines = check_lines(world)
        check_equal(code, 3, lines[-1])
        check(lines[0]["line"] == 4098 and "more than 4096" in lines[0]["text"], lines[0])
        world.write_text("define p position ( )\n" + "p ( )\n" * 100000)
        code, lines = check_lines(world)
        check(code == 3 and "more than 1024 robots" in lines[0]["text"], lines[0])


def test_import_of_stage_worlds_keeps_what_counts():
    with folder() as where:
        for world in stage_worlds():
            out = where / world.name
            done = muster("world", "import", world, "--out", out)
            check_equal(done.returncode, 0, done.stderr)
            check("include" not in out.read_text(), "one file")
            (code, ours), (_, theirs) = check_lines(out), check_lines(world)
            check_equal(code, 0, ours)
            for key in theirs[-1]:
                if key not in ("file", "warnings"):
                    check_equal(ours[-1][key], theirs[-1][key], f"{world.name}: {key}")


DRIVE = """\
world: {world}
duration: {seconds}
robots:
  - {{name: {robot}, rules: drive.clp}}
observer:
  - {{at: 0, do: {robot}, line: "(run)"}}
"""


def picture(path):
    """What a world looks like, without its name."""
    done = muster("world", "draw", path)
    check_equal(done.returncode, 0, done.stderr)
    return done.stdout.split("</title>", 1)[1]


def test_import_changes_nothing_that_can_be_seen():
    corpus = ROOT / "tests" / "corpus" / "world"
    worlds = [w for w in sorted(corpus.glob("*.world")) if w.name != "mistakes.world"]
    worlds += sorted((ROOT / "worlds").glob("*.world"))
    check(len(worlds) >= 6, worlds)
    with folder() as where:
        for world in worlds:
            out = where / world.name
            done = muster("world", "import", world, "--out", out)
            check_equal(done.returncode, 0, done.stderr)
            check(picture(out) == picture(world), f"{world.name} looks different")


def world_drive(path, seconds):
    """Drives the world's first robot in the real programs.  Gives the rows of its track."""
    with folder() as where:
        robot = first_robot(path)
        (where / "drive.clp").write_text(
            "(defrule drive (position ?t $?) => (setSpeed 200 20) (update-sensors))\n")
        experiment = where / "drive.yaml"
        experiment.write_text(DRIVE.format(world=path, seconds=seconds, robot=robot))
        done, _ = experiment_run(where / "out", file=experiment)
        check_equal(done.returncode, 0, f"{path}: {done.stderr}")
        rows = [line.split(",") for line in (where / "out/run.csv").read_text().splitlines()[1:]]
        return [row for row in rows if row[1] == robot]


def first_robot(path):
    text = muster("world", "draw", path).stdout
    names = [e.text for e in xml.etree.ElementTree.fromstring(text).iter()
             if e.tag.endswith("text") and e.get("paint-order") == "stroke"]
    return names[0]


def test_a_robot_drives_in_every_world_of_stage():
    for world in stage_worlds():
        rows = world_drive(world, 10)
        check(len(rows) >= 90, f"{world.name}: {len(rows)} rows")
        xs = [(float(row[2]), float(row[3])) for row in rows]
        moved = max(math.dist(xs[0], p) for p in xs)
        check(moved > 0.2, f"{world.name}: it moved by {moved:.2f} m")


def test_the_hash_knows_nothing_of_the_file():
    with folder() as where:
        other = where / "a-folder-with-a-longer-name"
        other.mkdir()
        for name in ["arena.world", "pioneer.inc"]:
            shutil.copy(ROOT / "worlds" / name, other / name)
        (other / "arena.world").rename(other / "hall.world")
        text = pathlib.Path(FOLLOW).read_text()
        line = next(line for line in text.splitlines() if line.startswith("world:"))
        copy = where / "renamed.yaml"
        text = text.replace(line, f"world: {other / 'hall.world'}")
        copy.write_text(text.replace("../rules/", f"{ROOT}/rules/"))
        done, ours = experiment_run(where / "one", "--duration", 10, file=copy)
        check(done.returncode in (0, 1), done.stderr)
        _, theirs = experiment_run(where / "two", "--duration", 10)
        check_equal(ours["hash"], theirs["hash"], "the hash")
