# SPDX-License-Identifier: Apache-2.0
"""Trials of disks that are full."""

import os
import subprocess
from contextlib import contextmanager

from farm import wait_for
from trial import Skip, require
from work import Work

STOPS = "nothing goes on until it works again"


def mount(folder, size, *more):
    words = ["mount", "-t", "tmpfs", "-o", ",".join([*more, f"size={size}"]), "none", str(folder)]
    return subprocess.run(words, capture_output=True).returncode == 0


@contextmanager
def small_disk(farm, folder, size):
    if os.geteuid() != 0:
        raise Skip("a small disk takes root")
    folder.mkdir(parents=True, exist_ok=True)
    if not mount(folder, size):
        raise Skip("tmpfs cannot be mounted here")
    try:
        yield
    finally:
        farm.end()
        subprocess.run(["umount", str(folder)], check=False)


def fill(path):
    with path.open("wb", buffering=0) as out:
        try:
            while True:
                out.write(bytes(1 << 16))
        except OSError:
            pass


def full_disk(t):
    """A full disk: said, submitting refused; with room again the job ends with the same bits."""
    farm = t.farm()
    with small_disk(farm, farm.store, "24m"):
        farm.start_coordinator()
        t.submit(farm, Work("shot", 0))
        filler = farm.store / "filler"
        fill(filler)
        farm.worker("w1").start()
        wait_for("the coordinator to say that the disk is full", lambda: farm.coordinator.said(STOPS), 120)
        refused = farm.ask("submit", *Work("fixed", 0).words, "--job", "late")
        require(refused.returncode not in (0, 6), f"submit ended with {refused.returncode}")
        require("space" in refused.stderr or "room" in refused.stderr, f"submit said: {refused.stderr}")
        print(f"submit: exit code {refused.returncode}: {refused.stderr.strip()}")
        filler.unlink()
        t.same(farm, Work("shot", 0))
        t.submit(farm, Work("fixed", 0), "late")
        t.same(farm, Work("fixed", 0), "late")


def full_at_the_end(t):
    """A disk that is full when all is done but writing the image: the coordinator stays, and so does the job."""
    farm = t.farm()
    writing = farm.store / "writing"
    farm.start_coordinator()  # which begins with an empty folder there
    with small_disk(farm, writing, "64k"):
        t.submit(farm, Work("fixed", 0))
        farm.worker("w1").start()
        wait_for("the coordinator to say that the disk is full", lambda: farm.coordinator.said(STOPS), 120)
        for command in ("pause", "resume"):
            done = farm.ask(command, "job")
            require(farm.coordinator.alive(), f"the coordinator ended with {farm.coordinator.child.poll()}")
            require(done.returncode == 0, f"{command} ended with {done.returncode}: {done.stderr}")
        require(mount(writing, "64m", "remount"), "the small disk did not grow")
        t.same(farm, Work("fixed", 0))
