#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Single misfortunes of a farm of real processes, each with what is promised about it. `trials.py TESSERA TRIAL...`;
ends with 77 if a trial cannot be tried here, and says why."""

import argparse
import random
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from pathlib import Path

sys.dont_write_bytecode = True
from damage import clock_jump, damaged_blob, damaged_database, damaged_journal
from farm import wait_for
from room import full_at_the_end, full_disk
from roads import Proxy
from trial import Skip, Trial, require
from work import SCENES, Work

SKIPPED = 77


def duplicate(t):
    """A second coordinator on a store is refused, also while the first does not answer."""
    farm = t.farm()
    farm.start_coordinator()
    other = [t.tessera, "coordinator", "--listen", "127.0.0.1:0", "--store", str(farm.store)]
    for sig in (signal.SIGCONT, signal.SIGSTOP):
        farm.coordinator.send(sig)
        done = subprocess.run(other, capture_output=True, text=True, timeout=60)
        require(done.returncode == 2, f"the second one ended with {done.returncode}")
        require(f"process {farm.coordinator.pid()} is at work on it" in done.stderr, f"it said: {done.stderr}")
    farm.coordinator.send(signal.SIGCONT)
    farm.insist("jobs")
    farm.coordinator.kill()
    farm.start_coordinator()  # what a dead one held is free


def stranger(t):
    """Who has no key that is let in is told so, on stderr alone: what programs read is JSON or nothing."""
    farm = t.farm(keys=True)
    farm.start_coordinator()
    subprocess.run([t.tessera, "keygen", "-o", farm.keys.folder / "mallory"], check=True, capture_output=True)
    words = [t.tessera, "jobs", "--json", "--timeout", "3", "--coordinator", farm.address, *farm.keys.of_client("mallory")]
    done = subprocess.run(words, capture_output=True, text=True)
    require(done.returncode == 6, f"it ended with {done.returncode}")
    require(done.stdout == "", f"on stdout it said: {done.stdout}")
    require("allow-list has no line" in done.stderr, f"on stderr it said: {done.stderr}")


def early_worker(t):
    """A worker that is there before its coordinator works as soon as that comes."""
    farm = t.farm(keys=True)
    worker = farm.worker("w1")
    worker.start()
    wait_for("the worker to try", lambda: worker.said("works for"), 60)
    require(worker.alive(), "the worker did not wait")
    farm.start_coordinator()
    t.submit(farm, Work("fixed", 0))
    t.same(farm, Work("fixed", 0))
    require(worker.lives == 1 and worker.alive(), "the worker ended")


def write_noise(path, size, seed):
    """A PNG that does not shrink."""
    noise = random.Random(seed)
    rows = b"".join(b"\0" + noise.randbytes(3 * size) for _ in range(size))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    head = struct.pack(">IIBBBBB", size, size, 8, 2, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 0)) + chunk(b"IEND", b""))


def scene_with_noise(folder, size):
    folder.mkdir()
    text = (SCENES / "furnace.json").read_text().replace('"environment": { "radiance": 1 }', '"environment": { "image": "noise.png" }')
    require("noise.png" in text, "the scene has no environment to replace")
    (folder / "scene.json").write_text(text)
    write_noise(folder / "noise.png", size, 5)


def cut_upload(t):
    """`submit` that was killed in the middle of an upload goes on where it was."""
    farm = t.farm()
    farm.start_coordinator()
    scene = t.folder / "scene"
    scene_with_noise(scene, 1600)
    work = Work("fixed", 0)
    work.kind, work.words[0] = "noise", str(scene / "scene.json")
    size = (scene / "noise.png").stat().st_size
    slow = Proxy(farm.address)
    slow.slow(0.02)
    words = farm.words("ada", "submit", *work.words, "--job", "job", "-v")
    words[words.index(farm.address)] = slow.address
    first = subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def sent():
        require(first.poll() is None, "the upload ended before it could be cut")
        return sum(p.stat().st_size for p in (farm.store / "uploads").glob("*")) > size / 4

    wait_for("a part of the upload", sent, 120)
    first.kill()
    first.wait()
    slow.end()
    wait_for("the coordinator to have seen all", lambda: farm.ask("jobs").returncode == 0)
    have = max(p.stat().st_size for p in (farm.store / "uploads").glob("*"))
    require(size / 4 < have < size, f"{have} of {size} bytes are there")
    second = farm.insist("submit", *work.words, "--job", "job", "-v")
    counted = int(second.stderr.split(" bytes were uploaded")[0].split()[-1])
    require(size - have <= counted < size - have + 100_000, f"of {size} bytes {have} were there, {counted} were sent")
    print(f"{size} bytes, {have} of them were there, {counted} were sent the second time")
    farm.worker("w1").start()
    t.same(farm, work)


TRIALS = {f.__name__: f for f in (duplicate, stranger, early_worker, cut_upload, full_disk, full_at_the_end, damaged_journal, damaged_database, damaged_blob, clock_jump)}


def run(trial, options):
    """Whether it went as promised; None if it cannot be tried here."""
    folder, begun = Path(tempfile.mkdtemp(prefix=f"tessera-{trial}-")), time.monotonic()
    t = Trial(options, folder)
    try:
        TRIALS[trial](t)
    except Skip as why:
        print(f"SKIPPED {trial}: {why}")
        return None
    except Exception as error:  # whatever it is, it did not go as promised
        print(f"FAILED {trial}: {error!r}\nlogs and store are in {folder}")
        return False
    finally:
        t.end()
    shutil.rmtree(folder)
    print(f"passed {trial}: {TRIALS[trial].__doc__} {time.monotonic() - begun:.1f} s", flush=True)
    return True


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tessera")
    parser.add_argument("trial", nargs="*", metavar="TRIAL", help=", ".join(TRIALS) + " [all]")
    parser.add_argument("--local", help="folder in which local renders of the same program are kept between runs")
    parser.add_argument("--shifter", help="library that shifts the clock of processes")
    options = parser.parse_args()
    results = [run(trial, options) for trial in options.trial or TRIALS]
    return 1 if False in results else SKIPPED if set(results) == {None} else 0


if __name__ == "__main__":
    sys.exit(main())
