"""Reads damaged copies of a recording in a process with little memory: ``python fuzz_host.py FILE-OR-FOLDER SEEDS``.

Prints one JSON object; anything but frames or a TeleopError ends the process.
"""

from __future__ import annotations

import json
import random
import resource
import shutil
import sys
import tempfile
from pathlib import Path

from teleop.errors import TeleopError
from teleop.sources import open_source

MEMORY_BYTES = 3 << 30


def damage(path: Path, chance: random.Random) -> None:
    """Cut it off, change bytes, or fill a stretch with noise."""
    data = bytearray(path.read_bytes())
    way = chance.randrange(4)
    if way == 0:
        del data[chance.randrange(len(data) + 1) :]
    elif way == 1:
        for _ in range(chance.randrange(1, 12)):
            data[chance.randrange(min(len(data), 400))] = chance.randrange(256)
    elif way == 2:
        for _ in range(chance.randrange(1, 30)):
            data[chance.randrange(len(data))] = chance.randrange(256)
    else:
        start = chance.randrange(len(data))
        data[start : start + 200] = chance.randbytes(200)
    path.write_bytes(bytes(data))


def main(original: Path, seeds: int) -> None:
    """Damage, read, count."""
    resource.setrlimit(resource.RLIMIT_AS, (MEMORY_BYTES, MEMORY_BYTES))
    read = refused = 0
    lines: set[str] = set()
    for seed in range(seeds):
        chance = random.Random(seed)
        with tempfile.TemporaryDirectory() as folder:
            copy = Path(folder) / original.name
            if original.is_dir():
                shutil.copytree(original, copy)
                damage(chance.choice(sorted(p for p in copy.rglob("*") if p.is_file())), chance)
            else:
                shutil.copy(original, copy)
                damage(copy, chance)
            try:
                source = open_source(str(copy))
                try:
                    read += sum(1 for _ in source.frames())
                finally:
                    source.close()
            except TeleopError as error:
                refused += 1
                lines.add(str(error).replace(folder, ""))
    # getrusage would count the size of the program that started this one
    peak_kb = next(line for line in Path("/proc/self/status").read_text().splitlines() if line.startswith("VmHWM"))
    peak_mb = int(peak_kb.split()[1]) / 1024
    print(json.dumps({"read": read, "refused": refused, "peak_mb": peak_mb, "lines": sorted(lines)}))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
