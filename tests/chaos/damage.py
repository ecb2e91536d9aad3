# SPDX-License-Identifier: Apache-2.0
"""Trials of what was written and is not what it was, and of a clock that is wrong."""

import os
import time

from farm import wait_for
from trial import Skip, require
from work import Work


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
    flip(farm.store / "blobs" / image[:2] / image[2:], 5000)
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
    t.submit(farm, Work("fixed", 0), "later")
    t.same(farm, Work("fixed", 0), "later")
    events = "".join(farm.insist("jobs", job, "--events").stdout for job in ("job", "later"))
    require(str(time.gmtime().tm_year - 1) in events, "the clock did not jump for the coordinator")
    require("fell silent" not in events, "a worker was given up because of the clock")
