# SPDX-License-Identifier: Apache-2.0
"""Which folder of src/ stands above which, and what may still be out of order.

A folder is a floor: it calls lower floors only, and other folders include its public header only.
"""
import collections
import os
import pathlib
import re

import graph

# Bottom first: a folder and its public header (* each of its headers; None: it has none), for the modules that have
# floors.
FLOORS = {
    "bus/wire": "*",
    "bus": "*",
    "bus/raw": "raw.h",
    "world/condition": "condition.h",
    "world/parse": "parser.h",
    "world/model": "world.h",
    "world/read": "builder.h",
    "world": "world_load.h",
    "experiment/yaml": "yaml_tree.h",
    "experiment": "experiment.h",
    "report/drawing": "drawing.h",
    "report": "report.h",
    "report/compare": "compare.h",
    "mcap": "mcap.h",
    "story": "story.h",
    "operator": "operator.h",
    "run": "run.h",
    "worldtool": "worldtool.h",
    "cli/terminal": "terminal.h",
    "cli/help": "help.h",
    "cli": None,
    "planner": "planner.h",
    "mind/interface": "interface.h",
    "mind/syntax": "syntax.h",
    "mind/engine": "engine.h",
    "mind/facts": "facts.h",
    "mind/functions": "functions.h",
    "mind/load": "load.h",
    "mind/snapshot": "snapshot.h",
    "mind": "mind.h",
    "agent/states": "states.h",
    "agent": "robot.h",
    "host": None,
    "monitor": None,
    "sim/geometry": "geometry.h",
    "sim/devices": "devices.h",
    "sim/sensors": "sensors.h",
    "sim/engine": "engine.h",
    "sim/record": "record.h",
    "sim/session": "session.h",
    "sim": None,
    "broker/base": "base.h",
    "broker/names": "names.h",
    "broker/steps": "steps.h",
    "broker/directory": "directory.h",
    "broker/mail": "mail.h",
    "broker/delivery": "delivery.h",
    "broker/services": "services.h",
    "broker/membership": "membership.h",
    "broker/control": "broker.h",
    "broker/node": "node.h",
    "broker": None,
}
FILES_MAX = 16  # of code in a floor, without main.c
# Headers that floors of their module may include, because these do not have structs of their own yet.
SHARED = {"broker/control/parts.h"}
# Floors that need none: an upward call does not compile there.
STANDS_ALONE = {"broker/base"}
# Code that still reaches into a struct of a higher floor.
REACHES_UP = set()
# Modules with floors that are being put in order: `tools/tidy.py --floors` lists what is left.
UNFINISHED = set()
# Circles of files that later work cures, by module: the sizes may shrink, and never grow.
CIRCLES = {}
# The same of folders.
FOLDER_CIRCLES = {}
# Pointers in headers through which a lower floor calls a higher one: holder, how many, why.
POINTERS = {
    "struct mu_handlers": (11, "public: the runtime calls an agent's program"),
    "struct mu_layer_handler": (1, "public: the runtime calls the handlers of a kind of agents"),
    "struct mu_agent_kind": (1, "public: the runtime calls the hooks of a kind of agents"),
    "struct mu_watch_handlers": (3, "public: a watch calls the program that looks at a run"),
    "mu_resolve": (1, "public: the runtime asks a resolver's program"),
    "mu_process_each_round()": (1, "public: the runtime calls a program after each round"),
    "struct mu_process": (3, "the runtime calls robots and hosts before and after its samples"),
    "process_before_up()": (1, "sets one of the process"),
    "process_see_first()": (1, "sets one of the process"),
    "struct transfers": (3, "the runtime hands words about a migration to the robot's process"),
    "struct probes_handlers": (2, "the runtime hands probes and their answers to the agent's program"),
    "probes_answer()": (1, "sets one of the probes' handlers"),
    "probes_hear()": (1, "sets one of the probes' handlers"),
    "struct group_process": (1, "the robot's process tells a host that an agent has come"),
    "struct robot_program": (1, "a robot's program, as the runtime calls it: who joins does not know who handles"),
    "checkpoint_each()": (1, "a visitor of checkpoints"),
    "console_answer()": (1, "what asks the mind, for a line or for a probe"),
    "struct mind_ports": (11, "ports of the mind: it has no process, and acts through them"),
    "struct mind_options": (1, "how the mind reads rule files: it has none itself"),
    "struct fan_kernel": (3, "kernels for the vector units of processors"),
    "struct condition_names": (2, "conditions read names of any world"),
    "struct condition_view": (3, "conditions read positions of any world"),
    "builder_children()": (1, "a visitor of entities of a world's file"),
    "struct bus": (1, "a reader's thread calls the process that waits"),
    "tap_watch_look()": (1, "a filter of topics"),
    "struct topic": (1, "the table of topics: rules of the wire"),
    "struct metric": (1, "the table of counters: each reads its own"),
    "struct trust_pages": (1, "the policy asks for groups and roles"),
    "struct mu_fault_listener": (1, "a program writes faults in its own log"),
    "struct console_edit_hooks": (3, "the line editor asks for prompt and completions"),
    "struct console_link": (2, "a console's link shows lines to terminal or page"),
    "struct operator": (1, "a verb hears the answers to its mail"),
    "struct operator_hooks": (2, "a verb hears mail and receipts"),
    "struct scheme": (1, "the resolver shows bodies to addresses of places"),
}
POINTERS_MOST = 72  # never more than this
POINTER = re.compile(r"\(\s*\*\s*(?:const\s+)?(\w+)\s*(?:\[[^\]]*\])?\s*\)\s*\(")
DEFINED, USED = re.compile(r"\bstruct\s+(\w+)\s*\{"), re.compile(r"\bstruct\s+(\w+)\b")
RANK = {folder: i for i, folder in enumerate(FLOORS)}
FLOORED = {folder.split("/")[0] for folder in FLOORS}


def floor_of(file):
    """@return the folder of a file below src/, as FLOORS has it"""
    return os.path.dirname(file).removeprefix("src/")


def include_problem(file, header):
    """@return (why a file of src/ may not include this header, the module to blame), or None"""
    mine, theirs = floor_of(file), os.path.dirname(header)
    is_shared = header in SHARED and mine not in STANDS_ALONE and header.split("/")[0] == mine.split("/")[0]
    if theirs not in RANK or mine == theirs or is_shared:
        return None
    if FLOORS[theirs] != "*" and os.path.basename(header) != FLOORS[theirs]:
        return f"\"{header}\" is for {theirs} only", theirs.split("/")[0]
    if mine in RANK and RANK[theirs] > RANK[mine]:
        return f"{mine} stands below {theirs}", mine.split("/")[0]
    return None


def without_comments(path):
    return re.sub(r'/\*.*?\*/|//[^\n]*|"(\\.|[^"\\\n])*"', "", path.read_text(), flags=re.S)


def struct_problems(root):
    """@yield (file, why, module to blame): structs of a higher floor in the code of a lower one, folders that are no
    floor, and floors with too many files"""
    for module in FLOORED:
        found = {str(path.parent.relative_to(root / "src")) for path in (root / "src" / module).rglob("*.[ch]")}
        for folder in sorted(found - set(FLOORS)):
            yield root / "src" / folder, "this folder has no place in FLOORS of tools/floors.py", module
        code = {path: without_comments(path) for folder in FLOORS if folder.split("/")[0] == module
                for path in sorted((root / "src" / folder).glob("*.[ch]"))}
        owner = {tag: floor_of(str(path.relative_to(root))) for path, text in code.items()
                 if path.suffix == ".h" and str(path.relative_to(root / "src")) not in SHARED for tag in DEFINED.findall(text)}
        for folder in found & set(FLOORS):
            count = sum(path.parent == root / "src" / folder and path.suffix == ".c" and path.name != "main.c" for path in code)
            if count > FILES_MAX:
                yield root / "src" / folder, f"{count} files of code, more than {FILES_MAX}", module
        for path, text in code.items():
            folder = floor_of(str(path.relative_to(root)))
            for tag in sorted(set(USED.findall(text)) - set(DEFINED.findall(text))):
                known = (str(path.relative_to(root)), tag) in REACHES_UP
                if RANK[owner.get(tag, folder)] > RANK[folder] and not known:
                    yield path, f"struct {tag} belongs to {owner[tag]}, which stands above {folder}", module


def call_problems(calls, may_include):
    """@yield (file, why, module to blame): calls to a higher floor, and between strangers"""
    for f, to in calls.edges.items():
        for g, symbols in to.items():
            a, b = graph.module_of(f), graph.module_of(g)
            mine, theirs = floor_of(f), floor_of(g)
            if a != b and b not in may_include[a]:
                yield f, f"calls {g}, and {a} may not use {b}: {' '.join(symbols)}", a
            elif RANK.get(theirs, -1) > RANK.get(mine, len(RANK)):
                yield f, f"calls up, to {g}: {' '.join(symbols)}", a


def inner_edges(ring, edges):
    """The calls that make a circle, as lines."""
    for f in ring:
        for g in ring:
            if g in edges.get(f, ()):
                yield f"{f} -> {g}: {' '.join(edges[f][g])}"


def known_circles(rings, known):
    """@return for each circle of files or folders, the largest first, whether it is one of those"""
    left = {module: list(sizes) for module, sizes in known.items()}
    for ring in rings:
        modules = {graph.module_of(f) for f in ring}
        sizes = left.get(next(iter(modules)), []) if len(modules) == 1 else []
        is_known = bool(sizes) and len(ring) <= sizes[0]
        if is_known:
            sizes.pop(0)
        yield ring, modules, is_known


def circles_gone(calls):
    """@yield notes: known circles that are smaller now, or gone"""
    for name, known, rings in (("CIRCLES", CIRCLES, graph.circles(calls.targets())),
                               ("FOLDER_CIRCLES", FOLDER_CIRCLES, graph.circles(calls.folders()))):
        for module, sizes in known.items():
            now = [len(ring) for ring in rings if {graph.module_of(f) for f in ring} == {module}]
            if now < sizes:
                yield f"{name} of tools/floors.py may say {now} of {module}, not {sizes}"


def circle_problems(calls):
    """@yield (what, modules, whether it is a known one, the calls in it)"""
    for ring, modules, is_known in known_circles(graph.circles(calls.targets()), CIRCLES):
        yield f"circle of {len(ring)} files: {' '.join(ring)}", modules, is_known, inner_edges(ring, calls.edges)
    for ring, modules, is_known in known_circles(graph.circles(calls.folders()), FOLDER_CIRCLES):
        within = [f for f in calls.files if graph.folder_of(f) in ring]
        apart = {f: {g: s for g, s in calls.edges[f].items() if graph.folder_of(f) != graph.folder_of(g)} for f in within}
        yield f"circle of {len(ring)} folders: {' '.join(ring)}", modules, is_known, inner_edges(within, apart)


def pointers(root):
    """@yield (header, holder, names): pointers to functions in headers, by what has them"""
    for folder in ("include", "src"):
        for path in sorted((root / folder).rglob("*.h")):
            text = re.sub(r'^#(?:[^\n]*\\\n)*[^\n]*$|extern\s+\{', "", without_comments(path), flags=re.M)
            for holder, names in holders(text):
                yield path.relative_to(root), holder, names


def holders(text):
    depth = start = 0
    for i, c in enumerate(text):
        depth = depth + 1 if c == "{" else max(depth - 1, 0) if c == "}" else depth
        if c != ";" or depth:
            continue
        part, start = text[start:i], i + 1
        names = POINTER.findall(part)
        struct = re.match(r"[\s}]*(?:typedef\s+)?struct\s+(\w+)\s*\{", part)
        if names and struct:
            yield f"struct {struct[1]}", names
        elif names and "typedef" in part:
            yield names[0], names
        elif names:
            yield re.search(r"(\w+)\s*\(", part)[1] + "()", names


def pointer_problems(root):
    """@yield (header, why, module to blame)"""
    count = 0
    for path, holder, names in pointers(root):
        count += len(names)
        module = path.parts[1]
        most, _ = POINTERS.get(holder, (0, ""))
        if len(names) > most:
            yield path, (f"{holder} has {len(names)} pointers to functions, not {most}: return an event or an outcome, "
                         f"or give the reason in POINTERS of tools/floors.py"), module
    if count > POINTERS_MOST:
        yield pathlib.Path("src"), f"{count} pointers to functions in headers, not {POINTERS_MOST}", "core"
