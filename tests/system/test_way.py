# SPDX-License-Identifier: Apache-2.0
"""Walks the way of one plain mail through the broker, without a store and to one receiver, and counts
its stays: each time that control enters a file of src/broker that it was not in, returns included."""
import subprocess

from support import BUILD, check

WAY = BUILD / "test" / "way"
# The function that puts a mail into a box, and how many stays there may be until it has done so, and
# until the receiver has acknowledged the mail.
PUT = "mailbox_put"
BOX_MAX, ALL_MAX = 14, 45


def names(offsets):
    """{offset: (function, file)} of the functions that the program names by offset."""
    if not offsets:
        return {}
    lines = subprocess.run(["addr2line", "-f", "-e", str(WAY), *offsets], check=True,
                           capture_output=True, text=True).stdout.splitlines()
    return {o: (lines[2 * i], lines[2 * i + 1].rsplit(":", 1)[0].rsplit("src/broker/", 1)[-1])
            for i, o in enumerate(offsets)}


def walk():
    """[(function, file, it is a return)], one for each stay, and {mark: stays until then}."""
    run = subprocess.run([str(WAY)], check=True, capture_output=True, text=True)
    events = [line.split() for line in run.stdout.splitlines() if line[:2] in ("+ ", "- ", "= ")]
    known = names(sorted({what for mark, what in events if mark != "="}))
    stays, marks, stack, at = [], {}, [], None
    for mark, what in events:
        if mark == "=":
            marks[what] = len(stays)
            at = None  # the caller is in between
            continue
        if mark == "+":
            stack.append(known[what])
        elif stack.pop()[0] == PUT:
            marks["box"] = len(stays)
        if stack and stack[-1][1] != at:
            stays.append((*stack[-1], mark == "-"))
            at = stack[-1][1]
    return stays, marks


def test_a_plain_mail_passes_few_files():
    stays, marks = walk()
    for i, (function, file, returned) in enumerate(stays, 1):
        print(f"{i:3} {'back in' if returned else 'to':7} {file:28} {function}")
    files = {file for _, file, _ in stays}
    print(f"stays: {marks}, in {len(files)} files, {sum(r for _, _, r in stays)} by a return")
    check(marks["box"] <= BOX_MAX and marks["acknowledged"] <= ALL_MAX,
          f"{marks} stays, at most {BOX_MAX} to the box and {ALL_MAX} in all wanted")
