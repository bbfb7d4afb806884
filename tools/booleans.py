# SPDX-License-Identifier: Apache-2.0
"""Structs with many members of two values: which combinations of these are legal?"""
import re

import floors

FOLDERS = ("broker", "runtime", "bus", "agent", "sim/session")
MOST = 3
# struct: how many it has, and why they are no state.
REASONS = {
    "robot_options": (5, "flags of a command line, each asked for by itself"),
    "tap": (4, "quality of service of one endpoint: DDS allows all combinations, and each is asked for by itself"),
}
INNER = re.compile(r"\b(?:struct|enum|union)\s*\w*\s*\{[^{}]*\}|\{[^{}]*\}")
TWO = re.compile(r"\s*(?:const\s+|volatile\s+)*(?:(?:bool|_Bool|atomic_bool|sig_atomic_t)\s+(.*)|\w+\s+(\w+)\s*:\s*1)$", re.S)


def members(body):
    """@return the names of the members of two values in the body of a struct"""
    while INNER.search(body):
        body = INNER.sub("inner", body)
    found = [TWO.match(part) for part in body.split(";")]
    names = [name.strip() for m in found if m and "(" not in m[0] for name in (m[1] or m[2]).split(",")]
    return [name for name in names if not re.search(r"[*\[]", name)]


def problems(root):
    """@yield (file, why): structs with more of them than may be"""
    for path in sorted(p for folder in FOLDERS for p in (root / "src" / folder).rglob("*.[ch]")):
        text = floors.without_comments(path)
        for m in re.finditer(r"\bstruct\s+(\w+)\s*\{", text):
            depth, end = 1, m.end()
            while depth:
                depth += {"{": 1, "}": -1}.get(text[end], 0)
                end += 1
            names, most = members(text[m.end():end - 1]), REASONS.get(m[1], (MOST, ""))[0]
            if len(names) > most:
                yield path, (f"struct {m[1]} has {len(names)} members of two values, more than {most}: {' '.join(names)}; "
                             f"make them a state, or give the reason in tools/booleans.py")
