#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The house rules that a compiler cannot check.  `make tidy`; prints file:line: reason.

Floors are checked by calls, in the objects of a built tree: build/release, or build/$BUILD.

    tools/tidy.py                         all checks
    tools/tidy.py --floors [MODULE]       what modules that are not in order yet have left
    tools/tidy.py --graph [MODULE] [--dot]   which calls which: folders, or files of a module; for Graphviz
    tools/tidy.py --words [MODULE]        words of yesterday (docs/concepts.md) that are left
    tools/tidy.py --pointers              pointers through which a lower floor calls a higher one
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys

import arithmetic
import booleans
import floors
import graph
import words

ROOT = pathlib.Path(__file__).resolve().parent.parent
FUNCTION_LINES_MAX, FILE_LINES_MAX, LINE_CHARS_MAX, PARAMETERS_MAX = 70, 800, 100, 6

FILE_LINES = {"broker": 400, "bus": 400, "runtime": 400}  # where fewer are enough

# The modules that each may include.  Programs never see each other: they meet in idl/wire.idl alone.
MAY_INCLUDE = {
    "core": set(),
    "world": {"core"},
    "mcap": {"core"},
    "bus": {"core"},
    "faults": {"core", "bus"},
    "stats": {"core"},
    "runtime": {"core", "bus"},
    "broker": {"core", "bus"},
    "sim": {"core", "world", "bus", "mcap"},
    "planner": {"core", "world"},
    "mind": {"core", "world", "planner"},
    "agent": {"core", "world", "bus", "runtime", "mind", "planner"},
    "resolver": {"core", "bus", "runtime"},
    "host": {"core", "bus", "runtime", "agent", "mind"},
    "monitor": {"core", "bus", "runtime", "agent", "mind", "stats"},
    "story": {"core", "bus", "mcap"},
    "record": {"core", "bus", "mcap"},
    "replay": {"core", "bus", "mcap"},
    "experiment": {"core", "world"},
    "report": {"core", "world", "experiment", "stats"},
    "operator": {"core", "bus", "runtime"},
    "run": {"core", "world", "bus", "runtime", "experiment", "report", "mcap", "story", "operator"},
    "worldtool": {"core", "world", "bus", "experiment", "report", "operator"},
    "cli": {"core", "world", "bus", "runtime", "experiment", "report", "mcap", "story", "operator", "run", "worldtool", "stats"},
    "web": {"core", "bus", "runtime", "operator", "mcap", "story"},
}
# Foreign headers, and the only files that may include them.
ONLY_IN = {
    r"dds/": r"src/bus/",
    r"clips": r"src/mind/",
    r"ode/": r"src/sim/engine/ode_",
    r"ccd/": r"src/world/model/place",
    r"png\.h": r"src/world/parse/bitmap",
    r"histedit|editline": r"src/cli/terminal/console_edit",
    r"yaml\.h": r"src/experiment/yaml/",
    r"jansson\.h": r"src/report/summary",
    r"openssl/": r"src/sim/record/run_hash",
    r"zlib\.h": r"src/mcap/",
    r"sqlite3\.h": r"src/broker/node/disk",
    r"microhttpd\.h": r"src/web/server",
}
# Callbacks whose parameters a library prescribes.
PRESCRIBED = {"on_request"}
BANNED = r"\b(strcpy|strcat|sprintf|vsprintf|gets|atoi|atof|strtok|alloca)\s*\("
ALLOCATES = r"\b(malloc|calloc|realloc|strdup|strndup|asprintf|free|qsort|qsort_r)\s*\("
# What takes memory at start-up, and what gives the engine of a mind its own.
ALLOCATE = {"src/core/memory.c", "src/mind/engine/heap.c", "src/mind/engine/port.h"}
BUILD = ROOT / "build" / os.environ.get("BUILD", "release")
problems = []
left = []  # the same in modules that are being put in order
notes = []


def bad(path, line, why, module=None):
    where = left if module in floors.UNFINISHED else problems
    where.append(f"{path.relative_to(ROOT)}:{line}: {why}")


def check_lines(path, lines, module):
    rel = str(path.relative_to(ROOT))
    for n, line in enumerate(lines, 1):
        if len(line) > LINE_CHARS_MAX:
            bad(path, n, f"more than {LINE_CHARS_MAX} columns")
        if line.rstrip() != line or "\t" in line:
            bad(path, n, "tab or trailing space")
        code = re.sub(r'"(\\.|[^"\\])*"|//.*|/\*.*?\*/', "", line)
        if code.lstrip().startswith("*"):
            continue  # the middle of a comment
        if re.search(BANNED, code):
            bad(path, n, "banned function")
        if module and rel not in ALLOCATE and re.search(ALLOCATES, code):
            bad(path, n, "allocation outside core/memory.c: take it at start-up")
        if re.search(r"\bgoto\b", code):
            bad(path, n, "goto")


def check_includes(path, lines, module):
    rel = str(path.relative_to(ROOT))
    for n, line in enumerate(lines, 1):
        m = re.match(r'#include [<"]([^>"]+)[>"]', line)
        if not m or not rel.startswith("src/"):
            continue
        first = m[1].split("/")[0]
        if first in MAY_INCLUDE and first != module and first not in MAY_INCLUDE[module]:
            bad(path, n, f"{module} may not include {first}")
        for pattern, where in ONLY_IN.items():
            if re.match(pattern, m[1]) and not re.match(where, rel):
                bad(path, n, f"<{m[1]}> belongs in {where} only")
        above = floors.include_problem(rel, m[1])
        if above:
            bad(path, n, above[0], above[1])


def check_functions(path, text, lines, module):
    start = None
    for n, line in enumerate(lines, 1):
        if line == "{":
            start = n
        if line == "}" and start:
            if n - start - 1 > FUNCTION_LINES_MAX:
                bad(path, start, f"function longer than {FUNCTION_LINES_MAX} lines")
            start = None
    for m in re.finditer(r"^[a-z_][\w \*]*?\b([a-z_]\w*)\(([^;{}]*?)\)\n\{", text, re.M):
        at = text[: m.start()].count("\n") + 1
        many = m[2].count(",") >= PARAMETERS_MAX and "(" not in m[2]
        if many and m[1] not in PRESCRIBED:
            bad(path, at, f"{m[1]}: more than {PARAMETERS_MAX} parameters")
        shared = module and path.name != "main.c" and not m[0].startswith("static")
        stem = path.stem.split("_")[0]
        prefixes = ("mu_", stem, "__", "LLVM", *path.relative_to(ROOT).parts[1:-1])
        if shared and not m[1].startswith(prefixes) and not (path.parent.name == "faults" and m[1] in {"bind", "sendmsg"}):
            bad(path, at, f"{m[1]}: a shared name starts with mu_, {stem}_ or its folder")


def check(path):
    text = path.read_text()
    lines = text.splitlines()
    rel = path.relative_to(ROOT)
    module = rel.parts[1] if rel.parts[0] == "src" else None
    if "SPDX-License-Identifier" not in "".join(lines[:2]):
        bad(path, 1, "no SPDX licence in the first lines")
    most = FILE_LINES.get(module, FILE_LINES_MAX)
    if len(lines) > most:
        bad(path, len(lines), f"more than {most} lines")
    check_lines(path, lines, module)
    if path.suffix in (".c", ".h"):
        check_includes(path, lines, module)
        check_functions(path, text, lines, module)


def check_calls():
    """Floors by calls: needs objects of all sources."""
    calls = graph.Graph(ROOT, BUILD)
    if calls.stale:
        bad(BUILD, 1, f"{len(calls.stale)} of {len(calls.files)} objects are missing or older than their source "
                      f"({' '.join(calls.stale[:3])}): run `make`, then floors can be checked by calls")
        return
    for file, why, module in floors.call_problems(calls, MAY_INCLUDE):
        bad(ROOT / file, 1, why, module)
    notes.extend(floors.circles_gone(calls))
    for what, modules, is_known, edges in floors.circle_problems(calls):
        if not is_known:
            unfinished = modules & floors.UNFINISHED
            bad(ROOT / "src", 1, "\n    ".join([what, *edges]), min(unfinished) if unfinished else None)


def check_states():
    """The page of the state machines is that of the tables in the code."""
    maker, page = ROOT / "tools/states-reference", ROOT / "docs/reference/states.md"
    if page.exists() and subprocess.run([maker], capture_output=True, text=True, check=True).stdout != page.read_text():
        bad(page, 1, "is out of date: make docs")


def check_all():
    for folder in ("src", "include", "tests", "examples", "bench"):
        for path in sorted((ROOT / folder).rglob("*.[ch]")):
            check(path)
    for path, why, module in floors.pointer_problems(ROOT):
        bad(ROOT / path, 1, why, module)
    for path, why, module in floors.struct_problems(ROOT):
        bad(path, 1, why, module)
    for path, why in booleans.problems(ROOT):
        bad(path, 1, why)
    for path, n, word, term in words.hits(ROOT, words.CURED):
        bad(path, n, f"{word}: say {term} (docs/concepts.md)")
    said = words.persons(ROOT)
    for path, n, text in said if len(said) > words.PERSONS_MAX else []:
        bad(path, n, f"one of {len(said)} comments with who, nobody or he (at most {words.PERSONS_MAX}): {text}")
    for path, n, text in words.persons_of_pages(ROOT):
        bad(path, n, f"who, nobody and he are people: name the process, agent or program: {text}")
    for path, n, count, text in words.long_sentences(ROOT):
        bad(path, n, f"{count} words in a sentence (at most {words.SENTENCE_WORDS_MAX}): {text}")
    for path, why in arithmetic.problems(BUILD):
        bad(path, 1, why)
    check_states()
    check_calls()


def main():
    parser = argparse.ArgumentParser(usage=__doc__.split("\n\n", 1)[1])
    parser.add_argument("module", nargs="?", default="")
    for option in ("floors", "graph", "dot", "words", "pointers"):
        parser.add_argument("--" + option, action="store_true")
    asked = parser.parse_args()
    if asked.pointers:
        for path, holder, names in floors.pointers(ROOT):
            print(f"{path}: {holder}: {' '.join(names)}: {floors.POINTERS.get(holder, (0, '?'))[1]}")
        return False
    if asked.words:
        modules = {asked.module} if asked.module else floors.FLOORED - {"broker"}
        found = list(words.hits(ROOT, modules))
        for path, n, word, term in found:
            print(f"{path.relative_to(ROOT)}:{n}: {word} -> {term}")
        print(f"{len(found)} words in {len({path for path, *_ in found})} files")
        for path, n, text in words.persons(ROOT):
            print(f"{path.relative_to(ROOT)}:{n}: {text}")
        return False
    if asked.graph:
        calls = graph.Graph(ROOT, BUILD)
        print("\n".join((graph.dot if asked.dot else graph.text)(calls, asked.module)))
        return bool(calls.stale)
    check_all()
    if asked.floors:
        print("\n".join(line for line in left if f"src/{asked.module}" in line))
        return False
    for problem in problems:
        print(problem)
    if left:
        print(f"tidy: {len(left)} more in modules that are not in order yet: tools/tidy.py --floors")
    for note in notes:
        print(f"tidy: {note}")
    print(f"tidy: {len(problems)} problems" if problems else "tidy: ok")
    print(f"{int(not problems)} passed, {int(bool(problems))} failed")
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main())
