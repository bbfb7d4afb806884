#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""make soak-engine: random programs print the same in the program clips and in a mind.

The programs are about joins, negations, multifields and globals over few values, so that a lot of it
matches, comes and goes.  tests/soak/engine.py [SEED [PROGRAMS]]
"""
import pathlib
import random
import subprocess
import sys
import tempfile

RUN = pathlib.Path(__file__).resolve().parent.parent / "rules" / "engine" / "run"
RELATIONS = {"a": 1, "b": 2, "c": 3}
VALUES = ["1", "2", "3", "1.0", "2.5", "-0.0", "0.0", "x", "y", '"x"', "-7", "1e10"]
FIRINGS = 150


def value(rng):
    return rng.choice(rng.values)


def variable(rng):
    return "?" + rng.choice("pqr")


def pattern(rng, bound):
    relation = rng.choice(list(RELATIONS) + ["t"])
    fields = []
    for _ in range(RELATIONS.get(relation, 1)):
        kind = rng.random()
        if kind < 0.6:
            field = variable(rng)
            bound.add(field)
        elif kind < 0.75:
            field = value(rng)
        elif kind < 0.85:
            field = "~" + value(rng)
        else:
            field = "?"
        fields.append(field)
    if relation == "t":
        return f"(t (s {fields[0]}) (m $? {rng.choice([value(rng), '?'])} $?))"
    end = rng.choice([[], [], ["$?"]])
    return f"({' '.join([relation, *fields, *end])})"


def conditions(rng):
    bound, lines = set(), []
    for i in range(rng.randint(1, 4)):
        kind = rng.random()
        if i == 0 or kind < 0.6:
            lines.append(pattern(rng, bound))
        else:
            word = "not" if kind < 0.85 else "exists"
            lines.append(f"({word} {pattern(rng, set())})")
    if bound and rng.random() < 0.4:
        lines.append(f"(test ({rng.choice(['eq', 'neq'])} {rng.choice(sorted(bound))} {value(rng)}))")
    return lines, sorted(bound)


def fact(rng, words):
    relation = rng.choice(list(RELATIONS) + ["t"])
    fields = [rng.choice(words) if words and rng.random() < 0.5 else value(rng)
              for _ in range(RELATIONS.get(relation, 1) + rng.randint(0, 1))]
    if relation == "t":
        return f"(t (s {fields[0]}) (m {' '.join(fields)}))"
    return f"({relation} {' '.join(fields)})"


def rule(rng, number):
    lines, bound = conditions(rng)
    held = rng.random() < 0.5
    actions = [f"(printout t r{number} {' '.join(bound)} crlf)"]
    actions += [f"(more (assert {fact(rng, bound)}))" for _ in range(rng.randint(0, 2))]
    actions += ["(retract ?f)"] if held else []
    rng.shuffle(actions)
    lines[0] = ("?f <- " if held else "") + lines[0]
    return "\n  ".join([f"(defrule r{number} (declare (salience {rng.randint(-2, 2)}))", *lines,
                        f"(test (< ?*n* {FIRINGS})) => (bind ?*n* (+ ?*n* 1))", *actions]) + ")"


def program(rng):
    rng.values = rng.sample(VALUES, 3)
    facts = "\n  ".join(fact(rng, []) for _ in range(rng.randint(8, 20)))
    rules = "\n".join(rule(rng, i) for i in range(rng.randint(3, 8)))
    return (f"(defglobal ?*n* = 0)\n(deftemplate t (slot s) (multislot m))\n"
            f"(deffunction more (?f) (bind ?*n* (+ ?*n* 1)) ?f)\n"
            f"(deffacts given\n  {facts})\n{rules}\n"
            f"(defrule last (declare (salience -9)) => (facts) (agenda))\n")


def main():
    rng = random.Random(int(sys.argv[1]) if len(sys.argv) > 1 else 1)
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 300
    with tempfile.TemporaryDirectory(prefix="muster-soak-") as name:
        path = pathlib.Path(name) / "random.clp"
        path.write_text("".join(f";;; program {i}\n{program(rng)}" for i in range(count)))
        return subprocess.run([RUN, path], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
