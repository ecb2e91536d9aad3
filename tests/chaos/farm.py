# SPDX-License-Identifier: Apache-2.0
"""A farm of real processes: a coordinator, workers, people's commands. Starts, ends and asks them; decides nothing."""

import json
import os
import signal
import socket
import subprocess
import time
from pathlib import Path

UNREACHABLE = 6  # exit code of a command whose coordinator does not answer


def free_port(host="127.0.0.1"):
    with socket.socket() as s:
        s.bind((host, 0))
        return s.getsockname()[1]


def wait_for(what, condition, seconds=30.0):
    """Waits until condition() is true, and returns what it gave."""
    end = time.monotonic() + seconds
    while True:
        got = condition()
        if got:
            return got
        if time.monotonic() > end:
            raise TimeoutError(f"waited {seconds:.0f} s for {what}")
        time.sleep(0.02)


def threads(pid):
    """What each thread of a process is at, as the kernel sees it: for what hangs."""
    at = []
    for task in Path(f"/proc/{pid}/task").glob("*"):
        state = (task / "stat").read_text().rsplit(")", 1)[1].split()[0]
        at.append(f"{(task / 'comm').read_text().strip()} {state} {(task / 'wchan').read_text()}")
    return ", ".join(at)


class Process:
    """One life after another of one program; all write to one log."""

    def __init__(self, name, log, command, env=None, prefix=()):
        self.name, self.log, self.command, self.prefix = name, Path(log), list(command), list(prefix)
        self.env = dict(os.environ, **(env or {}))
        self.child = None
        self.stopped = False
        self.lives = 0

    def start(self):
        self.begins = self.log.stat().st_size if self.log.exists() else 0
        with self.log.open("ab") as out:
            self.child = subprocess.Popen(self.prefix + self.command, stdout=out, stderr=out, env=self.env)
        self.lives += 1
        self.stopped = False

    def alive(self):
        return self.child is not None and self.child.poll() is None

    def pid(self):
        return self.child.pid

    def send(self, sig):
        if self.alive():
            self.child.send_signal(sig)
            self.stopped = sig == signal.SIGSTOP or (self.stopped and sig != signal.SIGCONT)

    def kill(self):
        self.send(signal.SIGKILL)
        if self.child:
            self.child.wait()

    def ended(self, seconds=20.0):
        """The exit code, or None if it had to be killed."""
        try:
            return self.child.wait(seconds)
        except subprocess.TimeoutExpired:
            self.kill()
            return None

    def leave(self):
        """SIGTERM, once: a second one ends it at once."""
        self.send(signal.SIGTERM)
        return self.ended()

    def said(self, words):
        """In any of its lives."""
        return self.log.exists() and words in self.log.read_text(errors="replace")

    def says(self, words):
        """In this life."""
        return self.log.exists() and words in self.log.read_bytes()[self.begins :].decode(errors="replace")


class Keys:
    """A pair for the coordinator, one for all workers, one for each owner."""

    def __init__(self, tessera, folder, owners):
        self.folder = Path(folder)
        self.folder.mkdir(parents=True)
        lines = []
        for name in ("coordinator", "worker", *owners):
            said = subprocess.run([tessera, "keygen", "-o", self.folder / name], check=True, capture_output=True, text=True)
            public = said.stdout.split()[-1]
            role = {"coordinator": None, "worker": "worker"}.get(name, "submitter,administrator")
            if role:
                lines.append(f"{role} {name} {public}\n")
        (self.folder / "allow").write_text("".join(lines))

    def of_server(self):
        return ["--key", str(self.folder / "coordinator.key"), "--allow", str(self.folder / "allow")]

    def of_client(self, name):
        return ["--key", str(self.folder / f"{name}.key"), "--server-key", str(self.folder / "coordinator.pub")]


class Farm:
    """`road` maps a worker's name to (HOST:PORT it connects to, prefix of its command)."""

    def __init__(self, tessera, folder, silence=1.5, owners=("ada", "bob"), keys=False, host="127.0.0.1", road=None, more=()):
        self.tessera, self.folder, self.owners = str(tessera), Path(folder), list(owners)
        self.folder.mkdir(parents=True, exist_ok=True)
        self.keys = Keys(self.tessera, self.folder / "keys", owners) if keys else None
        self.address = f"{host}:{free_port(host)}"
        self.store = self.folder / "store"
        self.road = road or (lambda name: (self.address, []))
        command = [self.tessera, "coordinator", "--listen", self.address, "--store", str(self.store)]
        command += ["--silence", str(silence), *more, *(self.keys.of_server() if self.keys else [])]
        self.coordinator = Process("coordinator", self.folder / "coordinator.log", command)
        self.workers, self.hung = {}, []

    def start_coordinator(self):
        self.coordinator.start()

        def listens():
            if not self.coordinator.alive():
                raise RuntimeError(f"the coordinator ended with {self.coordinator.child.returncode}")
            return self.coordinator.says("listens on")

        try:
            wait_for("the coordinator to listen", listens, 180)
        except TimeoutError as error:
            raise TimeoutError(f"{error}; its threads: {threads(self.coordinator.pid())}") from None

    def worker(self, name, more=()):
        address, prefix = self.road(name)
        command = [self.tessera, "worker", "--coordinator", address, "--name", name, "--threads", "1", "--grace", "5"]
        command += ["--cache", str(self.folder / f"cache-{name}"), *more]
        command += self.keys.of_client("worker") if self.keys else []
        env = {"POCL_MAX_PTHREAD_COUNT": "1"}
        self.workers[name] = Process(name, self.folder / f"worker-{name}.log", command, env, prefix)
        return self.workers[name]

    def words(self, owner, command, *args):
        keys = self.keys.of_client(owner) if self.keys else []
        return [self.tessera, command, *map(str, args), "--coordinator", self.address, *keys]

    def ask(self, command, *args, owner=None, seconds=60, timeout=10):
        words = self.words(owner or self.owners[0], command, *args, "--timeout", timeout)
        with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as child:
            try:
                out, err = child.communicate(timeout=seconds)
            except subprocess.TimeoutExpired:
                what = threads(child.pid)
                child.kill()
                self.hung.append(f"{command} did not end in {seconds} s; its threads: {what}")
                return subprocess.CompletedProcess(words, UNREACHABLE, "", self.hung[-1])
        return subprocess.CompletedProcess(words, child.returncode, out, err)

    def insist(self, command, *args, owner=None, seconds=600):
        """Asks until the coordinator is there; what was said, with exit code 0."""
        end = time.monotonic() + seconds
        while True:
            done = self.ask(command, *args, owner=owner)
            if done.returncode == 0:
                return done
            if done.returncode != UNREACHABLE or time.monotonic() > end:
                raise RuntimeError(f"{command} {args}: ended with {done.returncode}: {done.stderr.strip()}")

    def job(self, name):
        return json.loads(self.insist("jobs", name, "--json").stdout)

    def jobs(self):
        return json.loads(self.insist("jobs", "--all", "--json").stdout)

    def present(self):
        return json.loads(self.insist("workers", "--json").stdout)

    def end(self):
        for process in (*self.workers.values(), self.coordinator):
            process.send(signal.SIGCONT)
            process.kill()
