"""What a replay came to, in words."""

from __future__ import annotations

from collections.abc import Iterator

from teleop.recording.comparison import Comparison, Leaf

_SECTIONS = (
    ("mode, zone, hands", ("mode", "zone", "hands")),
    ("tools", tuple(f"command.{name}" for name in ("gripper_open", "cutter_closed", "spray_on", "liquid"))),
    ("operator's angles [deg]", ("angles",)),
    ("arms told [deg]", tuple(f"command.{arm}_arm" for arm in ("right", "left", "rear"))),
    ("driving, lift, disc", tuple(f"command.{name}" for name in ("drive_m_s", "turn_rad_s", "lift_m", "disc_rad"))),
    ("tracked joints [m]", ("joints",)),
    ("robot [rad or m]", ("robot", "base")),
)
_MOST = 8
"""Lines of a section; what differs most comes first."""


def lines(found: Comparison, unlikeness: list[str]) -> list[str]:
    """A repetition under the same settings. unlikeness: in what machine and software differ from the recording's."""
    if found.identical:
        between = f" and {found.between} steps between them" if found.between else ""
        return [f"{found.frames} frames{between}: every tracking row and robot state agrees bit for bit"]
    text = [f"{found.differing} of {found.frames} frames differ"]
    if found.missing:
        text.append(f"{found.missing} frames could not be compared: the recording lacks them or their rows")
    if found.first is not None:
        first = found.first
        text.append(f"first at {_time(found, first.t_ns)}: {first.where} was {first.before}, is now {first.after}")
    for name, group in sorted(found.groups.items()):
        largest = f", largest {group.largest:.3g} (tolerance {found.tolerance.of(name):g})" if group.largest else ""
        text.append(f"  {name}: {group.frames} frames{largest}, {group.beyond} beyond")
    if unlikeness:
        verdict = "within" if found.within_tolerance else "beyond"
        text.append(f"tolerances apply, the recording was made with another {', '.join(unlikeness)}: {verdict}")
    else:
        text.append("same sources, libraries, model and processor: every bit should agree")
    return text


def whatif_lines(found: Comparison) -> list[str]:
    """A repetition under other settings: what would have been different, and from when on."""
    if found.identical:
        return [f"{found.frames} frames: these settings would have changed nothing noticeable"]
    text = [f"{found.differing} of {found.frames} frames would have been different"]
    if found.missing:
        text.append(f"{found.missing} frames could not be compared: the recording lacks them or their rows")
    for title, prefixes in _SECTIONS:
        leaves = {w: leaf for w, leaf in found.leaves.items() if any(w == p or w.startswith(f"{p}.") for p in prefixes)}
        if leaves:
            text.append(title)
            text += _section(found, leaves)
    return text


def _section(found: Comparison, leaves: dict[str, Leaf]) -> Iterator[str]:
    ordered = sorted(leaves.items(), key=lambda item: (-item[1].frames, -item[1].largest, item[0]))
    for where, leaf in ordered[:_MOST]:
        name = where.removeprefix("command.").removeprefix("angles.").removeprefix("robot.")
        how = (
            f"up to {leaf.largest:.3g}" if leaf.largest else f"{_word(leaf.first.before)} -> {_word(leaf.first.after)}"
        )
        share = f"{leaf.frames} frames ({100 * leaf.frames / found.frames:.0f} %)"
        yield f"  {name}: {share} from {_time(found, leaf.first.t_ns)} on, {how}"
    if len(ordered) > _MOST:
        yield f"  and {len(ordered) - _MOST} more"


def _time(found: Comparison, t_ns: int) -> str:
    return f"{(t_ns - (found.start_ns or 0)) * 1e-9:.2f} s"


def _word(value: object) -> str:
    return "none" if value is None else str(value)
