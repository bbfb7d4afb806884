# SPDX-License-Identifier: Apache-2.0
"""Completion in the real shells: bash, zsh and fish complete verbs, options, files and what lives."""
import os
import re
import shutil
import subprocess

import pytest

from support import (BIN, MUSTER, ROOT, Processes, Skip, check, check_equal, folder, members, muster,
                     new_domain, wait_for)
from terminal import Terminal

TRAVEL = ROOT / "experiments" / "travel.yaml"
PROMPT = "READY> "

# What is typed, and one that it becomes when TAB is pressed; or words of which each is offered.
COMPLETES = (
    ("muster comple", "muster completion "),
    ("muster help comple", "muster help completion "),
    ("muster run --dura", "muster run --duration"),
    ("muster run --see", ("--seed", "--seeds")),
    ("muster run --record ", ("none", "run", "full")),
    ("muster run -q --record f", "muster run -q --record full"),
    ("muster run follo", "muster run follow"),
    ("muster run my-", "muster run my-own.yaml"),
    ("muster run --seed 3 --quiet my-", "muster run --seed 3 --quiet my-own.yaml"),
    ("muster run --out fold", "muster run --out folder"),
    ("muster launch me north --rules my-", "muster launch me north --rules my-rules.clp"),
    ("muster verify my-", "muster verify my-run.mcap"),
    ("muster sim my-", "muster sim my-flat.world"),
    ("muster group mem", "muster group members "),
)
LIVE = (
    ("muster console gre", "muster console green"),
    ("muster wait green yel", "muster wait green yellow"),
    ("muster move green nor", "muster move green north"),
    ("muster do speci", "muster do special"),
    ("muster ps --domain ", "muster ps --domain {domain}"),
    ("muster console --domain {domain} gre", "muster console --domain {domain} green"),
)


def shell_of(name):
    path = shutil.which(name)
    if not path:
        raise Skip(f"no {name}")
    return path


class Shell:
    """A shell with a person at it: what it shows when TAB is pressed."""

    def __init__(self, name, home):
        environment = {"PATH": f"{BIN}:{os.environ['PATH']}", "HOME": str(home), "PS1": PROMPT}
        words = {"bash": ("--norc", "--noprofile", "-i"), "zsh": ("-f", "-i")}[name]
        self.terminal = Terminal(shell_of(name), *words, env=environment, columns=200)
        self.terminal.wait_for(PROMPT)
        prepare = {"bash": "bind 'set show-all-if-ambiguous on'; ",
                   "zsh": "autoload -Uz compinit; compinit -u -D; "}[name]
        self.terminal.do(f"cd {home}; {prepare}source <(muster completion {name}); echo OK''AY", "OKAY")
        self.terminal.wait_for(PROMPT, since=self.terminal.text.rfind("OKAY"))

    def clear(self):
        self.terminal.type("\x15\x0c")

    def tab(self, typed, becomes):
        since = len(self.terminal.text)
        listed = isinstance(becomes, tuple)
        self.terminal.type(typed + ("\t\t" if listed else "\t"))
        for word in becomes if listed else (becomes,):
            self.terminal.wait_for(word, since=since + (len(typed) if listed else 0))
        since = len(self.terminal.text)
        self.terminal.type("\x15\x0c")  # an empty line, on an empty screen
        self.terminal.wait_for(PROMPT, since=since)


class Fish:
    """Fish itself tells what it would offer."""

    def __init__(self, home):
        self.home = home
        self.script = home / "muster.fish"
        self.script.write_text(muster("completion", "fish").stdout)

    def clear(self):
        pass

    def tab(self, typed, becomes):
        environment = {**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}", "HOME": str(self.home)}
        done = subprocess.run([shell_of("fish"), "--no-config", "-c",
                               f"source {self.script}; complete -C '{typed}'"], cwd=self.home,
                              env=environment, capture_output=True, text=True, timeout=60)
        check_equal((done.returncode, done.stderr), (0, ""), typed)
        offered = [line.split("\t")[0].rstrip("/") for line in done.stdout.splitlines()]
        for word in becomes if isinstance(becomes, tuple) else (becomes.split()[-1],):
            check(word in offered, f"{typed}: {word} is not in {offered}")


def completes(shell, typed, becomes):
    for again in (True, True, False):  # a shell waits only so long for the names of agents
        try:
            return shell.tab(typed, becomes)
        except AssertionError:
            if not again:
                raise
            shell.clear()


def files_make(home):
    for name in ("my-own.yaml", "my-rules.clp", "my-run.mcap", "my-flat.world", "my-notes.txt"):
        (home / name).write_text("")
    (home / "folder").mkdir()


@pytest.mark.parametrize("name", ("bash", "zsh", "fish"))
def test_a_shell_completes(name):
    domain = new_domain()
    shell_of(name)
    with folder() as home, Processes() as processes:
        processes.start(MUSTER, "run", TRAVEL, "--rate", 1, "--duration", 300, "--out", home / "r",
                        "--domain", domain)
        files_make(home)
        shell = Fish(home) if name == "fish" else Shell(name, home)
        for typed, becomes in COMPLETES:
            completes(shell, typed, becomes)
        wait_for(lambda: {"green", "yellow", "north"} <= set(members(domain)), 30, "the run")
        for typed, becomes in LIVE:
            completes(shell, typed.format(domain=domain), becomes.format(domain=domain))


def test_scripts_have_every_verb_and_option():
    verbs = [line.split("\t")[0] for line in muster("--dump-verbs").stdout.splitlines()]
    check(len(verbs) > 30, f"verbs: {verbs}")
    scripts = {shell: muster("completion", shell).stdout for shell in ("bash", "zsh", "fish")}
    for verb in verbs:
        options = [line.split("\t")[0] for line in muster(verb, "--dump-options").stdout.splitlines()]
        check("help" in options, f"options of {verb}: {options}")
        part = {"bash": re.search(rf"^ +{verb}\) words=.*$", scripts["bash"], re.M)[0],
                "zsh": re.search(rf"^ +{verb}\)\n.*?;;", scripts["zsh"], re.M | re.S)[0],
                "fish": "\n".join(line for line in scripts["fish"].splitlines()
                                  if f"'__muster_in {verb}'" in line).replace("-l ", "--")}
        for option in options:
            for shell, text in part.items():
                check(re.search(rf"--{option}\b", text), f"{shell}: {verb} --{option}")


def test_words_of_a_kind():
    check("follow\tof muster" in muster("completion", "experiment").stdout.splitlines(), "experiments")
    check(re.search(r"^/.*/muster\.clp\t", muster("completion", "rules").stdout, re.M), "rules")
    nowhere = muster("completion", "agent", "--domain", new_domain())
    check_equal((nowhere.returncode, nowhere.stdout), (4, ""), "no broker")
    wrong = muster("completion", "csh")
    check_equal((wrong.returncode, wrong.stdout), (2, ""), "no such shell")
    check("expected bash, zsh or fish" in wrong.stderr, wrong.stderr)
