# SPDX-License-Identifier: Apache-2.0
"""Roads from workers to their coordinator that can be cut, stalled and slowed: a proxy per worker, or network
namespaces."""

import os
import shutil
import socket
import subprocess
import threading
import time


class Proxy:
    """Takes TCP connections and hands bytes on. Cut: connections are reset and new ones refused at once. Stalled:
    nothing passes, nothing is lost. Slow: what passes comes `delay` seconds late."""

    def __init__(self, target):
        host, port = target.rsplit(":", 1)
        self.target = (host, int(port))
        self.listener = socket.create_server(("127.0.0.1", 0))
        self.address = f"127.0.0.1:{self.listener.getsockname()[1]}"
        self.cut_off, self.delay, self.closed = False, 0.0, False
        self.open = threading.Event()
        self.open.set()
        self.lock, self.pairs = threading.Lock(), []
        threading.Thread(target=self.accept, daemon=True).start()

    def accept(self):
        while not self.closed:
            try:
                near, _ = self.listener.accept()
                if self.cut_off:
                    near.close()
                    continue
                far = socket.create_connection(self.target, timeout=5)
                far.settimeout(None)
            except OSError:
                if not self.closed:
                    near.close()
                continue
            with self.lock:
                self.pairs.append((near, far))
            for a, b in ((near, far), (far, near)):
                threading.Thread(target=self.carry, args=(a, b), daemon=True).start()

    def carry(self, source, sink):
        try:
            while data := source.recv(1 << 16):
                self.open.wait()
                if self.delay:
                    time.sleep(self.delay)
                sink.sendall(data)
        except OSError:
            pass
        for s in (source, sink):
            close(s)
        with self.lock:
            self.pairs = [p for p in self.pairs if source not in p]

    def cut(self):
        self.cut_off = True
        with self.lock:
            pairs, self.pairs = self.pairs, []
        for pair in pairs:
            for s in pair:
                close(s)

    def stall(self):
        self.open.clear()

    def slow(self, seconds):
        self.delay = seconds

    def heal(self):
        self.cut_off, self.delay = False, 0.0
        self.open.set()

    def end(self):
        self.closed = True
        self.heal()
        self.cut()
        self.listener.close()


def close(s):
    try:
        s.shutdown(socket.SHUT_RDWR)
    except OSError:
        pass
    s.close()


def ip(*words, check=True):
    return subprocess.run(["ip", *words], check=check, capture_output=True, text=True)


class Bridge:
    """A network of its own: the coordinator is at `host`, workers in namespaces on the other ends of veth pairs."""

    @staticmethod
    def why_not():
        if os.geteuid() != 0 or not shutil.which("ip"):
            return "network namespaces take root and ip"
        name = f"tsa-try{os.getpid()}"
        tried = ip("netns", "add", name, check=False)
        ip("netns", "del", name, check=False)
        return tried.stderr.strip() if tried.returncode else ""

    def __init__(self):
        self.tag = os.getpid() % 10000
        self.net = f"10.{77 + self.tag % 100}.{self.tag // 100}"
        self.host = f"{self.net}.1"
        self.name, self.cables = f"tsab{self.tag}", {}
        ip("link", "add", self.name, "type", "bridge")
        ip("addr", "add", f"{self.host}/24", "dev", self.name)
        ip("link", "set", self.name, "up")

    def cable(self, worker):
        if worker not in self.cables:
            self.cables[worker] = Cable(self, worker, len(self.cables) + 2)
        return self.cables[worker]

    def end(self):
        for cable in self.cables.values():
            ip("netns", "del", cable.space, check=False)
        ip("link", "del", self.name, check=False)


class Cable:
    """A veth pair. Cut and stalled are one: packets get lost, connections stay until they time out."""

    def __init__(self, bridge, worker, number):
        self.space = f"tsa{bridge.tag}-{worker}"
        self.link = f"tsav{bridge.tag}-{number}"
        ip("netns", "add", self.space)
        ip("link", "add", self.link, "type", "veth", "peer", "name", "eth0", "netns", self.space)
        ip("link", "set", self.link, "master", bridge.name, "up")
        for words in (["link", "set", "lo", "up"], ["addr", "add", f"{bridge.net}.{number}/24", "dev", "eth0"], ["link", "set", "eth0", "up"]):
            ip("-n", self.space, *words)
        self.prefix = ["ip", "netns", "exec", self.space]

    def cut(self):
        ip("link", "set", self.link, "down")

    stall = cut

    def slow(self, seconds):
        """False if this kernel cannot."""
        tc = shutil.which("tc")
        words = [tc, "qdisc", "replace", "dev", self.link, "root", "netem", "delay", f"{int(seconds * 1000)}ms"]
        return bool(tc) and subprocess.run(words, capture_output=True).returncode == 0

    def heal(self):
        ip("link", "set", self.link, "up")
        if tc := shutil.which("tc"):
            subprocess.run([tc, "qdisc", "del", "dev", self.link, "root"], capture_output=True)
