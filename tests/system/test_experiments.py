# SPDX-License-Identifier: Apache-2.0
"""The teaching experiments: each does what its page says, with more than one seed."""
import re

from support import ROOT, check, check_equal, experiment_run, folder, muster

EXPERIMENTS = ROOT / "experiments"
PAGES = ROOT / "docs/experiments"
TAUGHT = ("follow", "paper", "collect", "explore", "formation", "contract-net", "auction", "office", "platoon",
          "least-busy", "braitenberg", "broker-death")


def series(name, seeds, *words):
    with folder() as out:
        done = muster("run", EXPERIMENTS / f"{name}.yaml", "--seeds", seeds, "--out", out, *words,
                      timeout=300)
        check_equal(done.returncode, 0, f"{name}, seeds {seeds}: {done.stdout} {done.stderr}")


def test_each_has_a_page():
    table = (ROOT / "docs/experiments.md").read_text()
    for name in TAUGHT:
        page = (PAGES / f"{name}.md").read_text()
        check(f"muster run experiments/{name}.yaml" in page, f"the command in {name}.md")
        for part in ("What it shows", "What to look at", "What to change", "Questions for a class"):
            check(part in page, f"{part} in {name}.md")
        check(f"(experiments/{name}.md)" in table, f"{name} in docs/experiments.md")


def test_red_becomes_a_follower_in_each_of_the_papers_ways():
    """On the controller's console, on red's own, and by a fact and a global of red's."""
    text = (EXPERIMENTS / "paper.yaml").read_text().replace("../", f"{ROOT}/")
    text = text.replace("policy: ", f"policy: {EXPERIMENTS}/")
    line = 'do: controller, line: "(you-do red follow green)"'
    check(line in text, "the command")
    fact = "(progn (do-for-all-facts ((?g goal)) TRUE (retract ?g)) (assert (goal follow)) (bind ?*mate* green))"
    for way in (line, 'do: red, line: "(follow green)"', f'do: red, line: "{fact}"'):
        with folder() as out:
            (out / "way.yaml").write_text(text.replace(line, way))
            done = muster("run", out / "way.yaml", "--out", out / "r")
            check_equal(done.returncode, 0, f"{way}: {done.stdout} {done.stderr}")


def test_the_papers_controller_needs_the_trust_policy():
    with folder() as out:
        text = (EXPERIMENTS / "paper.yaml").read_text().replace("../", f"{ROOT}/").replace("policy: paper.policy\n", "")
        (out / "paper.yaml").write_text(text)
        done = muster("run", out / "paper.yaml", "--out", out / "r")
        check_equal(done.returncode, 1, f"no robot obeys: {done.stdout} {done.stderr}")


def test_explore():
    series("explore", "1..3")


def test_formation():
    series("formation", "1..2")


def test_contract_net():
    series("contract-net", "1..4")


def test_platoon():
    series("platoon", "1..3")


def test_least_busy():
    series("least-busy", "1..3")


def test_every_job_of_the_contract_net_is_done_once():
    with folder() as out:
        done = muster("run", EXPERIMENTS / "contract-net.yaml", "--out", out / "r")
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        jobs = re.findall(r"job (\d) is done by (\w+)", done.stderr)
        check_equal(sorted(job for job, _ in jobs), ["1", "2", "3", "4", "5"], "jobs")
        books = (out / "r/contracts.log").read_text()
        check_equal(sorted(re.findall(r"job-(\d) is done by (\w+)", books)), sorted(jobs),
                    "the monitor's books")
        check("5 jobs are done, 0 are under way" in books, books)
        check({who for _, who in jobs} <= {"blue", "green", "yellow"}, f"who did them: {jobs}")


def test_a_broker_dies_and_nobody_is_lost():
    with folder() as out:
        done, summary = experiment_run(out / "r", file=EXPERIMENTS / "broker-death.yaml")
        check_equal(done.returncode, 0, f"{done.stdout} {done.stderr}")
        check_equal([c["done"] for c in summary["chaos"]], [True], "the broker was killed")


def test_a_run_without_its_second_broker_does_not_go_on():
    """The expectation of broker-death can fail."""
    with folder() as out:
        text = (EXPERIMENTS / "broker-death.yaml").read_text().replace("../", f"{ROOT}/")
        check("brokers: [a, b]" in text, "two brokers")
        alone = out / "alone.yaml"
        alone.write_text(text.replace("brokers: [a, b]", "brokers: [a]"))
        done, summary = experiment_run(out / "r", file=alone)
        check_equal(done.returncode, 1, f"without a second broker: {done.stdout} {done.stderr}")
        mails = [e for e in summary["expectations"] if "mail_received" in e["text"]]
        check_equal([e["met"] for e in mails], [False], "mail that came")
