# SPDX-License-Identifier: Apache-2.0
"""A program on a pseudo-terminal: what it shows, and what a person types."""
import fcntl
import os
import pty
import re
import select
import signal
import struct
import termios
import time

from support import PATIENCE

ESCAPES = re.compile(rb"\x1b\[[0-9;?]*[A-Za-z]|\x1b[()][AB0]|\x1b[=>]")


class Terminal:
    """Ends its program with the test, however it ends."""

    def __init__(self, *words, env=None, columns=0):
        self.raw = b""
        self.status = None
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            if columns:
                fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
            # libedit never frees the names of functions that it is given
            os.environ.update({"TERM": "xterm", "NO_COLOR": "", "ASAN_OPTIONS": "detect_leaks=0",
                               **(env or {})})
            os.execv(str(words[0]), [str(w) for w in words])

    def __enter__(self):
        return self

    def __exit__(self, *exc):
        if self.status is None:
            try:
                os.kill(self.pid, signal.SIGKILL)
                os.waitpid(self.pid, 0)
            except (ProcessLookupError, ChildProcessError):
                pass
        os.close(self.fd)

    def _read(self, timeout):
        ready, _, _ = select.select([self.fd], [], [], timeout)
        if not ready:
            return True
        try:
            got = os.read(self.fd, 65536)
        except OSError:
            return False
        self.raw += got
        return bool(got)

    @property
    def text(self):
        """All that was shown, without what moves the cursor or colours."""
        return ESCAPES.sub(b"", self.raw).decode(errors="replace").replace("\r", "")

    def type(self, text):
        """Types, and reads meanwhile: a terminal holds only so much."""
        data = text.encode()
        while data:
            _, writable, _ = select.select([], [self.fd], [], 0.05)
            if writable:
                data = data[os.write(self.fd, data[:512]):]
            self._read(0)

    def wait_for(self, words, seconds=15, since=0):
        """Reads until the words are shown behind a place.  Gives the place behind them."""
        until = time.monotonic() + PATIENCE * seconds
        while time.monotonic() < until:
            at = self.text.find(words, since)
            if at >= 0:
                return at + len(words)
            if not self._read(0.05):
                break
        at = self.text.find(words, since)
        if at >= 0:
            return at + len(words)
        raise AssertionError(f"not shown within {seconds} s: {words!r} in {self.text[since:]!r}")

    def do(self, line, words, seconds=15):
        """Types a line and waits for words behind it."""
        since = len(self.text)
        self.type(line + "\r")
        return self.wait_for(words, seconds, since)

    def end(self, seconds=10):
        """Waits until the program has ended.  Gives its exit code."""
        until = time.monotonic() + PATIENCE * seconds
        while time.monotonic() < until:
            self._read(0.05)
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                self.status = status
                return os.waitstatus_to_exitcode(status)
        raise AssertionError(f"it has not ended within {seconds} s: {self.text[-500:]!r}")
