# SPDX-License-Identifier: Apache-2.0
"""tools/grade: homeworks become marks."""
import csv
import os
import subprocess

from support import BIN, ROOT, check, check_equal, folder

TASK = f"""
name: task
world: {ROOT}/worlds/arena.world
duration: 20
robots:
  - {{name: red, rules: {ROOT}/rules/patrol.clp}}
expect:
  - {{inside: arena}}
  - {{statistic: red.distance_m, at_least: 5}}
"""
PATROL = (ROOT / "rules/patrol.clp").read_text()
HOMEWORKS = {
    "anna": PATROL,
    "bert": PATROL.replace("(setSpeed 300 0)", "(setSpeed 50 0)"),
    "carl": "; all mine\n" + PATROL.replace("  (setSpeed 300 0)", "      (setSpeed 300 0) ; fast"),
    "dora": PATROL + "\n(defrule broken\n",
    "emil": None,
    "fred": "(deffacts speeds (speed fast))\n(defrule wrong (declare (salience 9)) (speed ?v) => (setSpeed ?v 0))\n" + PATROL,
}


def grade(out, *words):
    for student, rules in HOMEWORKS.items():
        (out / "homeworks" / student).mkdir(parents=True, exist_ok=True)
        if rules:
            (out / "homeworks" / student / "red.clp").write_text(rules)
    (out / "task.yaml").write_text(TASK)
    (out / "secret").write_text("room 12\n")
    environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}
    done = subprocess.run([ROOT / "tools/grade", out / "task.yaml", out / "homeworks", "--out", out / "marks", *words],
                          env=environment, capture_output=True, text=True, check=False, timeout=120)
    rows = {}
    if done.returncode == 0:
        with open(out / "marks/marks.csv", newline="", encoding="utf-8") as file:
            rows = {row["student"]: row for row in csv.DictReader(file)}
    return done, rows


def test_homeworks_become_marks():
    with folder() as out:
        done, rows = grade(out, "--secret", out / "secret", "--count", "2", "--weights", "1,3")
        check_equal(done.returncode, 0, done.stderr)
        check_equal({name: row["mark"] for name, row in rows.items()},
                    {"anna": "100.0", "bert": "25.0", "carl": "100.0", "dora": "0.0", "emil": "0.0", "fred": "100.0"}, "marks")
        check_equal({name: row["same_as"] for name, row in rows.items() if row["same_as"]}, {"carl": "anna"}, "copies")
        check_equal(rows["bert"]["red.distance_m at least 5"], "0", "runs in which bert went far enough")
        check_equal(rows["bert"]["no robot outside the arena"], "2", "runs in which bert stayed inside")
        check("red.clp:" in rows["dora"]["remark"], f"dora's mistake: {rows['dora']}")
        check(rows["fred"]["remark"].startswith("red: rule wrong (red.clp:2): "), f"fred's mistake: {rows['fred']}")
        check_equal(rows["anna"]["remark"], "", "of rules without a mistake")
        check("no red.clp" in rows["emil"]["remark"], f"emil: {rows['emil']}")
        runs = sorted(p.name for p in (out / "marks/anna").iterdir())
        check_equal(runs, sorted(p.name for p in (out / "marks/bert").iterdir()), "seeds of two students")
        check_equal(len(runs), 2, "seeds")


def test_what_cannot_be_graded_is_said():
    with folder() as out:
        done, _ = grade(out)
        check_equal(done.returncode, 2, "neither seeds nor a secret")
        check("--seeds" in done.stderr, done.stderr)
        done, _ = grade(out, "--seeds", "1", "--weights", "1,2,3")
        check(done.returncode == 1 and "3 weights for 2" in done.stderr, f"weights: {done}")
        for words, says in ((("--seeds", "1..x"), "--seeds such as"), (("--seeds", "3..1"), "no seed in 3..1"),
                            (("--seeds", "1", "--weights", "one"), "--weights such as"),
                            (("--seeds", "1", "--weights", "0,0"), "one is more"),
                            (("--secret", out / "nowhere"), "nowhere: No such file")):
            done, _ = grade(out, *words)
            check(done.returncode in (1, 2) and says in done.stderr, f"{words}: {done}")
            check("Traceback" not in done.stderr, done.stderr)
