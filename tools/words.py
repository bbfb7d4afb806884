# SPDX-License-Identifier: Apache-2.0
"""Words of yesterday: the second table of docs/concepts.md, and where code still has them.

File names, identifiers and comments of a module are searched; strings are not, because users see them.
Names of the wire and of headers of modules that still have a word stay.
"""
import re

# Modules in which none of their words is left.
CURED = set()
TEXT = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'')
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
NAME = re.compile(r"(?:(?:->|\.)\s*)?[A-Za-z_]\w*")


def table(root):
    """@return {module: {word: (term, whether comments are searched, too)}}"""
    page = (root / "docs/concepts.md").read_text().split("## Words of yesterday", 1)[1]
    words = {}
    for row in re.findall(r"^\| (?!word |-)(.*) \|$", page, re.M):
        word, term, where, _ = (cell.strip() for cell in (row + " ").split("|")[:4])
        for module in where.removesuffix("(names)").split(","):
            words.setdefault(module.strip(), {})[word] = term, not where.endswith("(names)")
    return words


def without(text, pattern):
    """The text with blanks in the place of what matches; its lines stay."""
    return pattern.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def pattern_of(word):
    return re.compile(rf"(?<![a-z]){word.replace(' ', '[ _]')}(?:e?s)?(?![a-z])", re.I)


def given_names(root, modules):
    """@return names that code of cured modules cannot help: of headers of the others, and members on the wire"""
    paths = [*(root / "include").rglob("*.h"), *(root / "src").rglob("*.h")]
    names = {name.lstrip("->. ") for path in paths
             if path.relative_to(root).parts[1] not in modules
             for name in NAME.findall(without(path.read_text(), COMMENT))}
    wire = {name for path in (root / "idl").glob("*.idl") for name in NAME.findall(without(path.read_text(), COMMENT))}
    return names, wire


def is_given(name, names, wire):
    bare = name.lstrip("->. ")
    return bare in names or bare.startswith("muster_") or (bare != name and bare in wire)


def hits(root, modules):
    """@yield (path, line, word, term, module) of the files of these modules"""
    words = table(root)
    names, wire = given_names(root, modules)
    for module in sorted(modules):
        patterns = [(pattern_of(word), word, *how) for word, how in words.get(module, {}).items()]
        for path in sorted((root / "src" / module).rglob("*.[ch]")):
            for pattern, word, term, _ in patterns:
                if pattern.search(path.stem):
                    yield path, 1, word, term, module
            yield from line_hits(path, patterns, names, wire, module)


def line_hits(path, patterns, names, wire, module):
    text = path.read_text()
    parts = re.split(rf"({COMMENT.pattern})", text, flags=re.S)
    comments = "".join(part if i % 2 else re.sub(r"[^\n]", " ", part) for i, part in enumerate(parts))
    code = without(without(text, COMMENT), TEXT).splitlines()
    for n, (comment, line) in enumerate(zip(comments.splitlines(), code), 1):
        mine = " ".join(name for name in NAME.findall(line) if not is_given(name, names, wire))
        if line.lstrip().startswith("#include"):
            mine = ""
        for pattern, word, term, in_comments in patterns:
            if pattern.search(mine) or (in_comments and pattern.search(comment)):
                yield path, n, word, term, module
