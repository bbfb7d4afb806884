# SPDX-License-Identifier: Apache-2.0
"""Two hosts on one machine: network namespaces that a pair of veth interfaces joins."""
import os
import shutil
import subprocess

from support import Skip


def ip(*words):
    return subprocess.run(["ip", *words], capture_output=True, text=True)


class Hosts:
    """Makes two hosts and takes them away again.  Skips the test where that cannot be done."""

    addresses = ("10.91.7.1", "10.91.7.2")

    def __init__(self):
        tag = f"mt{os.getpid()}"
        self.names = (f"{tag}a", f"{tag}b")
        self.links = (f"{tag}u", f"{tag}v")  # at most 15 characters

    def __enter__(self):
        if os.geteuid() != 0:
            raise Skip("network namespaces need root: run the tests as root")
        if not shutil.which("ip"):
            raise Skip("no ip: package iproute2")
        try:
            self._make()
        except Skip:
            self._remove()
            raise
        return self

    def _do(self, *words):
        done = ip(*words)
        if done.returncode != 0:
            raise Skip("no network namespaces here, as in a container without the right to make "
                       f"them: ip {' '.join(words)}: {done.stderr.strip()}")

    def _make(self):
        for name in self.names:
            self._do("netns", "add", name)
        self._do("link", "add", self.links[0], "netns", self.names[0], "type", "veth", "peer",
                 "name", self.links[1], "netns", self.names[1])
        for name, link, address in zip(self.names, self.links, self.addresses):
            self._do("-n", name, "addr", "add", f"{address}/24", "dev", link)
            self._do("-n", name, "link", "set", "lo", "up")
            self._do("-n", name, "link", "set", link, "up")

    def _remove(self):
        for name in self.names:
            ip("netns", "del", name)

    def __exit__(self, *exc):
        self._remove()

    def on(self, host, *words):
        """The words of a command that runs on host 0 or 1."""
        return ["ip", "netns", "exec", self.names[host], *map(str, words)]

    def cut(self):
        """Pulls the cable."""
        self._do("-n", self.names[0], "link", "set", self.links[0], "down")

    def mend(self):
        self._do("-n", self.names[0], "link", "set", self.links[0], "up")

    def part(self):
        """Lets all packets between the hosts get lost, and leaves their interfaces as they are."""
        for host in (0, 1):
            self._do("-n", self.names[host], "neigh", "replace", self.addresses[1 - host], "lladdr",
                     "02:00:00:00:00:99", "dev", self.links[host], "nud", "permanent")

    def rejoin(self):
        for host in (0, 1):
            self._do("-n", self.names[host], "neigh", "del", self.addresses[1 - host], "dev",
                     self.links[host])
