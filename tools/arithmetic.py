# SPDX-License-Identifier: Apache-2.0
"""No elementary function of the C library in a program whose work enters a run's hash.

The C library rounds the last bit of a sine by what the processor has.  musl's functions are linked
into each program, where its own code, CLIPS, ODE and libccd find them first.
"""
import re
import subprocess

# What computes what enters the hash, and the libraries that it computes with.
PROGRAMS = ("muster", "muster-sim", "muster-robot", "muster-agent", "muster-host", "muster-monitor")
LIBRARIES = ("libode.so", "libccd.so")
# The functions of <math.h> whose last bit is not prescribed.
ELEMENTARY = re.compile(r"(a?(sin|cos|tan)h?|atan2|sincos|exp|exp2|exp10|pow10|expm1|log|log2|log10|log1p|pow|hypot|cbrt|erfc?|"
                        r"[lt]gamma|lgamma_r|gamma|[jy][01n])[fl]?")


def symbols(path, *options):
    """The dynamic symbols of a file, without the versions of a library."""
    done = subprocess.run(["nm", "-D", *options, path], capture_output=True, text=True, check=True)
    return {line.split()[-1].split("@")[0] for line in done.stdout.splitlines()}


def libraries(program):
    """The files of the libraries that a program is loaded with, of those that enter the hash."""
    done = subprocess.run(["ldd", program], capture_output=True, text=True, check=True)
    found = re.findall(r"^\s*(\S+) => (/\S+)", done.stdout, re.M)
    return [path for name, path in found if name.startswith(LIBRARIES)]


def problems(build):
    """@return (program, what is wrong with it)"""
    for program in (build / "bin" / name for name in PROGRAMS):
        if not program.exists():
            continue
        own = symbols(program, "--defined-only")
        for path in (program, *libraries(program)):
            foreign = sorted(filter(ELEMENTARY.fullmatch, symbols(path, "--undefined-only") - own))
            if foreign:
                what = "calls" if path == program else f"loads {path}, which calls"
                yield program, f"{what} {' '.join(foreign)} of the C library: ELEMENTARY of the Makefile lacks it"
