# SPDX-License-Identifier: Apache-2.0
"""The jobs that are disturbed, and what an undisturbed `tessera render` makes of the same."""

import re
import shutil
import subprocess
from pathlib import Path

from exr import Picture

SCENES = Path(__file__).resolve().parents[2] / "scenes"

# Several rounds to an error; a fixed number of samples; layers that are filtered; a shot by its history.
KINDS = {
    "rounds": ["cornell.json", "--width", 128, "--height", 96, "--until", "relmse=0.0004", "--samples", 1024],
    "fixed": ["furnace.json", "--width", 160, "--height", 120, "--samples", 256, "--filter", "none"],
    "atrous": ["cornell.json", "--width", 112, "--height", 112, "--samples", 128, "--filter", "atrous"],
    "shot": ["cornell.json", "--width", 96, "--height", 96, "--samples", 64, "--filter", "svgf:history=on", "--frames", "1-4"],
}
COMMON = ["--tile-size", 48, "--compression", "none"]
PATTERN = "image.####.exr"


class Work:
    """One job's parameters."""

    def __init__(self, kind, seed):
        self.kind, self.seed = kind, seed
        scene, *rest = KINDS[kind]
        self.words = [str(w) for w in [SCENES / scene, *rest, *COMMON, "--seed", seed]]
        self.shot = "--frames" in rest
        self.output = PATTERN if self.shot else "image.exr"
        self.files = [f"image.{i:04}.exr" for i in range(1, 5)] if self.shot else ["image.exr"]

    def key(self):
        return f"{self.kind}-{self.seed}"


class Result:
    """Digests of the pixels, and how many samples they are of."""

    def __init__(self, work, folder):
        pictures = [Picture(Path(folder) / name) for name in work.files]
        self.digests = [p.digest() for p in pictures]
        self.samples = round(sum(p.total("samples.Y") for p in pictures))


class References:
    """Rendered once each, when first wanted. `folder` may have those of an earlier run of the same program."""

    def __init__(self, tessera, folder):
        self.tessera, self.folder, self.found = str(tessera), Path(folder), {}

    def of(self, work):
        if work.key() not in self.found:
            self.found[work.key()] = self.render(work, self.folder / work.key())
        return self.found[work.key()]

    def render(self, work, folder):
        if folder.exists():
            return Result(work, folder)
        making = folder.with_suffix(".making")
        shutil.rmtree(making, ignore_errors=True)
        making.mkdir(parents=True)
        words = [self.tessera, "render", *work.words, "-o", str(making / work.output), "--progress", "none"]
        done = subprocess.run(words, capture_output=True, text=True)
        if done.returncode not in (0, 8):
            raise RuntimeError(f"render {work.key()}: ended with {done.returncode}: {done.stderr.strip()}")
        result = Result(work, making)
        said = re.findall(r"([0-9.]+) M pixel samples", done.stdout + done.stderr)
        if said and abs(sum(map(float, said)) - result.samples / 1e6) > 0.051 * len(said):
            raise RuntimeError(f"render {work.key()}: says {said} M samples, its images {result.samples}")
        making.rename(folder)
        return result
