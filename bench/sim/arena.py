#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Writes an arena for many robots: arena.py ROBOTS [SEED].  The world comes on standard output.

A hall of 4 m x sqrt(robots) a side, a box or a pillar for every two robots, and robots w_0, w_1, ...
at places from the seed, each clear of all that is there already."""
import math
import random
import sys

ROBOT_M = 0.35  # what a robot is clear of, from its origin
LOOSE_M = 0.45  # way between two things


def head(side_m):
    return f"""# SPDX-License-Identifier: Apache-2.0
# Made by bench/sim/arena.py.
include "pioneer.inc"
define box model ( color "tan" )
define pillar model
(
  color "slategrey"
  block
  (
    points 16
{corners()}
    z [0 1]
  )
)
model ( name "hall" size [{side_m:.3f} {side_m:.3f} 0.8] boundary 1 color "black" )
"""


def corners():
    turns = [2 * math.pi * k / 16 for k in range(16)]
    return "\n".join(
        f"    point[{k}] [ {math.cos(a):.4f} {math.sin(a):.4f} ]" for k, a in enumerate(turns)
    )


class Places:
    """Places of a square hall, each clear of those that were given out before."""

    def __init__(self, side_m, dice):
        self.half_m, self.dice, self.taken = side_m / 2, dice, {}

    def cell(self, x_m, y_m):
        return math.floor(x_m / 3), math.floor(y_m / 3)

    def is_free(self, x_m, y_m, radius_m):
        column, row = self.cell(x_m, y_m)
        near = (
            other
            for c in range(column - 1, column + 2)
            for r in range(row - 1, row + 2)
            for other in self.taken.get((c, r), ())
        )
        return all(math.hypot(x_m - x, y_m - y) > radius_m + r + LOOSE_M for x, y, r in near)

    def take(self, radius_m):
        reach_m = self.half_m - radius_m - LOOSE_M
        while True:
            x_m, y_m = (round(self.dice.uniform(-reach_m, reach_m), 3) for _ in "xy")
            if self.is_free(x_m, y_m, radius_m):
                self.taken.setdefault(self.cell(x_m, y_m), []).append((x_m, y_m, radius_m))
                return x_m, y_m


def thing(places, dice, number):
    across_m, along_m = dice.uniform(0.3, 0.9), dice.uniform(0.3, 0.9)
    turn = dice.randrange(0, 180)
    if number % 2:
        along_m = across_m
    x_m, y_m = places.take(math.hypot(across_m, along_m) / 2)
    kind = "pillar" if number % 2 else "box"
    return (
        f'{kind} ( name "{kind}_{number}" pose [ {x_m} {y_m} 0 {turn} ]'
        f" size [{across_m:.3f} {along_m:.3f} 0.8] )"
    )


def robot(places, dice, number):
    x_m, y_m = places.take(ROBOT_M)
    return f'pioneer ( name "w_{number}" pose [ {x_m} {y_m} 0 {dice.randrange(-179, 181)} ] )'


def arena(robots, seed):
    dice = random.Random(seed)
    side_m = max(6.0, 4.0 * math.sqrt(robots))
    places = Places(side_m, dice)
    things = [thing(places, dice, k) for k in range((robots + 1) // 2)]
    crew = [robot(places, dice, k) for k in range(robots)]
    return head(side_m) + "\n".join(things + crew) + "\n"


if __name__ == "__main__":
    numbers = [int(word) for word in sys.argv[1:]]
    sys.stdout.write(arena(numbers[0], numbers[1] if len(numbers) > 1 else 1))
