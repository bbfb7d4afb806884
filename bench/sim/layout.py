#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""One scene for every simulator: a square arena, boxes and cylinders at random, robots at random.

bench/sim/layout.py ROBOTS SEED FOLDER writes ROBOTS.csv and ROBOTS.world.  The arena's side is 4 m
times the square root of the number of robots, so that 10 and 1,000 robots meet as often; there are
9 obstacles on 100 square metres, every second one round.  Nothing touches anything at the start.

The lines of the table: arena,SIDE  box,X,Y,LENGTH,WIDTH,DEGREES  disc,X,Y,RADIUS  robot,X,Y,DEGREES
"""
import math
import pathlib
import random
import sys

PER_M2 = 0.09
ROBOT_LENGTH, ROBOT_WIDTH = 0.44, 0.38
ROBOT_REACH = math.hypot(ROBOT_LENGTH, ROBOT_WIDTH) / 2
TRIES = 10000
PIONEER = pathlib.Path(__file__).resolve().parent.parent.parent / "worlds" / "pioneer.inc"


class Places:
    """Free places for circles, found by trying; cells of 2 m keep that quick."""

    def __init__(self, side, dice):
        self.side, self.dice, self.cells = side, dice, {}

    def _cell(self, x, y):
        return int(x // 2), int(y // 2)

    def _is_free(self, x, y, reach, gap):
        cx, cy = self._cell(x, y)
        return all(math.hypot(x - ox, y - oy) > reach + other + gap
                   for i in (-1, 0, 1) for j in (-1, 0, 1)
                   for ox, oy, other in self.cells.get((cx + i, cy + j), ()))

    def take(self, reach, gap):
        half = self.side / 2 - reach - 0.3
        for _ in range(TRIES):
            x, y = self.dice.uniform(-half, half), self.dice.uniform(-half, half)
            if self._is_free(x, y, reach, gap):
                self.cells.setdefault(self._cell(x, y), []).append((x, y, reach))
                return x, y
        sys.exit(f"layout: no room in an arena of {self.side:g} m")


def lines(robots, seed):
    dice = random.Random(seed)
    side = 4 * math.sqrt(robots)
    places = Places(side, dice)
    yield "arena", side
    for k in range(round(PER_M2 * side * side)):
        if k % 2:
            radius = dice.uniform(0.1, 0.4)
            yield "disc", *places.take(radius, 0.7), radius
        else:
            length, width = dice.uniform(0.3, 1.1), dice.uniform(0.3, 1.1)
            yield ("box", *places.take(math.hypot(length, width) / 2, 0.7), length, width,
                   dice.uniform(0, 360))
    for _ in range(robots):
        yield "robot", *places.take(ROBOT_REACH, 0.05), dice.uniform(0, 360)


ROUND = "define round model ( block ( points 16 " + " ".join(
    f"point[{k}] [ {math.cos(k * math.pi / 8):.4f} {math.sin(k * math.pi / 8):.4f} ]"
    for k in range(16)) + " ) )\n"


def world(rows, seed):
    text = [f'include "{PIONEER}"\nseed {seed}\n', ROUND]
    text.append("define wanderer pioneer ( origin [0 0 0 0]\n"
                "  ranger ( sensor ( range [0 8] fov 180 samples 180 ) ) )\n")
    robots = 0
    for kind, *v in rows:
        if kind == "arena":
            text.append(f"model ( name \"arena\" size [{v[0]!r} {v[0]!r} 1] boundary 1 )\n")
        elif kind == "box":
            text.append(f"model ( pose [{v[0]!r} {v[1]!r} 0 {v[4]!r}] size [{v[2]!r} {v[3]!r} 1] )\n")
        elif kind == "disc":
            text.append(f"round ( pose [{v[0]!r} {v[1]!r} 0 0] size [{2 * v[2]!r} {2 * v[2]!r} 1] )\n")
        else:
            text.append(f'wanderer ( name "w_{robots}" pose [{v[0]!r} {v[1]!r} 0 {v[2]!r}] )\n')
            robots += 1
    return "".join(text)


def write(robots, seed, folder):
    """@return the table's and the world's path"""
    rows = list(lines(robots, seed))
    table = pathlib.Path(folder) / f"{robots}.csv"
    table.write_text("".join(f"{kind},{','.join(repr(v) for v in values)}\n"
                             for kind, *values in rows))
    file = table.with_suffix(".world")
    file.write_text(world(rows, seed))
    return table, file


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit("usage: bench/sim/layout.py ROBOTS SEED FOLDER")
    print(*write(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3]), sep="\n")
