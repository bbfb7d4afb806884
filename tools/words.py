# SPDX-License-Identifier: Apache-2.0
"""Words of yesterday: the second table of docs/concepts.md, and where code still has them.

File names, identifiers and comments of a module are searched; strings are not, because users see them.
Names of the wire and of headers of modules that still have a word stay.
"""
import re

# Modules in which none of their words is left.
CURED = {"agent", "broker", "host", "mind", "monitor", "planner", "runtime", "sim", "world"}
TEXT = re.compile(r'"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])*\'')
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.S)
PERSON = re.compile(r"\b(?:[Ww]ho(?:m|ever)?|[Ss]ome(?:body|one)|[Nn]obody|[Hh](?:e|im|is))\b")
# Places in all comments that may speak so; people are meant, or a text is quoted.
PERSONS_MAX = 20
# Of people it may be said.
PEOPLE = re.compile(r"\b(?:[Pp]ersons?|[Pp]eople|[Uu]sers?|[Tt]eachers?|[Ss]tudents?) (?:may )?who\b|\*Who\*")
# The first line of pages that tools/make-reference prints.
MADE = "<!-- Made by "
SENTENCE_WORDS_MAX = 25
NAME = re.compile(r"(?:(?:->|\.)\s*)?[A-Za-z_]\w*")


def table(root):
    """@return for each row: the word's pattern, the word, the term, whether comments are searched, the folders where
    it had its meaning, and the pattern of names that stay, or None"""
    page = (root / "docs/concepts.md").read_text().split("## Words of yesterday", 1)[1]
    for row in re.findall(r"^\| (?!word |-)(.*) \|$", page, re.M):
        word, term, where, stays = (cell.strip() for cell in (row + " ").split("|")[:4])
        folders = [folder.strip() for folder in where.removesuffix("(names)").split(",")]
        names = re.findall(r"`([^`]+)`", stays)
        stay = re.compile("|".join(rf"{re.escape(name)}\b" for name in names)) if names else None
        yield pattern_of(word), word, term, not where.endswith("(names)"), folders, stay


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
    """@yield (path, line, word, term) of the files of these modules"""
    rows = list(table(root))
    names, wire = given_names(root, modules)
    for module in sorted(modules):
        for path in sorted((root / "src" / module).rglob("*.[ch]")):
            folder = str(path.parent.relative_to(root / "src")) + "/"
            mine = [row for row in rows if any(folder.startswith(where + "/") for where in row[4])]
            yield from sorted(file_hits(path, mine, names, wire), key=lambda hit: hit[1:3])


def file_hits(path, rows, names, wire):
    text = path.read_text()
    parts = re.split(rf"({COMMENT.pattern})", text, flags=re.S)
    comments = "".join(part if i % 2 else re.sub(r"[^\n]", " ", part) for i, part in enumerate(parts)).splitlines()
    code = without(without(text, COMMENT), TEXT).splitlines()
    for pattern, word, term, in_comments, _, stay in rows:
        if pattern.search(path.stem):
            yield path, 1, word, term
        for n, (comment, line) in enumerate(zip(comments, code), 1):
            own = " ".join(name for name in NAME.findall(line) if not is_given(name, names, wire))
            said = re.sub(r"\w+_\w+", lambda m: "" if is_given(m[0], names, wire) else m[0], comment)
            said = stay.sub("", said) if stay else said
            if pattern.search("" if line.lstrip().startswith("#include") else own) or (in_comments and pattern.search(said)):
                yield path, n, word, term


def comments(path):
    """@yield (line, text) of the comments and docstrings of a file"""
    text = path.read_text()
    mark = r'""".*?"""|#[^\n]*' if path.suffix in (".py", "") else COMMENT.pattern
    for found in re.finditer(rf"({mark})|{TEXT.pattern}", text, re.S):
        if found[1]:
            first = text.count("\n", 0, found.start()) + 1
            yield from enumerate(found[1].splitlines(), first)


def persons(root):
    """@return (path, line, text) of comments in which a process, an agent or a file is called who, nobody or he"""
    kinds = (".c", ".h", ".js", ".css", ".idl", ".py", "")
    paths = [path for top in ("src", "include", "idl", "tools") for path in sorted((root / top).rglob("*"))
             if path.is_file() and path.suffix in kinds and "__pycache__" not in path.parts]
    return [(path, n, text.strip()) for path in paths for n, text in comments(path) if PERSON.search(text)]


def pages(root):
    """@yield (path, line, text) of all pages, without code"""
    for path in sorted([*root.glob("*.md"), *(root / "docs").rglob("*.md"), *(root / "docs/man").glob("*.1")]):
        fenced = False
        for n, line in enumerate(path.read_text().splitlines(), 1):
            fence = line.lstrip().startswith("```")
            fenced = fenced != fence
            if not fenced and not fence:
                yield path, n, re.sub(r"`[^`]*`", "", line)


def persons_of_pages(root):
    """@return (path, line, text) of pages in which anything but people is called who, nobody or he"""
    return [(path, n, text.strip()) for path, n, text in pages(root) if PERSON.search(PEOPLE.sub("", text))]

def blocks(path):
    """@yield (line, text) of the paragraphs, list items and cells of a page that people write, without code"""
    text = re.sub(r"^ *```.*?^ *```|<!--.*?-->", lambda m: "\n" * m[0].count("\n"), path.read_text(), flags=re.M | re.S)
    first, parts = 0, []
    for n, line in enumerate([*text.splitlines(), ""], 1):
        line = line.strip()
        item = re.match(r"(?:[-*+]|\d+\.) ", line)
        if parts and (not line or item or line[0] in "|#"):
            yield first, " ".join(parts)
            parts = []
        if line.startswith("|"):
            yield from ((n, cell) for cell in re.split(r"(?<!\\)\|", line))
        elif line and not line.startswith("#"):
            first = first if parts else n
            parts.append(line[item.end():] if item else line)


def long_sentences(root):
    """@yield (path, line, words, text) of sentences, and main clauses between semicolons or colons, that are too long"""
    for path in sorted([*root.glob("*.md"), *(root / "docs").rglob("*.md")]):
        if MADE in path.read_text():
            continue
        for n, text in blocks(path):
            plain = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", re.sub(r"`[^`]*`", "code", text))
            for sentence in re.split(r"(?<=[.?!:;])[*)\"]*\s+", plain):
                count = len(re.findall(r"\w\S*", sentence))
                if count > SENTENCE_WORDS_MAX:
                    yield path, n, count, sentence
