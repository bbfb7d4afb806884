# SPDX-License-Identifier: Apache-2.0
"""tools/tidy.py finds what it is for, in trees that are made up."""
import os
import re
import shutil
import subprocess

from support import ROOT, check, check_equal, folder

LICENCE = "// SPDX-License-Identifier: Apache-2.0\n"


def tidied(out, files, *words, built=True):
    """What tidy says of a tree of these files, {name below src/: text}; all modules are in
    order in it, but for a circle of two files in core, which is known."""
    shutil.copytree(ROOT / "tools", out / "tools", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "Makefile", out)
    for name in ("docs/concepts.md", "idl/wire.idl"):
        (out / name).parent.mkdir()
        shutil.copy(ROOT / name, out / name)
    cured = out / "tools/words.py"
    cured.write_text(re.sub(r"^CURED = .*?$", 'CURED = {"mind", "sim"}', cured.read_text(), flags=re.M))
    floors = out / "tools/floors.py"
    text = re.sub(r"^UNFINISHED = .*$", "UNFINISHED = set()", floors.read_text(), flags=re.M)
    floors.write_text(re.sub(r"^CIRCLES = \{.*?\}$", 'CIRCLES = {"core": [2]}', text, flags=re.M | re.S))
    for name, text in files.items():
        path = out / "src" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(LICENCE + text)
    for name in files if built else ():
        made = (out / "build/release/src" / name).with_suffix(".o")
        made.parent.mkdir(parents=True, exist_ok=True)
        if name.endswith(".c"):
            subprocess.run(["cc", "-c", "-fPIC", "-ffunction-sections", "-fdata-sections", f"-I{out}/src", "-o", made,
                            out / "src" / name], check=True, timeout=60)
    done = subprocess.run([out / "tools/tidy.py", *words], env={**os.environ, "BUILD": "release"},
                          capture_output=True, text=True, timeout=60)
    check_equal(done.stderr, "", "standard error")
    return done.returncode, done.stdout


def calls(name, *others):
    """A file with a function that calls others."""
    lines = [f"int {other}(void);" for other in others] + [f"int {name}(void);", f"int {name}(void)", "{",
             f"    return {' + '.join([f'{other}()' for other in others] + ['1'])};", "}", ""]
    return "\n".join(lines)


ORDERLY = {
    "core/text.c": calls("text_a"),
    "world/parse/parser.h": "int parser_a(void);\n",
    "world/parse/parser.c": calls("parser_a", "text_a"),
    "planner/path.c": '#include "world/parse/parser.h"\n' + calls("path_a", "parser_a"),
}


def test_a_tree_in_order_passes():
    with folder() as out:
        check_equal(tidied(out, ORDERLY), (0, "tidy: CIRCLES of tools/floors.py may say [] of core, not [2]\n"
                                              "tidy: ok\n1 passed, 0 failed\n"), "tidy")


def test_a_circle_of_files_fails():
    with folder() as out:
        code, said = tidied(out, {**ORDERLY, "stats/a.c": calls("a_go", "b_go"), "stats/b.c": calls("b_go", "a_go")})
        check_equal(code, 1, "the exit code")
        check("circle of 2 files: src/stats/a.c src/stats/b.c\n" in said, said)
        check("src/stats/b.c -> src/stats/a.c: a_go\n" in said, f"the calls: {said}")


def test_a_circle_of_folders_fails_without_one_of_files():
    with folder() as out:
        code, said = tidied(out, {"mind/facts/a.c": calls("a_go", "b_go"), "mind/engine/b.c": calls("b_go"),
                                  "mind/engine/c.c": calls("c_go", "d_go"), "mind/facts/d.c": calls("d_go")})
        check_equal(code, 1, "the exit code")
        check("circle of 2 folders: src/mind/engine src/mind/facts\n" in said, said)
        check("src/mind/engine/c.c:1: calls up, to src/mind/facts/d.c: d_go\n" in said, said)


def test_a_known_circle_may_not_grow():
    ring = {"core/a.c": calls("a_go", "b_go"), "core/b.c": calls("b_go", "a_go")}
    larger = {"core/a.c": calls("a_go", "b_go"), "core/b.c": calls("b_go", "c_go"), "core/c.c": calls("c_go", "a_go")}
    for files, expected in ((ring, 0), (larger, 1)):
        with folder() as out:
            code, said = tidied(out, files)
            check_equal(code, expected, said)


def test_a_pointer_in_a_table_is_a_call():
    table = "int path_a(void);\nextern int (*const parser_go[])(void);\nint (*const parser_go[])(void) = {path_a};\n"
    with folder() as out:
        code, said = tidied(out, {"world/parse/parser.c": table, "planner/path.c": calls("path_a")})
        check_equal(code, 1, "the exit code")
        check("src/world/parse/parser.c:1: calls src/planner/path.c, and world may not use planner: path_a*\n" in said, said)


def test_another_folder_includes_the_public_header_only():
    with folder() as out:
        code, said = tidied(out, {**ORDERLY, "world/parse/lexer.h": "int lexer_a(void);\n",
                                  "planner/map.c": '#include "world/parse/lexer.h"\n' + calls("map_a"),
                                  "world/parse/up.c": '#include "world/model/world.h"\n' + calls("up_a"),
                                  "world/model/world.h": "int world_a(void);\n"})
        check_equal(code, 1, "the exit code")
        check('src/planner/map.c:2: "world/parse/lexer.h" is for world/parse only\n' in said, said)
        check("src/world/parse/up.c:2: world/parse stands below world/model\n" in said, said)
        check("2 problems" in said, said)


def test_a_struct_of_a_higher_floor_is_not_known_below():
    with folder() as out:
        code, said = tidied(out, {"mind/mind.h": "struct mind {\n    int n;\n};\n",
                                  "mind/load/load.h": "struct mind;\nint load_a(struct mind *m);\n",
                                  "mind/answer.c": "int answer_a(struct mind *m);\n"})
        check_equal(code, 1, "the exit code")
        check("src/mind/load/load.h:1: struct mind belongs to mind, which stands above mind/load\n" in said, said)
        check("1 problems" in said, said)


def test_words_of_yesterday_are_found_in_names_and_comments():
    text = ('/* A capsule of a mind. */\nint glance_all(int *trips);\nint glance_all(int *trips)\n{\n'
            '    const char *said = "capsule";\n    return said[0] + trips[0]; // a snapshot\n}\n')
    with folder() as out:
        code, said = tidied(out, {"mind/diary.c": text, "stats/capsule.c": calls("capsule_a")})
        check_equal(code, 1, "the exit code")
        found = re.findall(r"^(src/\S+): (.*): say .* \(docs/concepts.md\)$", said, re.M)
        check_equal(found, [("src/mind/diary.c:1", "diary"), ("src/mind/diary.c:2", "capsule"),
                            ("src/mind/diary.c:3", "glance"), ("src/mind/diary.c:3", "trip"),
                            ("src/mind/diary.c:4", "glance"), ("src/mind/diary.c:4", "trip"),
                            ("src/mind/diary.c:7", "trip")], said)


def test_a_long_sentence_and_a_process_that_is_a_person_fail():
    words = "a broker " * 12
    page = f"""
{words}and

Mail waits for {words}
until, in `code that does not count`, one comes.

| a cell: {words} |
| {words} too | here |

```
{words}is code
```
A broker who waits.
"""
    with folder() as out:
        code, said = tidied(out, {"core/low.c": "void mu_low(void)\n{\n}\n", "../docs/page.md": page})
        check_equal(code, 1, said)
        found = re.findall(r"^docs/page.md:(\d+): (\d+ words|who)", said.replace("src/../", ""), re.M)
        check_equal(found, [("14", "who"), ("5", "32 words")], said)


def test_names_of_the_wire_stay():
    text = "int a_go(const muster_Up *up);\nint a_go(const muster_Up *up)\n{\n    return up->trips._length;\n}\n"
    with folder() as out:
        code, said = tidied(out, {"mind/a.c": "typedef struct { struct { int _length; } trips; } muster_Up;\n" + text})
        check_equal(re.findall(r": say ", said), [": say "], f"only its definition here: {said}")


def test_a_new_pointer_for_calls_upward_needs_a_reason():
    with folder() as out:
        code, said = tidied(out, {**ORDERLY, "stats/ask.h": "struct ask {\n    int (*above)(void *self);\n};\n"})
        check_equal(code, 1, "the exit code")
        check("src/stats/ask.h:1: struct ask has 1 pointers to functions, not 0" in said, said)


def test_a_tree_that_is_not_built_says_what_to_do():
    with folder() as out:
        code, said = tidied(out, ORDERLY, built=False)
        check_equal(code, 1, "the exit code")
        check("3 of 3 objects are missing or older than their source" in said and "run `make`" in said, said)


def test_an_elementary_function_of_the_c_library_is_found():
    """Once in a program, once in a library that it is loaded with, and not where it has its own."""
    with folder() as out:
        (out / "build/release/bin").mkdir(parents=True)
        library, program = out / "libode.so", out / "build/release/bin/muster-sim"

        def made(to, code, *words):
            code = "double cbrt(double x), tan(double x), ode(double x), fmod(double x, double y);\n" + code
            subprocess.run(["cc", "-fno-builtin", "-fPIC", "-x", "c", "-o", to, "-", *words, "-lm"],
                           input=code, text=True, check=True, timeout=60)

        made(library, "double ode(double x) { return tan(x); }\n", "-shared", "-Wl,-soname,libode.so")
        loaded = ("-x", "none", library, f"-Wl,-rpath,{out}")
        made(program, "int main(int n, char **v) { (void)v; return fmod(n, 3) + ode(n) + cbrt(n) > 1; }\n", *loaded)
        code, said = tidied(out, ORDERLY)
        check_equal(code, 1, said)
        check("muster-sim:1: calls cbrt of the C library" in said, said)
        check(f"muster-sim:1: loads {library}, which calls tan of the C library" in said, said)
        check("fmod" not in said, "what is exact is let be")
    with folder() as out:
        (out / "build/release/bin").mkdir(parents=True)
        library, program = out / "libode.so", out / "build/release/bin/muster-sim"
        made(library, "double ode(double x) { return tan(x); }\n", "-shared", "-Wl,-soname,libode.so")
        loaded = ("-x", "none", library, f"-Wl,-rpath,{out}")
        made(program, "double tan(double x) { return x; }\nint main(int n, char **v) { (void)v; return ode(n) > 1; }\n", *loaded)
        check_equal(tidied(out, ORDERLY)[0], 0, "a program with a tan of its own")


def test_the_graph_shows_who_calls_whom():
    with folder() as out:
        code, said = tidied(out, ORDERLY, "--graph", "planner")
        check_equal((code, said), (0, "src/planner/path.c\n    src/world/parse/parser.c: parser_a\n"), "as text")
    with folder() as out:
        code, said = tidied(out, ORDERLY, "--graph", "--dot")
        check_equal(code, 0, "the exit code")
        check('    "src/planner" -> "src/world/parse";\n' in said, said)
