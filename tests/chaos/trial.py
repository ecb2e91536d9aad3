# SPDX-License-Identifier: Apache-2.0
"""What trials have in common: farms in a folder, jobs handed in, images compared with local renders."""

import shutil

from farm import Farm, wait_for
from work import References, Result, Work


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
        done = farm.insist("fetch", job, "--wait", "-o", folder / work.output, "--quiet")
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
