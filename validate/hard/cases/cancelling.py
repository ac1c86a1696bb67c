"""Laws whose terms all but cancel, so that the input is small beside what it is made of.

The input itself is an ordinary one. The reference, and the absolute model, take each law in many digits and
round it once; pointcoord sums in twice the working precision and counts what that may be off into its bound.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from validate.hard.case import RIGHT, Case, Expected
from validate.hard.cases.laws import law_cases
from validate.hard.family import SUBJECTS, Content, Subject, hyphens

PHASE = 0.5  # rad: neither the sine nor its slope is near zero
AMPLITUDES = tuple(float(f"1e{k}") for k in range(10))
# How far from home each input is while its swing passes, and how fast: rad or mm, per s.
ORDINARY: Mapping[str, tuple[float, float]] = {"rad": (0.0, 0.1), "mm": (10.0, 20.0)}
POWERS = (4, 6)
MOST = 20


def cancelling_sine(unit: str, value: float) -> dict[str, Any]:
    """An offset that all but cancels the swing at time 0, by the reciprocal of the amplitude."""
    (wanted, rate), amplitude = ORDINARY[unit], 1.0 / value
    wave = {
        "amplitude": amplitude,
        "angular_frequency": rate / (amplitude * math.cos(PHASE)),
        "phase": PHASE,
        "offset": wanted - amplitude * math.sin(PHASE),
    }
    return {"sine": wave}


def _of_one_input(driven: str, subject: Subject, value: float) -> Content:
    if driven == "heave":
        return subject.content(heave=cancelling_sine("mm", value), stop=0.5)
    laws = (cancelling_sine(unit, value) for unit in ORDINARY)
    return subject.content(*laws, only=driven, stop=0.5)


def expanded(power: int, start: float) -> list[float]:
    """Coefficients of 16 (t - start)^power, which doubles hold exactly for a start that is a power of two."""
    return [16.0 * math.comb(power, k) * (-start) ** (power - k) for k in range(power + 1)]


def cancelling_polynomial(power: int, subject: Subject, value: float) -> Content:
    """16 mm, or 1/8 rad, in the second after a late start, all terms as large as that is late."""
    start, last = 1.0 / value, list(subject.kinds)[-1]
    law = expanded(power, start)
    # A power of two keeps every coefficient exact.
    angle = [c / 128.0 for c in law]
    return subject.content(angle, law, only=last, start=start, stop=start + 1.0)


def right_from(power: int) -> float:
    """The reciprocal of the latest start at which twice the precision leaves the law its digits.

    The sum of n terms is off by 4 n^2 u^2 of their magnitudes (Graillat, Langlois, Louvet), which add up to
    16 (2 start)^power: that must stay below a rounding of 16 mm.
    """
    count = power + 1
    latest = 0.5 * (1.0 / (4.0 * count**2 * UNIT_ROUNDOFF)) ** (1.0 / power)
    return 2.0 ** -math.floor(math.log2(latest))


def _polynomial_cases(power: int) -> tuple[Case, ...]:
    ours = Expected(("right", "refused"), right_from(power))
    return law_cases(
        f"cancelling-polynomial-{power}",
        f"16 (t - start)^{power}, multiplied out: terms up to {POWERS_OF_TEN[power]} times their sum",
        "1 s over the start of a motion of 1 s",
        tuple(2.0**-k for k in range(1, MOST + 1)),
        partial(cancelling_polynomial, power),
        f"right from 1/{1 / right_from(power):g} up; later right within its bound, or refused",
        {"pointcoord": ours, "pointcoord-newton": ours, "absolute": RIGHT, "relative": RIGHT},
    )


POWERS_OF_TEN = {power: f"1e{math.floor(math.log10(2.0 ** ((MOST + 1) * power)))}" for power in POWERS}

CASES: tuple[Case, ...] = (
    *(
        case
        for driven in dict.fromkeys(name for subject in SUBJECTS for name in (*subject.kinds, "heave"))
        for case in law_cases(
            f"cancelling-sine-{hyphens(driven)}",
            "a large swing is all but cancelled by its offset, and what is left drives the input",
            "1 rad or 1 mm over the amplitude",
            tuple(1.0 / amplitude for amplitude in AMPLITUDES),
            partial(_of_one_input, driven),
            "right within the bound, which counts the rounding of the law",
            subjects=[one for one in SUBJECTS if driven in one.kinds or (driven == "heave" and one.heaves)],
        )
    ),
    *(case for power in POWERS for case in _polynomial_cases(power)),
)
