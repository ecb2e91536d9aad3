#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A farm of real processes under random faults: whatever is killed, stopped, cut off or slowed, every job is completed
with the pixels of an undisturbed local render, and every task counts once. Which faults strike whom is decided by --seed;
what they meet is not, as processes run as they like. Prints what was done; ends with 1, and keeps the logs, if something is
not as it should be."""

import argparse
import random
import shutil
import signal
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

sys.dont_write_bytecode = True
import books
from farm import Farm, wait_for
from roads import Bridge, Proxy
from work import KINDS, References, Result, Work

OWNERS = ["ada", "bob", "eve"]
# How often each is chosen.
FAULTS = {
    "worker killed": 5, "worker stopped, short": 3, "worker stopped, long": 3, "worker leaves": 3,
    "coordinator killed": 4, "coordinator stopped, short": 2, "coordinator stopped, long": 2,
    "worker cut off, short": 3, "worker cut off, long": 3, "worker stalled": 2, "worker slowed": 2,
    "half of the workers cut off": 1,
}


# Faults strike workers, not tasks: that several of them die at one task must not be taken for its doing.
PATIENT = ["--failures", "100"]


class Chaos:
    def __init__(self, farm, roads, options):
        self.farm, self.roads, self.options = farm, roads, options
        self.chance = random.Random(options.seed)
        self.faults, self.later, self.busy = Counter(), [], set()  # later: (when, whose, what)
        self.jobs, self.enough, self.broken = {}, threading.Event(), []

    # --- Jobs: some are always under way while there are faults. ---

    def submit_jobs(self):
        chance = random.Random(self.options.seed + 1)
        try:
            while True:
                kinds = list(KINDS)
                self.submit(kinds[len(self.jobs)] if len(self.jobs) < len(kinds) else chance.choice(kinds), chance)
                while len(self.jobs) >= len(kinds) and self.under_way() >= self.options.open and not self.enough.is_set():
                    time.sleep(0.5)
                if self.enough.is_set() and len(self.jobs) >= len(kinds):
                    return
        except Exception as error:  # ends the test
            self.broken.append(f"submitting: {error}")

    def submit(self, kind, chance):
        work = Work(kind, chance.randrange(self.options.variety))
        name = f"{kind}{len(self.jobs) + 1}"
        self.farm.insist("submit", *work.words, "--job", name, "--priority", chance.choice([20, 50, 50, 80]), owner=chance.choice(OWNERS))
        self.jobs[name] = work

    def under_way(self):
        return sum(j["state"] in ("queued", "active", "paused") for j in self.farm.jobs())

    # --- Faults. ---

    def strike(self):
        kind = self.chance.choices(list(FAULTS), FAULTS.values())[0]
        short, long = self.options.silence * self.chance.uniform(0.2, 0.6), self.options.silence * self.chance.uniform(1.3, 2.5)
        seconds = short if "short" in kind else long if "long" in kind else self.chance.uniform(0.1, 2 * self.options.silence)
        if kind.startswith("coordinator"):
            struck = self.coordinator(kind, min(seconds, self.options.silence * 2.5))
        elif kind.startswith("half"):
            struck = self.partition(seconds)
        else:
            struck = self.worker(kind, seconds)
        self.faults[kind] += struck

    def coordinator(self, kind, seconds):
        process = self.farm.coordinator
        if kind == "coordinator killed":
            process.kill()
            time.sleep(seconds / 4)
            self.farm.start_coordinator()
        else:
            process.send(signal.SIGSTOP)
            time.sleep(seconds)
            process.send(signal.SIGCONT)
        return 1

    def healthy(self):
        return [name for name in sorted(self.farm.workers) if name not in self.busy]

    def worker(self, kind, seconds):
        if not self.healthy():
            return 0
        name = self.chance.choice(self.healthy())
        process, road = self.farm.workers[name], self.roads[name]
        if kind == "worker killed":
            process.kill()
            heal = process.start
        elif kind == "worker leaves":
            process.send(signal.SIGTERM)

            def heal():
                code = process.ended()
                if code != 0 and process.says("works for"):  # it was there before it was told to leave
                    self.broken.append(f"{name} did not leave in order: {code}")
                process.start()
        elif "stopped" in kind:
            process.send(signal.SIGSTOP)
            heal = lambda: process.send(signal.SIGCONT)
        else:
            heal = road.heal
            if "slowed" in kind:
                if road.slow(self.chance.uniform(0.02, 0.2)) is False:
                    return 0
            else:
                road.stall() if "stalled" in kind else road.cut()
        self.heal_later(name, seconds, heal)
        return 1

    def partition(self, seconds):
        names = self.healthy()[: (len(self.farm.workers) + 1) // 2]
        for name in names:
            self.roads[name].cut()
            self.heal_later(name, seconds, self.roads[name].heal)
        return 1 if names else 0

    def heal_later(self, name, seconds, what):
        self.busy.add(name)
        self.later.append((time.monotonic() + seconds, name, what))

    def heal(self, everything=False):
        now = time.monotonic()
        due = [x for x in self.later if everything or x[0] <= now]
        self.later = [x for x in self.later if x not in due]
        for _, name, what in due:
            what()
            self.busy.discard(name)

    def look(self):
        for process in (self.farm.coordinator, *(self.farm.workers[n] for n in self.healthy())):
            if not process.alive():
                raise RuntimeError(f"{process.name} ended by itself with {process.child.returncode}")
        if self.broken:
            raise RuntimeError(self.broken[0])

    def run(self):
        self.farm.start_coordinator()
        for name in self.farm.workers:
            self.farm.workers[name].start()
        submitter = threading.Thread(target=self.submit_jobs, daemon=True)
        submitter.start()
        while self.faults.total() < self.options.faults:
            self.heal()
            self.look()
            self.strike()
            time.sleep(self.chance.uniform(0, 2 * self.options.gap))
        self.enough.set()
        self.heal(everything=True)
        submitter.join(120)
        self.look()
        wait_for("all jobs to end", self.all_over, self.options.patience)

    def all_over(self):
        self.look()
        time.sleep(0.3)
        return self.under_way() == 0


def compare(chaos, references, folder):
    """What is wrong, as sentences."""
    wrong, samples = [], {}
    for name, work in chaos.jobs.items():
        job = chaos.farm.job(name)
        if job["state"] != "completed":
            wrong.append(f"{name}: {job['state']}: {job['reason']}")
            continue
        chaos.farm.insist("fetch", name, "-o", folder / name / work.output, "--quiet")
        got, wanted = Result(work, folder / name), references.of(work)
        wrong += [f"{name}: {file} has other pixels than a local render" for file, a, b in zip(work.files, got.digests, wanted.digests) if a != b]
        samples[name] = wanted.samples
    if not chaos.farm.coordinator.alive():
        wrong.append("the coordinator is not alive")
    elif chaos.farm.coordinator.leave() != 0:
        wrong.append("the coordinator did not end in order")
    more, tasks = books.check(chaos.farm.store, samples)
    return wrong + more, tasks


def set_up(options, folder):
    names = [f"w{i + 1}" for i in range(options.workers)]
    if options.netns:
        bridge = Bridge()
        roads = {name: bridge.cable(name) for name in names}
        farm = Farm(options.tessera, folder, options.silence, OWNERS, True, bridge.host, lambda n: (farm.address, roads[n].prefix), PATIENT)
    else:
        keys = options.keys == "yes" or (options.keys == "seed" and options.seed % 2 == 1)
        farm = Farm(options.tessera, folder, options.silence, OWNERS, keys, more=PATIENT)
        roads = {name: Proxy(farm.address) for name in names}
        farm.road = lambda name: (roads[name].address, [])
        bridge = None
    for name in names:
        farm.worker(name)
    return farm, roads, bridge


def report(chaos, references, tasks, wrong, seconds):
    options, farm = chaos.options, chaos.farm
    for kind in FAULTS:
        print(f"{chaos.faults[kind]:5}  {kind}")
    lives = sum(w.lives for w in farm.workers.values())
    print(f"{chaos.faults.total():5}  faults in {seconds:.1f} s; seed {options.seed}, {'with' if farm.keys else 'without'} keys, "
          f"{'network namespaces' if options.netns else 'proxies'}, silence {options.silence} s")
    print(f"{len(chaos.jobs):5}  jobs, {sum(len(w.files) for w in chaos.jobs.values())} frames, {tasks} tasks{', each accepted once' if not wrong else ''}; "
          f"{len(references.found)} local renders; coordinator lived {farm.coordinator.lives} times, workers {lives}")
    for sentence in wrong:
        print(f"WRONG: {sentence}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("tessera")
    parser.add_argument("--faults", type=int, default=25)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=3)
    parser.add_argument("--open", type=int, default=3, help="jobs under way at a time, at least")
    parser.add_argument("--variety", type=int, default=1, help="seeds of each kind of job")
    parser.add_argument("--gap", type=float, default=0.5, help="mean seconds between faults")
    parser.add_argument("--silence", type=float, default=1.0)
    parser.add_argument("--patience", type=float, default=600, help="seconds to wait for the last job")
    parser.add_argument("--keys", choices=["yes", "no", "seed"], default="seed", help="seed: with keys if it is odd")
    parser.add_argument("--netns", action="store_true", help="workers in network namespaces, as root, always with keys")
    parser.add_argument("--local", help="folder in which local renders of the same program are kept between runs")
    parser.add_argument("--keep", action="store_true", help="keep the folder with logs and store")
    options = parser.parse_args()
    if options.netns and (why := Bridge.why_not()):
        print(f"SKIPPED: {why}")
        return 77
    folder = Path(tempfile.mkdtemp(prefix="tessera-chaos-"))
    farm, roads, bridge = set_up(options, folder)
    chaos, references = Chaos(farm, roads, options), References(options.tessera, options.local or folder / "local")
    begun, tasks, wrong = time.monotonic(), 0, []
    try:
        chaos.run()
        seconds = time.monotonic() - begun
        wrong, tasks = compare(chaos, references, folder / "fetched")
    except (RuntimeError, TimeoutError) as error:
        seconds = time.monotonic() - begun
        wrong.append(str(error))
    finally:
        farm.end()
        for road in [bridge] if bridge else roads.values():
            road.end()
    report(chaos, references, tasks, wrong, seconds)
    if wrong or options.keep:
        print(f"logs, store and images are in {folder}")
    else:
        shutil.rmtree(folder)
    print(f"{'0%' if wrong else '100%'} tests passed, {len(wrong)} wrong, total time {time.monotonic() - begun:.1f} s")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
