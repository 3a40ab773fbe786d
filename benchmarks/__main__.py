"""``make bench``: runs every benchmarks/bench_*.py in turn and prints its table; name some to run only those.

Options after a name go to its ``main``: ``python -m benchmarks soak --minutes 10``.
"""

from __future__ import annotations

import importlib
import inspect
import sys
from pathlib import Path


def main(wanted: list[str]) -> int:
    """Run the benchmarks named (without ``bench_``), all of them by default; exit code 1 for an unknown name, and
    when a benchmark says that its figure was not reached."""
    first = next((i for i, word in enumerate(wanted) if word.startswith("--")), len(wanted))
    wanted, options = wanted[:first], wanted[first:]
    names = sorted(p.stem.removeprefix("bench_") for p in Path(__file__).parent.glob("bench_*.py"))
    unknown = [n for n in wanted if n not in names]
    if unknown:
        print(f"bench: unknown {', '.join(unknown)}; there are: {', '.join(names)}", file=sys.stderr)
        return 1
    missed = False
    for name in wanted or names:
        print(f"\n== {name}", flush=True)
        run = importlib.import_module(f"benchmarks.bench_{name}").main
        legal = {f"--{key}": key for key in inspect.signature(run).parameters}
        try:
            given = {legal[key]: float(value) for key, value in zip(options[::2], options[1::2], strict=True)}
        except (KeyError, ValueError):
            print(f"bench: {name} takes {', '.join(f'{key} NUMBER' for key in legal) or 'no options'}", file=sys.stderr)
            return 1
        missed |= run(**given) is False
    return int(missed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
