"""Every fault through the running server and PyBullet: what the robot did, in which time, with which reason code."""

from __future__ import annotations

from benchmarks.faults.scenarios import FAULTS, Outcome, run, smallest_gap_m
from benchmarks.faults.stage import stage


def _ms(value: float | None) -> str:
    return "-" if value is None else f"{value:.0f}"


def row(o: Outcome) -> str:
    """One line of the table."""
    asked = [c for c in o.codes if c in o.fault.reasons]
    codes = ", ".join(dict.fromkeys((*asked, *(c for c in o.codes if c.startswith(("stop.", "mode."))))))
    verdict = "yes" if o.fulfilled else "NO"
    return (
        f"| {o.fault.name} | {o.fault.mode} | {o.did} | {_ms(o.command_ms)} | {_ms(o.rest_ms)} | {o.mode_after} "
        f"| {codes} | {verdict} |"
    )


def main() -> None:
    """Print the table; takes about three minutes of real time."""
    print("| fault | in mode | the robot | command still [ms] | at rest [ms] | mode then | reason codes | as it must |")
    print("|---|---|---|---:|---:|---|---|---|")
    outcomes = []
    with stage() as on:
        for fault in FAULTS:
            outcomes.append(run(on, fault))
            print(row(outcomes[-1]), flush=True)
        limits, gap_m = on.watch.limits, smallest_gap_m(on)
        states = len(on.watch.states)
    done = sum(o.fulfilled for o in outcomes)
    print(
        f"\n{done} of {len(outcomes)} as they must. Over {states} states: joint speed at most {limits.speed:.2f} of "
        f"its limit, chassis {limits.chassis:.2f}, {limits.range_rad:.4f} rad beyond a joint's range, "
        f"arms never nearer than {1e3 * gap_m:.0f} mm."
    )


if __name__ == "__main__":
    main()
