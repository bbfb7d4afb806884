# SPDX-License-Identifier: Apache-2.0
"""The graph of calls between the files of src/, read from the objects of a built tree.

An edge from one file to another is a symbol that the one uses, in code or in a table of data, and the other
defines.  A pointer in a table of a lower floor to a function of a higher one is such an edge.
"""
import collections
import os
import pathlib
import struct

ALLOCATED, EXECUTABLE, SYMBOLS, RELOCATIONS = 2, 4, 2, 4  # ELF: flags and types of sections


def text_at(data, at):
    return data[at:data.index(b"\0", at)].decode()


def object_symbols(path):
    """@return the names that an ELF64 object defines for others, and {name: whether a table uses it} of
    those that it uses and others define"""
    data = path.read_bytes()
    if data[:6] != b"\x7fELF\x02\x01":
        raise SystemExit(f"{path}: not an object of a little-endian machine of 64 bits")
    at, = struct.unpack_from("<Q", data, 0x28)
    count, = struct.unpack_from("<H", data, 0x3C)
    sections = [struct.unpack_from("<IIQQQQIIQQ", data, at + 64 * i) for i in range(count)]
    defines, uses = set(), {}
    for kind, offset, size, link in ((s[1], s[4], s[5], s[6]) for s in sections):
        if kind != SYMBOLS:
            continue
        names = sections[link][4]
        symbols = list(struct.iter_unpack("<IBBHQQ", data[offset:offset + size]))
        shared = [bool(info >> 4) for _, info, _, _, _, _ in symbols]
        defines = {text_at(data, names + s[0]) for s, is_shared in zip(symbols, shared) if is_shared and s[3]}
        foreign = {i: text_at(data, names + s[0]) for i, s in enumerate(symbols) if shared[i] and not s[3]}
        uses = dict.fromkeys(foreign.values(), False)
    for kind, offset, size, target in ((s[1], s[4], s[5], s[7]) for s in sections):
        if kind != RELOCATIONS or sections[target][2] & (ALLOCATED | EXECUTABLE) != ALLOCATED:
            continue
        for _, info, _ in struct.iter_unpack("<QQq", data[offset:offset + size]):
            if info >> 32 in foreign:
                uses[foreign[info >> 32]] = True
    return defines, uses


class Graph:
    """edges[file][other file] is a sorted list of the symbols; a symbol in a table ends with `*`."""

    def __init__(self, root, build):
        self.files = sorted(str(p.relative_to(root)) for p in (root / "src").rglob("*.c"))
        self.stale = [f for f in self.files if self.is_stale(root, build, f)]
        self.edges = {f: {} for f in self.files}
        if self.stale:
            return
        self.uses, self.owners = {}, collections.defaultdict(list)
        for f in self.files:
            defines, self.uses[f] = object_symbols((build / f).with_suffix(".o"))
            for symbol in defines:
                self.owners[symbol].append(f)
        for f in self.files:
            for symbol, in_table in self.uses[f].items():
                owner = self.owner(symbol, f)
                if owner and owner != f:
                    self.edges[f].setdefault(owner, []).append(symbol + "*" * in_table)
        for to in self.edges.values():
            for symbols in to.values():
                symbols.sort()

    @staticmethod
    def is_stale(root, build, file):
        made = (build / file).with_suffix(".o")
        return not made.exists() or made.stat().st_mtime < (root / file).stat().st_mtime

    def owner(self, symbol, user):
        """Programs may each have a function of one name: the user's own module comes first."""
        owners = [f for f in self.owners.get(symbol, ())
                  if module_of(f) != "faults" or module_of(user) == "faults"]  # it stands before the C library
        near = [f for f in owners if module_of(f) == module_of(user)]
        return near[0] if near else owners[0] if len(owners) == 1 else None

    def targets(self):
        return {f: set(to) for f, to in self.edges.items()}

    def folders(self):
        """@return {folder: other folders that its files use}"""
        folders = collections.defaultdict(set)
        for f, to in self.edges.items():
            folders[folder_of(f)] |= {folder_of(g) for g in to} - {folder_of(f)}
        return folders


def module_of(file):
    return pathlib.PurePath(file).parts[1]


def folder_of(file):
    return os.path.dirname(file)


def circles(targets):
    """Tarjan's strongly connected components of more than one node, the largest first."""
    index, low, stack, found = {}, {}, [], []

    def visit(v):
        index[v] = low[v] = len(index)
        stack.append(v)
        for w in sorted(targets.get(v, ())):
            if w not in index:
                visit(w)
                low[v] = min(low[v], low[w])
            elif w in stack:
                low[v] = min(low[v], index[w])
        if low[v] == index[v]:
            at = stack.index(v)
            if len(stack) - at > 1:
                found.append(sorted(stack[at:]))
            del stack[at:]

    for v in sorted(targets):
        if v not in index:
            visit(v)
    return sorted(found, key=len, reverse=True)


def text(graph, module):
    """Lines: of a module each file and what it uses, else each folder and the folders that it uses."""
    if not module:
        for folder, to in sorted(graph.folders().items()):
            yield f"{folder} -> {' '.join(sorted(to)) or '-'}"
        return
    for f, to in sorted(graph.edges.items()):
        if module_of(f) == module:
            yield f
            for g, symbols in sorted(to.items()):
                yield f"    {g}: {' '.join(symbols)}"


def dot(graph, module):
    """The same for Graphviz; nodes of a folder stand in one frame."""
    yield "digraph calls {"
    yield "    rankdir=BT; node [shape=box, fontname=sans];"
    if not module:
        for folder, to in sorted(graph.folders().items()):
            yield from (f'    "{folder}" -> "{g}";' for g in sorted(to))
    else:
        own = [f for f in graph.files if module_of(f) == module]
        for folder in sorted({folder_of(f) for f in own}):
            yield f'    subgraph "cluster_{folder}" {{ label="{folder}";'
            yield from (f'        "{f}" [label="{os.path.basename(f)}"];' for f in own if folder_of(f) == folder)
            yield "    }"
        for f in own:
            yield from (f'    "{f}" -> "{g}";' for g in graph.edges[f] if module_of(g) == module)
    yield "}"
