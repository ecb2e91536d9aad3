#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Mixed jobs for a long time: submitted, cancelled, paused, made urgent; workers come and go. Memory and descriptors
of the coordinator and of the workers that stay must be flat: over the second half, a linear fit of the resident memory
grows by less than --bound MB a minute, and the descriptors' median by no more than --descriptors."""

import argparse
import csv
import os
import random
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

sys.dont_write_bytecode = True
from farm import Farm, wait_for

SCENES = Path(__file__).resolve().parents[2] / "scenes"
STAY, COME_AND_GO = ["s1", "s2"], "g1"


def figures(pid):
    """Resident bytes and open descriptors."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGESIZE"), len(os.listdir(f"/proc/{pid}/fd"))


def slope(points):
    """Of the straight line that fits best."""
    n = len(points)
    mx, my = sum(x for x, _ in points) / n, sum(y for _, y in points) / n
    spread = sum((x - mx) ** 2 for x, _ in points)
    return sum((x - mx) * (y - my) for x, y in points) / spread if spread else 0.0


class Soak:
    def __init__(self, farm, seed):
        self.farm, self.chance = farm, random.Random(seed)
        self.samples = {name: [] for name in ["coordinator", *STAY]}  # (minutes, MB, descriptors)
        self.counts = {}
        self.number = 0
        self.open = []

    def count(self, what):
        self.counts[what] = self.counts.get(what, 0) + 1

    def submit(self):
        self.number += 1
        name, scene = f"job{self.number}", self.chance.choice(["cornell", "furnace"])
        size, samples = self.chance.choice([64, 96, 128]), self.chance.choice([32, 64, 128])
        args = [SCENES / f"{scene}.json", "--job", name, "--width", size, "--height", size, "--samples", samples]
        args += ["--seed", self.chance.randrange(1000), "--priority", self.chance.choice([10, 50, 90]), "--tile-size", 64]
        if self.chance.random() < 0.2:
            args += ["--frames", "1-3", "--filter", "svgf:history=on"]
        self.farm.insist("submit", *args, owner=self.chance.choice(self.farm.owners))
        self.open.append(name)
        self.count("submit")

    def disturb(self):
        what = self.chance.choice(["submit", "submit", "submit", "cancel", "pause", "priority", "worker", "fetch", "events"])
        if what == "submit" or not self.open:
            if len(self.open) < 4:
                self.submit()
        elif what == "worker":
            self.worker()
        elif what == "pause":
            self.control(["pause", "resume"])
        elif what == "cancel":
            self.control(["cancel"])
        elif what == "priority":
            self.control(["priority"])
        elif what == "fetch":
            self.farm.ask("fetch", self.chance.choice(self.open), "-o", self.farm.folder / "fetched.####.exr", "--quiet")
            self.count(what)
        else:
            self.farm.ask("jobs", self.chance.choice(self.open), "--events")
            self.count(what)

    def control(self, verbs):
        job = self.chance.choice(self.open)
        for verb in verbs:  # what is over already is refused, which is no fault
            self.farm.ask(verb, job, *([self.chance.randrange(101)] if verb == "priority" else []))
            self.count(verb)

    def worker(self):
        process = self.farm.workers[COME_AND_GO]
        if not process.alive():
            process.start()
            self.count("worker comes")
        elif self.chance.random() < 0.5:
            process.leave()
            self.count("worker leaves")
        else:
            process.kill()
            self.count("worker killed")

    def sample(self, minutes):
        for name, points in self.samples.items():
            process = self.farm.coordinator if name == "coordinator" else self.farm.workers[name]
            if not process.alive():
                raise RuntimeError(f"{name} ended with {process.child.returncode}")
            memory, descriptors = figures(process.pid())
            points.append((minutes, memory / 1e6, descriptors))

    def run(self, minutes, pause):
        begun, next_sample, next_look = time.monotonic(), 0.0, 0.0
        while (now := time.monotonic() - begun) < 60 * minutes:
            if now >= next_sample:
                self.sample(now / 60)
                next_sample = now + 3
            if now >= next_look:
                jobs = self.farm.jobs()
                self.open = [j["job"] for j in jobs if j["state"] in ("queued", "active", "paused")]
                next_look = now + 5
            self.disturb()
            time.sleep(self.chance.uniform(0, 2 * pause))

    def finish(self):
        def over():
            return all(j["state"] not in ("queued", "active", "paused") for j in self.farm.jobs())

        wait_for("the last jobs to end", over, 300)
        return self.farm.jobs()

    def verdict(self, bound, more_descriptors):
        good = True
        for name, points in self.samples.items():
            first, second = points[: len(points) // 2], points[len(points) // 2 :]
            growth = slope([(t, mb) for t, mb, _ in second])
            before, after = (statistics.median(fd for _, _, fd in part) for part in (first, second))
            flat = growth < bound and after - before <= more_descriptors
            good = good and flat
            print(f"{name:<12} {points[0][1]:7.1f} MB first, {points[-1][1]:7.1f} last, {max(p[1] for p in points):7.1f} most; "
                  f"second half {growth:+.3f} MB/min; descriptors {before:g} then {after:g}, most {max(p[2] for p in points)}"
                  f"{'' if flat else '   NOT FLAT'}")
        return good


def write_figures(samples, folder):
    with (folder / "soak.csv").open("w", newline="") as out:
        table = csv.writer(out)
        table.writerow(["process", "minutes", "resident_MB", "descriptors"])
        for name, points in samples.items():
            table.writerows([name, f"{t:.3f}", f"{mb:.2f}", fd] for t, mb, fd in points)
    if not shutil.which("oiiotool"):
        return
    width, height = 900, 400
    last = max(p[0] for points in samples.values() for p in points) or 1
    most = 1.1 * max(p[1] for points in samples.values() for p in points)
    words = ["oiiotool", "--create", f"{width}x{height}", "3", "--fill:color=1,1,1", f"{width}x{height}"]
    for colour, points in zip(("0.8,0,0", "0,0.5,0", "0,0,0.8"), samples.values()):  # coordinator, workers
        line = ",".join(f"{int(t / last * (width - 1))},{int(height - 1 - mb / most * (height - 1))}" for t, mb, _ in points)
        words += [f"--line:color={colour}", line]
    subprocess.run([*words, "-o", str(folder / "soak.png")], check=False)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tessera")
    parser.add_argument("--minutes", type=float, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--pause", type=float, default=0.5, help="mean seconds between disturbances")
    parser.add_argument("--bound", type=float, default=1.0, help="MB a minute")
    parser.add_argument("--descriptors", type=int, default=4)
    parser.add_argument("--folder", help="where logs and figures go [a temporary folder]")
    options = parser.parse_args()
    folder = Path(options.folder or tempfile.mkdtemp(prefix="tessera-soak-"))
    farm = Farm(options.tessera, folder, keys=True)
    soak = Soak(farm, options.seed)
    try:
        farm.start_coordinator()
        for name in (*STAY, COME_AND_GO):
            farm.worker(name).start()
        wait_for("the workers", lambda: len(farm.present()) == len(farm.workers), 120)
        begun = time.monotonic()
        soak.run(options.minutes, options.pause)
        lasted = (time.monotonic() - begun) / 60
        jobs = soak.finish()
    finally:
        farm.end()
        if soak.samples["coordinator"]:
            write_figures(soak.samples, folder)
    states = {s: sum(j["state"] == s for j in jobs) for s in sorted({j["state"] for j in jobs})}
    print(f"{lasted:.1f} minutes, seed {options.seed}; {', '.join(f'{n} {w}' for w, n in sorted(soak.counts.items()))}")
    print(f"jobs: {', '.join(f'{n} {s}' for s, n in states.items())}; figures in {folder}")
    flat = soak.verdict(options.bound, options.descriptors)
    for sentence in farm.hung:
        print(f"HUNG: {sentence}")
    good = flat and not farm.hung and set(states) <= {"completed", "cancelled"}
    print("100% tests passed" if good else "FAILED")
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
