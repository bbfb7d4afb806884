# SPDX-License-Identifier: Apache-2.0
"""Brokers, started fresh and ended by their process ids, and the programs that load them."""
import contextlib
import json
import os
import pathlib
import shutil
import socket
import statistics
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
BUILD = ROOT / os.environ.get("O", "build/" + os.environ.get("BUILD", "release"))
BROKER = BUILD / "bin" / "muster-broker"
DIRECT = BUILD / "bench" / "micro" / "bus_direct"
NAMES = BUILD / "bench" / "micro" / "runtime_names"
# Nobody else's: `muster run`, the tests and `make bench` pick lower ones.
OUR_DOMAIN, DIRECT_DOMAIN = 218, 219


class Failed(Exception):
    pass


def measure(*words, timeout_s=150, env=None):
    """What one program prints: a JSON value, or nothing."""
    words = [str(w) for w in words]
    done = subprocess.run(words, capture_output=True, text=True, timeout=timeout_s,
                          stdin=subprocess.DEVNULL, env=env)
    if done.returncode != 0:
        raise Failed(f"{' '.join(words)}: exit code {done.returncode}: {done.stderr.strip()}")
    return json.loads(done.stdout) if done.stdout else None


@contextlib.contextmanager
def background(*words, says=False, mute=False):
    """A process that ends with the block; says: it prints a line of JSON when it is ready."""
    words = [str(w) for w in words]
    process = subprocess.Popen(words, stdin=subprocess.DEVNULL, text=True,
                               stdout=subprocess.PIPE if says else subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL if mute else None)
    try:
        if says:
            line = process.stdout.readline()
            if not line:
                raise Failed(f"{' '.join(words)}: said nothing")
            process.said = json.loads(line)
        yield process
    finally:
        process.terminate()
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        if process.stdout:
            process.stdout.close()


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def port_await(port):
    until = time.monotonic() + 5
    while time.monotonic() < until:
        with socket.socket() as s:
            if s.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.01)
    raise Failed(f"nobody listens at port {port}")


class Broker:
    """One that runs: the process, where clients find it, and the program that loads it."""

    def __init__(self, process, where, peer, folder):
        self.pid, self.where, self.folder = process and process.pid, where, folder
        self.program = BUILD / "bench" / "broker" / peer
        self.those = []  # the crowd's processes

    def load(self, word, *words):
        """With the processor time of the broker and of all who are there, a unit of the load."""
        watch = os.environ | {"LOAD_WATCH": " ".join(map(str, [self.pid] + self.those))}
        return measure(self.program, word, self.where, *words, env=watch if self.pid else None)

    def beside(self, word, *words, says=False):
        return background(self.program, word, self.where, *words, says=says)

    @contextlib.contextmanager
    def crowd(self, count):
        """Processes a0, a1, ..., all reachable, and the board that they write on."""
        board = self.folder / f"board-{time.monotonic_ns()}"
        with self.beside("crowd", count, board, says=True) as crowd:
            if crowd.said["ready"] != count:
                raise Failed(f"{self.program.name}: {crowd.said['ready']} of {count} are ready")
            crowd.board = board
            children = pathlib.Path(f"/proc/{crowd.pid}/task/{crowd.pid}/children").read_text()
            self.those = [int(pid) for pid in children.split()]
            yield crowd
        self.those = []
        board.unlink()

    def resident_kb(self):
        for line in pathlib.Path(f"/proc/{self.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS:"):
                return int(line.split()[1])
        raise Failed(f"no memory of {self.pid}")


class Here:
    """Where the benchmark keeps its files, and how it starts brokers."""

    def __init__(self, folder):
        self.folder = folder
        self.turn = 0  # who is first
        self.help = subprocess.run([BROKER, "--help"], capture_output=True, text=True,
                                   timeout=10).stdout

    def broker_has(self, option):
        return option in self.help

    def direct_us(self):
        """The median of several runs: one pair may happen to share a processor, or not."""
        with background(DIRECT, "echo", DIRECT_DOMAIN):
            return statistics.median(measure(DIRECT, "ping", DIRECT_DOMAIN, 500)
                                     for _ in range(5))

    @contextlib.contextmanager
    def folder_fresh(self):
        folder = folder_in(self.folder)
        try:
            yield folder
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    @contextlib.contextmanager
    def direct(self, crowd):
        """No broker, the bus alone: one writes and a crowd reads."""
        with self.folder_fresh() as folder:
            yield Broker(None, f"{DIRECT_DOMAIN}:{crowd}", "peer_dds", folder)

    @contextlib.contextmanager
    def star(self):
        """No broker, DDS alone: everybody is matched with one hub."""
        with self.folder_fresh() as folder:
            hub = Broker(None, DIRECT_DOMAIN, "peer_dds", folder)
            with hub.beside("deaf", "hub", says=True):
                yield hub

    @contextlib.contextmanager
    def ours(self, *options):
        with self.folder_fresh() as folder:
            store = ["--store", folder / "mail.db"] if self.broker_has("--store") else []
            with background(BROKER, "bench", "--domain", OUR_DOMAIN, *store, *options) as process:
                time.sleep(0.3)
                if process.poll() is not None:
                    raise Failed(f"muster-broker ended with {process.returncode}")
                yield Broker(process, OUR_DOMAIN, "peer_muster", folder)

    @contextlib.contextmanager
    def mosquitto(self):
        with self.folder_fresh() as folder:
            port = free_port()
            settings = {"listener": f"{port} 127.0.0.1", "allow_anonymous": "true",
                        "persistence": "false", "max_queued_messages": 0,
                        "max_inflight_messages": 200, "set_tcp_nodelay": "true",
                        "log_dest": "none"}
            if os.geteuid() == 0:
                settings["user"] = "root"
            file = folder / "mosquitto.conf"
            file.write_text("".join(f"{key} {value}\n" for key, value in settings.items()))
            program = shutil.which("mosquitto") or "/usr/sbin/mosquitto"
            with background(program, "-c", file, mute=True) as process:  # of being root
                port_await(port)
                yield Broker(process, port, "peer_mqtt", folder)

    @contextlib.contextmanager
    def nats(self):
        with self.folder_fresh() as folder:
            port = free_port()
            program = shutil.which("nats-server") or "/usr/sbin/nats-server"
            with background(program, "-a", "127.0.0.1", "-p", port, mute=True) as process:
                port_await(port)
                yield Broker(process, port, "peer_nats", folder)

    @contextlib.contextmanager
    def redis(self):
        with self.folder_fresh() as folder:
            port = free_port()
            with background("redis-server", "--port", port, "--bind", "127.0.0.1", "--dir", folder,
                            "--save", "", "--appendonly", "yes", "--appendfsync",
                            "always") as process:
                port_await(port)
                yield Broker(process, port, "peer_redis", folder)


def folder_in(folder):
    at = folder / f"broker-{time.monotonic_ns()}"
    at.mkdir()
    return at
