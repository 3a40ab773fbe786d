"""Who is in control: engaging, disengaging, body stop and the e-stop latch."""

from __future__ import annotations

from dataclasses import dataclass

from teleop.inputs import Inputs
from teleop.reasons import Reason


@dataclass(frozen=True, slots=True)
class Control:
    """engaged: an operator is in control. estop: latched until it is reset. assumed: whoever is seen is in control.

    engage_reason, end_reason: why it changed, for the events. refusals: what was asked for and not granted.
    """

    engaged: bool = False
    estop: bool = False
    assumed: bool = False
    engage_reason: Reason = Reason.ENGAGE_REQUEST
    end_reason: Reason = Reason.DISENGAGE_REQUEST
    refusals: tuple[Reason, ...] = ()


@dataclass(frozen=True, slots=True)
class Seen:
    """What the frame says. person: somebody is there, perhaps lost for a moment; now: in this very frame.

    toggle: the engage gesture was completed. crossed: the forearms are crossed. exchanged: it is somebody else.
    restarted: the stream of frames starts anew.
    """

    person: bool
    now: bool
    toggle: bool = False
    crossed: bool = False
    exchanged: bool = False
    restarted: bool = False


def step_control(control: Control, seen: Seen, inputs: Inputs) -> Control:
    """One frame. Stopping wins over ending, ending over engaging; the e-stop wins over all."""
    estop = inputs.estop or (control.estop and not inputs.estop_reset)
    refusals: list[Reason] = []
    engaged, engage_reason = control.engaged, Reason.ENGAGE_REQUEST
    asked = inputs.engage or (seen.toggle and not engaged)
    if control.assumed and seen.now and not engaged:
        engaged, engage_reason = True, Reason.ENGAGE_ASSUMED
    elif asked and not engaged:
        if estop:
            refusals.append(Reason.ENGAGE_ESTOP)
        elif not seen.now:
            refusals.append(Reason.ENGAGE_NO_PERSON)
        else:
            engaged, engage_reason = True, Reason.ENGAGE_GESTURE if seen.toggle else Reason.ENGAGE_REQUEST
    end = _end(control, seen, inputs)
    if end is not None or estop or seen.crossed:
        engaged = False
    return Control(engaged, estop, control.assumed, engage_reason, end or Reason.DISENGAGE_REQUEST, tuple(refusals))


def _end(control: Control, seen: Seen, inputs: Inputs) -> Reason | None:
    """Why nobody is in control any more, None when nothing ended it."""
    if not seen.person:
        return Reason.PERSON_LEFT
    if control.assumed:
        return None
    if inputs.disengage:
        return Reason.DISENGAGE_REQUEST
    if seen.restarted:
        return Reason.STREAM_RESTARTED
    if seen.exchanged:
        return Reason.OPERATOR_CHANGED
    if seen.toggle and control.engaged:
        return Reason.DISENGAGE_GESTURE
    return None
