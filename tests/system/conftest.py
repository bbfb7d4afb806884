# SPDX-License-Identifier: Apache-2.0
"""Sets pytest up for the system tests: the longest first, a folder of its own for each worker."""
import os
import pathlib
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path.insert(0, str(ROOT / "tests" / "support" / "system"))

import support  # noqa: E402

QUICK_S, SLOW_S = 1, 4


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items):
    """The longest first; a test bears the mark `quick` or `slow` by the time in tests/times.txt."""
    lines = (ROOT / "tests" / "times.txt").read_text().splitlines()
    cost_s = {name: float(took_s) for name, took_s in (line.rsplit(" ", 1) for line in lines)}

    def cost(item):
        return cost_s.get(f"{item.path.stem}::{item.name}", 0)
    items.sort(key=cost, reverse=True)
    for item in items:
        if cost(item) > SLOW_S:
            item.add_marker("slow")
        elif cost(item) < QUICK_S:
            item.add_marker("quick")


@pytest.fixture(scope="session", autouse=True)
def own_folder():
    """What a worker's programs note down stays apart from the user's and the other workers'."""
    with support.folder() as own:
        os.environ["XDG_RUNTIME_DIR"] = str(own)
        yield
