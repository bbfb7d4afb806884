# SPDX-License-Identifier: Apache-2.0
"""Structs with many members of two values: which combinations of these are legal?  Each bit of a mask counts as one."""
import re

import floors

FOLDERS = ("broker", "runtime", "bus", "agent", "sim/session")
MOST = 3
# struct: how many it has, and why they are no state.
REASONS = {
    "robot_options": (5, "flags of a command line, each asked for by itself"),
    "tap": (4, "quality of service of one endpoint: DDS allows all combinations, and each is asked for by itself"),
    "mu_agent": (7, "senses: a set of sensors, which its body reads, each for itself; and whether its box has no gaps, and what it is in a step"),
    "session_robot": (9, "senses, off: sets of sensors; and whether its last answer drives it"),
    "session_process": (4, "joined: what has come of it before its first step, in any order; and whether its sample goes out again"),
    "session_observe": (4, "wanted: the readers of this step's Frame, each of which comes and goes; and whether the recording has its end"),
}
INNER = re.compile(r"\b(?:struct|enum|union)\s*\w*\s*\{[^{}]*\}|\{[^{}]*\}")
TWO = re.compile(r"\s*(?:const\s+|volatile\s+)*(?:(?:bool|_Bool|atomic_bool|sig_atomic_t)\s+(.*)|\w+\s+(\w+)\s*:\s*1)$", re.S)
ENUM = re.compile(r"\benum\b\s*\w*\s*\{([^{}]*)\}")
BIT = re.compile(r"(\w+)\s*=\s*(1u?\s*<<\s*\w+|\d+)\s*(?=,|$)")
COMBINED = re.compile(r"(?:->|\.)(\w+)\s*(?:[|&^]=?)\s*[(~\s]*(?:unsigned\)\s*)?(\w+)")
DOCUMENTED = re.compile(r"\b(\w+);\s*/\*(?:[^*]|\*(?!/))*\bbits of enum\b")


def masks(root, folder):
    """@return for each name of a member that is a mask, how many bits it has"""
    paths = sorted((root / "src" / folder).rglob("*.[ch]"))
    code = [floors.without_comments(path) for path in paths]
    bits = {}
    for text in code:
        for body in ENUM.findall(text):
            single = [name for name, value in BIT.findall(body) if "<<" in value or int(value).bit_count() == 1]
            bits.update({name: len(single) for name in single})
    found = {member: bits[bit] for text in code for member, bit in COMBINED.findall(text) if bits.get(bit, 0) > 1}
    found.update({member: MOST + 1 for path in paths for member in DOCUMENTED.findall(path.read_text())})
    return found


def members(body, mask):
    """@return the names of the members of two values in the body of a struct; a mask stands there once for each bit"""
    while INNER.search(body):
        body = INNER.sub("inner", body)
    found = [TWO.match(part) for part in body.split(";")]
    names = [name.strip() for m in found if m and "(" not in m[0] for name in (m[1] or m[2]).split(",")]
    words = [name for part in body.split(";") for name in re.findall(r"^\s*(?:uint\d+_t|unsigned)\s+(\w+)$", part)]
    return [name for name in names if not re.search(r"[*\[]", name)] + [name for name in words for _ in range(mask.get(name, 0))]


def problems(root):
    """@yield (file, why): structs with more of them than may be"""
    mask = {folder: masks(root, folder) for folder in FOLDERS}
    for folder, path in sorted((folder, p) for folder in FOLDERS for p in (root / "src" / folder).rglob("*.[ch]")):
        text = floors.without_comments(path)
        for m in re.finditer(r"\bstruct\s+(\w+)\s*\{", text):
            depth, end = 1, m.end()
            while depth:
                depth += {"{": 1, "}": -1}.get(text[end], 0)
                end += 1
            names, most = members(text[m.end():end - 1], mask[folder]), REASONS.get(m[1], (MOST, ""))[0]
            if len(names) > most:
                yield path, (f"struct {m[1]} has {len(names)} members of two values, more than {most}: {' '.join(names)}; "
                             f"make them a state, or give the reason in tools/booleans.py")
