#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Single misfortunes of a farm of real processes, each with what is promised about it. `trials.py TESSERA TRIAL...`;
ends with 77 if a trial cannot be tried here, and says why."""

import argparse
import os
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
from farm import Farm, wait_for
from roads import Proxy
from work import SCENES, References, Result, Work

SKIPPED = 77


class Skip(Exception):
    pass


def require(true, what):
    if not true:
        raise AssertionError(what)


class Trial:
    """A farm in a folder of its own, and what jobs should come to."""

    def __init__(self, options, folder):
        self.tessera, self.folder, self.options = options.tessera, folder, options
        self.references = References(self.tessera, options.local or folder / "local")
        self.farms = []

    def farm(self, name="farm", **more):
        self.farms.append(Farm(self.tessera, self.folder / name, **more))
        return self.farms[-1]

    def with_worker(self, name="farm", **more):
        farm = self.farm(name, **more)
        farm.start_coordinator()
        farm.worker("w1").start()
        return farm

    def submit(self, farm, work, job="job"):
        farm.insist("submit", *work.words, "--job", job)

    def fetch(self, farm, work, job="job"):
        folder = self.folder / f"fetched-{job}"
        shutil.rmtree(folder, ignore_errors=True)
        done = farm.insist("fetch", job, "--wait", "-o", folder / work.output, "--quiet", seconds=300)
        require(done.returncode == 0, f"fetch ended with {done.returncode}")
        return Result(work, folder)

    def same(self, farm, work, job="job"):
        got, wanted = self.fetch(farm, work, job), self.references.of(work)
        require(got.digests == wanted.digests, f"{job} has other pixels than a local render")
        require(farm.job(job)["pixel_samples"] == wanted.samples, f"{job} counts other samples than a local render")

    def end(self):
        for farm in self.farms:
            farm.end()

    # A shot with some frames, killed with its coordinator when a journal has at least so many bytes.
    def killed_on_the_way(self, farm, bytes_kept=20_000):
        self.submit(farm, Work("shot", 0))

        def journals():
            return [p for p in (farm.store / "frames").glob("*/*") if p.stat().st_size >= bytes_kept]

        found = wait_for("a journal", journals, 300)
        farm.coordinator.kill()
        return [p for p in found if p.exists()]


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
    print(f"{size} bytes, {have} of them were there, {counted} were sent again with the rest of the job")
    farm.worker("w1").start()
    t.same(farm, work)


def full_disk(t):
    """A full disk: said, submitting refused; with room again the job ends with the same bits."""
    farm = t.farm()
    farm.store.mkdir()
    if os.geteuid() != 0:
        raise Skip("a small disk takes root")
    mount = ["mount", "-t", "tmpfs", "-o", "size=24m", "none", str(farm.store)]
    if subprocess.run(mount, capture_output=True).returncode != 0:
        raise Skip("tmpfs cannot be mounted here")
    try:
        farm.start_coordinator()
        t.submit(farm, Work("shot", 0))
        filler = farm.store / "filler"
        with filler.open("wb", buffering=0) as out:
            try:
                while True:
                    out.write(bytes(1 << 16))
            except OSError:
                pass
        farm.worker("w1").start()
        wait_for("the coordinator to say that the disk is full", lambda: farm.coordinator.said("nothing goes on until it works again"), 120)
        refused = farm.ask("submit", *Work("fixed", 0).words, "--job", "late")
        require(refused.returncode not in (0, 6), f"submit ended with {refused.returncode}")
        require("space" in refused.stderr or "room" in refused.stderr, f"submit said: {refused.stderr}")
        print(f"submit: exit code {refused.returncode}: {refused.stderr.strip()}")
        filler.unlink()
        t.same(farm, Work("shot", 0))
        t.submit(farm, Work("fixed", 0), "late")
        t.same(farm, Work("fixed", 0), "late")
        farm.end()
    finally:
        farm.end()
        subprocess.run(["umount", str(farm.store)], check=False)


def flip(path, at):
    with path.open("r+b") as file:
        file.seek(at)
        byte = file.read(1)[0]
        file.seek(at)
        file.write(bytes([byte ^ 0x10]))


def damaged_journal(t):
    """A journal that is cut off, or has a wrong byte: less of it is gone on with; the same bits."""
    farm = t.with_worker()
    journal = t.killed_on_the_way(farm)[0]
    os.truncate(journal, journal.stat().st_size - 100)
    farm.start_coordinator()
    time.sleep(0.1)
    farm.coordinator.kill()
    for path in (farm.store / "frames").glob("*/*"):
        if path.stat().st_size > 2000:
            flip(path, path.stat().st_size // 2)
    farm.start_coordinator()
    t.same(farm, Work("shot", 0))


def damaged_database(t):
    """A wrong byte in the database: refused with what can be done, or harmless; never other bits."""
    farm = t.with_worker()
    t.submit(farm, Work("fixed", 0))
    t.same(farm, Work("fixed", 0))
    farm.coordinator.leave()
    base = farm.store / "store.sqlite"
    whole, refused = base.read_bytes(), 0
    places = [0, 18, 100, 4096 + 3, len(whole) // 2, len(whole) - 50]
    for at in places:
        base.write_bytes(whole)
        flip(base, at)
        try:
            farm.start_coordinator()
        except RuntimeError:
            code = farm.coordinator.child.returncode
            require(code == 3, f"with a wrong byte {at} it ended with {code}")
            refused += 1
            continue
        done = farm.ask("jobs", "job", "--json")
        require(farm.coordinator.alive(), f"with a wrong byte {at} it ended with {farm.coordinator.child.poll()}")
        if done.returncode == 0 and '"completed"' in done.stdout:
            t.same(farm, Work("fixed", 0))
        farm.coordinator.leave()
    require(refused >= 2, f"{refused} of {len(places)} damages were refused")
    require(farm.coordinator.said("is damaged"), "it did not say that the database is damaged")
    print(f"{refused} of {len(places)} damages were refused, the others were harmless")
    base.rename(base.with_suffix(".aside"))  # the remedy that it names
    farm.start_coordinator()
    t.submit(farm, Work("fixed", 0), "again")
    t.same(farm, Work("fixed", 0), "again")


def damaged_blob(t):
    """A wrong byte in a finished image, or in a scene's file: never handed out as what it was."""
    farm = t.farm()
    farm.start_coordinator()
    work = Work("fixed", 0)
    t.submit(farm, work)
    scene = next(p for p in (farm.store / "blobs").rglob("*") if p.is_file() and b"White furnace" in p.read_bytes())
    good = scene.read_bytes()
    flip(scene, len(good) // 2)
    worker = farm.worker("w1")
    worker.start()
    wait_for("the job to fail, or its worker to say why", lambda: farm.job("job")["state"] == "failed" or worker.said("digest") or worker.said("blob"), 120)
    require(farm.job("job")["state"] != "completed", "a job was completed with a damaged scene")
    print(f"damaged scene: {farm.job('job')['state']}: {farm.job('job')['reason']}")
    farm.ask("cancel", "job")
    farm.insist("submit", *work.words, "--job", "again")
    farm.ask("release", "w1")
    t.same(farm, work, "again")
    image = farm.job("again")["frame_list"][0]["image"]
    flip(next(p for p in (farm.store / "blobs").rglob(image)), 5000)
    bad = t.folder / "bad.exr"
    done = farm.ask("fetch", "again", "-o", bad, "--quiet")
    require(done.returncode != 0 and not bad.exists(), f"fetch of a damaged image ended with {done.returncode}")
    print(f"damaged image: fetch: exit code {done.returncode}: {done.stderr.strip()}")
    require(farm.coordinator.alive(), "the coordinator ended")


def clock_jump(t):
    """The clock of the wall jumps by days, forwards and back, under everybody, and its coordinator is killed: nothing."""
    if not t.options.shifter:
        raise Skip("built without the library that shifts the clock")
    shift = t.folder / "shift"
    shift.write_text("0")
    env = {"LD_PRELOAD": t.options.shifter, "TESSERA_TEST_SHIFT": str(shift)}
    farm = t.farm()
    farm.coordinator.env.update(env)
    worker = farm.worker("w1")
    worker.env.update(env)
    farm.start_coordinator()
    worker.start()
    t.submit(farm, Work("shot", 0))
    for seconds in (90_000, -90_000, 0, -400 * 86_400):
        shift.write_text(str(seconds))
        before = farm.job("job")["fraction"]
        wait_for("the job to go on", lambda: farm.job("job")["fraction"] != before or farm.job("job")["state"] == "completed", 120)
    farm.coordinator.kill()  # and now it starts in an earlier year than it was killed in
    farm.start_coordinator()
    t.same(farm, Work("shot", 0))
    events = farm.insist("jobs", "job", "--events").stdout
    require(str(time.gmtime().tm_year - 1) in events, "the clock did not jump for the coordinator")
    require("fell silent" not in events, "a worker was given up because of the clock")


TRIALS = {f.__name__: f for f in (duplicate, early_worker, cut_upload, full_disk, damaged_journal, damaged_database, damaged_blob, clock_jump)}


def run(trial, options):
    """Whether it went as promised; None if it cannot be tried here."""
    folder, begun = Path(tempfile.mkdtemp(prefix=f"tessera-{trial}-")), time.monotonic()
    t = Trial(options, folder)
    try:
        TRIALS[trial](t)
    except Skip as why:
        print(f"SKIPPED {trial}: {why}")
        return None
    except (AssertionError, RuntimeError, TimeoutError) as error:
        print(f"FAILED {trial}: {error}\nlogs and store are in {folder}")
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
