"""``make bench``: runs every benchmarks/bench_*.py in turn and prints its table; name some to run only those."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path


def main(wanted: list[str]) -> int:
    """Run the benchmarks named (without ``bench_``), all of them by default; exit code 1 for an unknown name."""
    names = sorted(p.stem.removeprefix("bench_") for p in Path(__file__).parent.glob("bench_*.py"))
    unknown = [n for n in wanted if n not in names]
    if unknown:
        print(f"bench: unknown {', '.join(unknown)}; there are: {', '.join(names)}", file=sys.stderr)
        return 1
    for name in wanted or names:
        print(f"\n== {name}", flush=True)
        importlib.import_module(f"benchmarks.bench_{name}").main()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
