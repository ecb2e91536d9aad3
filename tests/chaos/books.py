# SPDX-License-Identifier: Apache-2.0
"""What a store says that was accepted: every task once, and together all samples of the images."""

import sqlite3
import struct
from collections import Counter


def fields(message):
    """Of a message of protobuf: number -> last value, an int or bytes."""
    found, at = {}, 0

    def varint():
        nonlocal at
        value = shift = 0
        while True:
            byte = message[at]
            at += 1
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                return value

    while at < len(message):
        number, kind = divmod(varint(), 8)
        if kind == 0:
            found[number] = varint()
        elif kind == 2:
            size = varint()
            found[number], at = message[at : at + size], at + size
        else:
            size = {1: 8, 5: 4}[kind]
            found[number], at = message[at : at + size], at + size
    return found


def region(message):
    got = fields(message)
    return tuple(got.get(i, 0) for i in (1, 2, 3, 4))


def tasks(store, job):
    """(place of the frame, what was to be done) of each accepted task of a job by its number; in proto/store.proto."""
    rows = store.execute("SELECT place, tasks, headers FROM accepted WHERE job = ?", (job,)).fetchall()
    for place, count, headers in rows:
        at = 0
        for _ in range(count):
            (length,) = struct.unpack_from("<I", headers, at)
            result = fields(fields(headers[at + 4 : at + 4 + length])[1])
            at += 4 + length
            if 1 in result:
                task = fields(result[1])
                samples = fields(task[2])
                yield place, ("render", region(task[1]), samples.get(1, 0), samples.get(2, 0))
            else:
                task = fields(result[2])
                yield place, ("filter", region(task[1]), task.get(3, 0))


def check(folder, expected):
    """`expected`: job's name -> its pixel samples. What is wrong, as sentences; and how many tasks there are."""
    wrong, count = [], 0
    store = sqlite3.connect(folder / "store.sqlite")
    for name, samples in expected.items():
        number, kept = store.execute("SELECT number, pixel_samples FROM jobs WHERE job = ?", (name,)).fetchone()
        accepted = Counter(tasks(store, number))
        count += sum(accepted.values())
        wrong += [f"{name}: {task} of frame {place} was accepted {n} times" for (place, task), n in accepted.items() if n > 1]
        done = 0
        for _, task in accepted:
            if task[0] == "render":
                _, (x0, y0, x1, y1), begin, end = task
                done += (x1 - x0) * (y1 - y0) * (end - begin)
        if not done == kept == samples:
            wrong.append(f"{name}: {done} samples by its accepted tasks, {kept} by its record, {samples} by a local render")
    store.close()
    return wrong, count
