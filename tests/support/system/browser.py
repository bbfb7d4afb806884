# SPDX-License-Identifier: Apache-2.0
"""Chromium without a window, driven by its own protocol over a plain socket."""
import base64
import json
import os
import pathlib
import re
import shutil
import socket
import struct
import subprocess
import tempfile
import time
import urllib.request

from support import PATIENCE, Skip

FLAGS = ("--headless=new", "--disable-gpu", "--no-first-run", "--disable-background-networking",
         "--disable-component-update", "--disable-sync", "--disable-quic", "--mute-audio",
         "--hide-scrollbars", "--remote-debugging-port=0")

SAID_MAX = 8  # a page that errs does so in each picture


def chromium():
    found = shutil.which("chromium") or shutil.which("chromium-browser")
    if not found:
        raise Skip("no browser: package chromium")
    return found


class WebSocket:
    """The client's side of RFC 6455, as far as text goes."""

    def __init__(self, url, patience):
        host, port, path = re.match(r"ws://([^:/]+):(\d+)(/.*)", url).groups()
        self.socket = socket.create_connection((host, int(port)), patience)
        self.buffer = b""
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET {path} HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\n"
                             f"Connection: Upgrade\r\nSec-WebSocket-Key: {key}\r\n"
                             "Sec-WebSocket-Version: 13\r\n\r\n").encode())
        while b"\r\n\r\n" not in self.buffer:
            self.fill()
        head, self.buffer = self.buffer.split(b"\r\n\r\n", 1)
        if b" 101 " not in head:
            raise OSError(head.decode())

    def fill(self):
        more = self.socket.recv(65536)
        if not more:
            raise OSError("the browser is gone")
        self.buffer += more

    def take(self, count):
        while len(self.buffer) < count:
            self.fill()
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def send(self, text):
        data, mask = text.encode(), os.urandom(4)
        size = len(data)
        head = bytes([0x81]) + (bytes([0x80 | size]) if size < 126 else
                                b"\xfe" + struct.pack(">H", size) if size < 65536 else
                                b"\xff" + struct.pack(">Q", size))
        self.socket.sendall(head + mask + bytes(b ^ mask[i % 4] for i, b in enumerate(data)))

    def receive(self):
        text = b""
        while True:
            first, second = self.take(2)
            size = second & 127
            if size > 125:
                size = struct.unpack(">H" if size == 126 else ">Q",
                                     self.take(2 if size == 126 else 8))[0]
            text += self.take(size) if first & 15 in (0, 1) else b""
            if first & 15 not in (0, 1):
                self.take(size)
            elif first & 0x80:
                return text.decode()


class Browser:
    """One page of one browser; both end with the block."""

    def __init__(self, url, width=1400, height=860, dark=False, patience=60):
        self.url, self.size, self.dark, self.patience = url, (width, height), dark, patience
        self.number, self.said = 0, []

    def __enter__(self):
        program = chromium()
        self.folder = tempfile.mkdtemp(prefix="muster-browser-")
        words = [program, *FLAGS, f"--user-data-dir={self.folder}",
                 f"--window-size={self.size[0]},{self.size[1]}"]
        words.append("--no-sandbox")  # root has none, nor has a folder that is somebody's root; it shows our pages alone
        self.process = subprocess.Popen([*words, "about:blank"], stdin=subprocess.DEVNULL,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            self.connect()
        except BaseException:
            self.__exit__()
            raise
        return self

    def connect(self):
        port_file = pathlib.Path(self.folder) / "DevToolsActivePort"
        until = time.monotonic() + self.patience
        while not (port_file.exists() and port_file.read_text().strip()):
            if time.monotonic() > until or self.process.poll() is not None:
                raise Skip("chromium does not start here")
            time.sleep(0.05)
        port = port_file.read_text().split()[0]
        pages = json.load(urllib.request.urlopen(f"http://127.0.0.1:{port}/json"))
        page = next(p for p in pages if p["type"] == "page")
        self.socket = WebSocket(page["webSocketDebuggerUrl"], self.patience)
        for domain in ("Page", "Runtime", "Log"):
            self.call(f"{domain}.enable")
        self.theme("dark" if self.dark else "light")
        self.call("Emulation.setDeviceMetricsOverride", width=self.size[0], height=self.size[1],
                  deviceScaleFactor=1, mobile=False)
        self.call("Page.navigate", url=self.url)
        self.wait(f"document.readyState === 'complete' && location.protocol === '{self.url.split(':')[0]}:'")

    def __exit__(self, *exc):
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(10)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)

    def call(self, method, **params):
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while True:
            message = json.loads(self.socket.receive())
            if message.get("id") == self.number:
                if "error" in message:
                    raise OSError(f"{method}: {message['error']}")
                return message["result"]
            self.note(message)

    def note(self, message):
        """Keeps what goes wrong in the page: exceptions, and what its security policy stops."""
        params = message.get("params", {})
        if len(self.said) == SAID_MAX:
            return
        if message.get("method") == "Runtime.exceptionThrown":
            self.said.append(params["exceptionDetails"].get("exception", {}).get("description")
                             or params["exceptionDetails"]["text"])
        elif message.get("method") == "Log.entryAdded":
            entry = params["entry"]
            if entry["level"] == "error" and entry["source"] != "network":
                self.said.append(entry["text"])

    def theme(self, name):
        self.call("Emulation.setEmulatedMedia",
                  features=[{"name": "prefers-color-scheme", "value": name}])

    def value(self, expression):
        """What an expression of JavaScript has, waited for if it is a promise."""
        result = self.call("Runtime.evaluate", expression=expression, returnByValue=True,
                           awaitPromise=True)
        if "exceptionDetails" in result:
            raise AssertionError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, expression, seconds=20):
        until = time.monotonic() + PATIENCE * seconds
        while time.monotonic() < until:
            value = self.value(expression)
            if value:
                return value
            time.sleep(0.05)
        raise AssertionError(f"not within {seconds} s: {expression}; the page said {self.said}")

    def click(self, selector, count=1):
        """A real click, in the middle of what is shown there."""
        box = self.wait(f"""(() => {{
            const e = document.querySelector({json.dumps(selector)});
            if (!e) return null;
            e.scrollIntoView({{block: 'nearest', inline: 'nearest'}});
            const b = e.getBoundingClientRect();
            return b.width && {{x: b.x + b.width / 2, y: b.y + b.height / 2}};
        }})()""")
        self.click_at(box["x"], box["y"], count)

    def click_at(self, x, y, count=1):
        for kind in ("mouseMoved", "mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, clickCount=count,
                      button="none" if kind == "mouseMoved" else "left")

    def drag(self, start, end, shift=False):
        """Presses at one place, (x, y), and lets go at another."""
        middle = ((start[0] + end[0]) / 2, (start[1] + end[1]) / 2)
        for kind, (x, y) in (("mouseMoved", start), ("mousePressed", start), ("mouseMoved", middle),
                             ("mouseMoved", end), ("mouseReleased", end)):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, clickCount=1, button="left",
                      buttons=0 if kind == "mouseReleased" else 1, modifiers=8 if shift else 0)

    def type(self, text):
        self.call("Input.insertText", text=text)

    def key(self, key, shift=False, repeats=0):
        """Presses a key, and lets it go when it has said itself so many times again."""
        codes = {"Enter": 13, "Escape": 27, "Tab": 9, "ArrowDown": 40}
        text = "\r" if key == "Enter" else key if len(key) == 1 else ""
        held = 8 if shift else 0
        for i in range(repeats + 1):
            self.call("Input.dispatchKeyEvent", type="keyDown", key=key, text=text, modifiers=held,
                      autoRepeat=i > 0, windowsVirtualKeyCode=codes.get(key, ord(key[0].upper())))
        self.call("Input.dispatchKeyEvent", type="keyUp", key=key, modifiers=held)

    def shot(self, path):
        data = self.call("Page.captureScreenshot", format="png")["data"]
        pathlib.Path(path).write_bytes(base64.b64decode(data))
