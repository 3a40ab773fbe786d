"""Every fault through the running server and PyBullet: what the robot did, in which time, with which reason code.

Then thousands of random sequences through pipeline and limiter, ``--sequences`` of them.
"""

from __future__ import annotations

from benchmarks.faults.scenarios import FAULTS, Outcome, run, smallest_gap_m
from benchmarks.faults.sequences import play_sequences
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


def main(sequences: int = 3000) -> bool:
    """Print the table; False when a fault was not answered as it must. Seven minutes of real time, half for the table.

    Raises AssertionError with the smallest sequence that breaks a limit.
    """
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
    worst = play_sequences(int(sequences))
    print(
        f"{worst.sequences} random sequences, {worst.frames} frames, {worst.moved} of them in motion: no joint out of "
        f"its range, speed at most {worst.speed:.3f} of its limit, acceleration {worst.acceleration:.3f}, chassis "
        f"{worst.chassis:.3f}, gaps never {1e3 * max(0.0, -worst.gap_m):.2f} mm below what is configured."
    )
    return done == len(outcomes)


if __name__ == "__main__":
    main()
