# SPDX-License-Identifier: Apache-2.0
"""What is written is true: generated pages, commands of the README, links."""
import ast
import contextlib
import os
import re
import shutil
import signal
import subprocess
import tempfile

import pytest

from support import BIN, BUILD, ROOT, check, check_equal, folder

SKIPPED = {".git", "build", "out", "mine", "__pycache__"}
# Commands, and what a page says that they print.
BLOCK = re.compile(r"^<!-- (test|then) -->\n```sh\n(.*?)^```$"
                   r"(?:\n+<!-- shows -->\n```\n(.*?)^```$)?", re.M | re.S)


def pages():
    for path in sorted(ROOT.rglob("*.md")):
        if not SKIPPED & set(path.relative_to(ROOT).parts):
            yield path


def test_generated_pages_are_up_to_date():
    with folder() as out:
        subprocess.run([ROOT / "tools/make-reference", BIN, out], check=True, timeout=60)
        made = sorted(p.relative_to(out) for p in out.rglob("*") if p.is_file())
        check(len(made) >= 9, f"pages: {made}")
        for name in made:
            check((ROOT / "docs" / name).exists(), f"docs/{name} is missing: make docs")
            check((out / name).read_bytes() == (ROOT / "docs" / name).read_bytes(),
                  f"docs/{name} is out of date: make docs")
        for page in ("reference/*.md", "man/*.1"):
            for path in (ROOT / "docs").glob(page):
                check(path.relative_to(ROOT / "docs") in made or "Made by" not in path.read_text(),
                      f"nothing makes {path}")


def test_every_verb_and_option_is_in_a_man_page():
    text = "".join(p.read_text() for p in (ROOT / "docs/man").glob("*.1")).replace("\\-", "-")
    helps = subprocess.run([BIN / "muster", "--help"], capture_output=True, text=True, check=True)
    verbs = re.findall(r"^  ([a-z]+) ", helps.stdout, re.M)
    check(len(verbs) >= 12, f"verbs: {verbs}")
    for verb in verbs:
        check(re.search(rf"^\.B {verb}\b", text, re.M), f"{verb} is in no man page")
        said = subprocess.run([BIN / "muster", verb, "--help"], capture_output=True, text=True,
                              check=True).stdout
        for option in re.findall(r"^  .{4}(--[a-z-]+)", said, re.M):
            check(option in text, f"{verb} {option} is in no man page")


def test_the_library_page_names_every_call_and_its_outcomes():
    page = (ROOT / "docs/reference/library.md").read_text()
    sections = {}
    for section in re.split(r"^#+ ", page, flags=re.M):
        for name in section.split("\n", 1)[0].split(", "):
            sections[name] = section
    headers = re.findall(r'^#include "(muster/\w+\.h)"',
                         (ROOT / "include/muster/muster.h").read_text(), re.M)
    count = 0
    for header in headers:
        text = re.sub(r"/\*.*?\*/", "", (ROOT / "include" / header).read_text(), flags=re.S)
        text = re.sub(r"^#.*(\\\n.*)*$", "", text, flags=re.M)
        for type_name, name in re.findall(r"([\w ]+[ *]+)(mu_\w+)\([^;{]*\);", text):
            count += 1
            check(name in sections, f"{header}: {name} is not in library.md: make docs")
            said = sections[name].split("```")[2]
            check(said.strip(), f"{header}: nothing is said of {name}")
            if "mu_result " in type_name and name != "mu_fault_trace":
                check("MU_" in said or "as `mu_" in said, f"{header}: the outcomes of {name}")
    check(count >= 30, f"only {count} calls looked at")


def block_run(text, where, environment):
    """Runs a block as a person would type it; its processes end with it."""
    with tempfile.TemporaryFile("w+") as output:
        p = subprocess.Popen(["bash", "-euo", "pipefail", "-c", text], cwd=where, env=environment,
                             stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT,
                             start_new_session=True)
        try:
            p.wait(120)
        finally:
            with contextlib.suppress(ProcessLookupError):
                os.killpg(p.pid, signal.SIGKILL)
            p.wait()
        output.seek(0)
        return p.returncode, output.read()


def chapters():
    """Blocks of all pages that tests run.  A block `then` goes on in the folder of the one before."""
    for page in pages():
        found = []
        for n, m in enumerate(BLOCK.finditer(page.read_text())):
            kind, block, shown = m.groups()
            if kind == "then":
                found[-1].append((block, shown))
            elif kind == "test":
                found.append([(block, shown)])
        for n, chapter in enumerate(found):
            yield pytest.param(chapter, id=f"{page.relative_to(ROOT).with_suffix('')}-{n}")


def shows(output, line, start):
    """Where a line of the page ends in the output, from there on, or None.  `...` stands for anything."""
    found = re.compile("^" + ".*".join(re.escape(part) for part in line.split("...")) + "$", re.M).search(output, start)
    return found and found.end()


@pytest.mark.parametrize("chapter", chapters())
def test_commands_of_the_pages(chapter):
    with folder() as out:
        here = out / "muster"
        here.mkdir()
        for path in ROOT.iterdir():
            if path.name not in SKIPPED - {"build"}:
                copied = path.name in ("experiments", "worlds", "rules")  # with ../ in their paths
                shutil.copytree(path, here / path.name) if copied else (here / path.name).symlink_to(path)
        environment = {k: v for k, v in os.environ.items() if not k.startswith("MUSTER_")}
        environment |= {"PATH": f"{BIN}:{os.environ['PATH']}", "DEPS": "skip", "BUILD": BUILD.name,
                        "XDG_STATE_HOME": str(out / "state")}
        for block, shown in chapter:
            code, output = block_run(block, here, environment)
            check_equal(code, 0, f"this block:\n{block}printed\n{output}")
            for report in re.findall(r"--out (\S+)", block):
                check((here / report).exists(), f"{report}, of this block:\n{block}")
            at = 0  # lines stand in the order in which the page shows them
            for line in (shown or "").splitlines():
                at = at if line == "..." else shows(output, line, at)
                check(at is not None, f"{line}\nis not there, or earlier, in what\n{block}printed:\n{output}")


def test_blocks_that_run_at_the_same_time_have_domains_of_their_own():
    seen = {}
    for page in pages():
        for domain in set(re.findall(r"export MUSTER_DOMAIN=(\d+)", page.read_text())):
            check(domain not in seen, f"domain {domain} is that of {page} and of {seen.get(domain)}")
            seen[domain] = page
    check(len(seen) > 10, f"only {len(seen)} domains")


def test_every_command_of_the_pages_is_run_or_says_why_not():
    for page in pages():
        for before, line in re.findall(r"^(.*)\n```sh\n(.*)$", page.read_text(), re.M):
            check(re.fullmatch(r" *<!-- (test|then|not run: .+) -->", before),
                  f"{page.relative_to(ROOT)}: {line}: <!-- test --> or <!-- not run: reason --> stands above")


def links(text):
    """Where links point, apart from code, where brackets mean something else."""
    text = re.sub(r"^ *```.*?^ *```", "", text, flags=re.M | re.S)
    text = re.sub(r"`[^`\n]*`", "", text)
    return re.findall(r"\]\(([^)\s]+)\)", text)


def heading_anchors(text):
    for heading in re.findall(r"^#+ (.*)$", text, re.M):
        yield re.sub(r"[^a-z0-9 _-]", "", heading.lower()).replace(" ", "-")


def test_every_relative_link_resolves():
    count = 0
    for page in pages():
        for link in links(page.read_text()):
            if re.match(r"[a-z]+:", link):
                continue
            count += 1
            file, _, anchor = link.partition("#")
            target = page.parent / file if file else page
            check(target.exists(), f"{page.relative_to(ROOT)}: {link}")
            if anchor and target.suffix == ".md":
                check(anchor in heading_anchors(target.read_text()),
                      f"{page.relative_to(ROOT)}: {link}: no such heading")
    check(count > 30, f"only {count} links looked at")


def named(text):
    """What a page names in backticks, apart from blocks of code."""
    return re.findall(r"`([^`\n]+)`", re.sub(r"^ *```.*?^ *```", "", text, flags=re.M | re.S))


def test_files_that_pages_name_exist():
    files = [p.relative_to(ROOT) for p in ROOT.rglob("*") if not SKIPPED & set(p.relative_to(ROOT).parts)]
    names, count = {p.name for p in files}, 0
    for page in pages():
        if page.name == "CHANGELOG.md":
            continue  # it tells what was
        for word in named(page.read_text()):
            path = re.fullmatch(r"(?:src|include|idl|tests|tools|bench|patches)/[a-z0-9_./*-]*", word)
            if path:
                count += 1
                check(any(ROOT.glob(word.rstrip("/"))), f"{page.relative_to(ROOT)}: {word}")
            elif re.fullmatch(r"[a-z0-9_]+\.[ch]", word):
                count += 1
                check(word in names, f"{page.relative_to(ROOT)}: no file {word}")
    check(count > 60, f"only {count} files looked at")


def test_the_floors_that_are_shown_are_those_that_are_checked():
    """In the same order, each with its public header."""
    text = (ROOT / "tools/floors.py").read_text()
    checked = ast.literal_eval(re.search(r"^FLOORS = (\{.*?^\})", text, re.M | re.S)[1])
    page = (ROOT / "ARCHITECTURE.md").read_text()
    shown = dict(re.findall(r"^\| `src/([\w/]+)` \| `?([\w.]+)`? \|", page, re.M))
    wanted = {folder: {"*": "each"}.get(header, header) for folder, header in checked.items() if header}
    check_equal(list(shown.items()), list(wanted.items()), "floors of ARCHITECTURE.md")
    for folder, header in wanted.items():
        check(header == "each" or (ROOT / "src" / folder / header).exists(), f"src/{folder}/{header}")


def test_functions_that_pages_name_exist():
    sources = [p for folder in ("src", "include", "idl", "tests", "bench", "examples") for p in (ROOT / folder).rglob("*")
               if p.suffix in (".c", ".h", ".idl", ".py")]
    known, count = set(), 0
    for path in sources:
        known |= set(re.findall(r"\w+", path.read_text()))
    for page in pages():
        if page.name == "CHANGELOG.md":
            continue
        for word in named(page.read_text()):
            name = re.fullmatch(r"([a-z]+(?:_[a-z0-9]+)+)(?:\(\))?", word)
            if name:
                count += 1
                check(name[1] in known, f"{page.relative_to(ROOT)}: {word} is nowhere in the code")
    check(count > 60, f"only {count} functions looked at")


def test_files_shown_in_pages_are_the_files():
    shown = 0
    for page in pages():
        pattern = r"<!-- file: (\S+) -->\n```\w*\n(.*?)```$"
        for name, text in re.findall(pattern, page.read_text(), re.M | re.S):
            shown += 1
            check(text == (ROOT / name).read_text(),
                  f"{page.relative_to(ROOT)}: {name} has changed")
    check(shown > 0, "no page shows a file")


def test_exit_codes_of_troubleshooting_are_those_of_the_table():
    said = subprocess.run([BIN / "muster", "help", "exits"], capture_output=True, text=True, check=True).stdout
    wanted = [(code, meaning) for code, _, meaning in (row.split("\t") for row in said.splitlines()) if code != "0"]
    page = (ROOT / "docs/troubleshooting.md").read_text().split("## Exit codes", 1)[1].split("\n## ", 1)[0]
    check_equal(re.findall(r"^\| (\d+) \| (.*?) \| .*\|$", page, re.M), wanted, "exit codes of troubleshooting.md")


def test_every_key_of_json_is_in_the_reference():
    """Keys that `--json` prints and that a run writes, as the code has them."""
    pages = "".join((ROOT / "docs/reference" / name).read_text() for name in ("json.md", "files.md"))
    known, count = set(re.findall(r"`(\w+)`", pages)), 0
    for folder in ("cli", "report", "operator", "worldtool", "run"):
        for path in (ROOT / "src" / folder).rglob("*.c"):
            for key in re.findall(r'mu_json_\w+\(&?\w+, "(\w+)"', path.read_text()):
                count += 1
                check(key in known, f"{path.relative_to(ROOT)}: {key} is in no page of docs/reference")
    check(count > 60, f"only {count} keys looked at")
