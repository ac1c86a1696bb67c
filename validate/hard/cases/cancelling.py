"""Laws whose terms all but cancel, so that the input is small beside what it is made of.

The input itself is an ordinary one. The reference, and the absolute model, take each law in many digits and
round it once; pointcoord sums in twice the working precision and counts what that may be off into its bound.
"""

from __future__ import annotations

import math
from typing import Any

from pointcoord.numerics.rounding import UNIT_ROUNDOFF
from validate.cars.car import Car
from validate.cars.scene_content import SQUARE, Law, scene_content
from validate.hard.case import RIGHT, Case, Expected
from validate.hard.cases.laws import Content, law_cases

PHASE = 0.5  # rad: neither the sine nor its slope is near zero
AMPLITUDES = tuple(float(f"1e{k}") for k in range(10))
# Where each input is while its swing passes, and how fast: rad and mm, per s.
ORDINARY = {"arm_angle": (SQUARE, 0.1), "rack": (10.0, 20.0), "heave": (10.0, 20.0)}
POWERS = (4, 6)
MOST = 20


def cancelling_sine(driven: str) -> Content:
    """An offset that all but cancels the swing at time 0, by the reciprocal of the amplitude."""
    wanted, rate = ORDINARY[driven]

    def content(car: Car, value: float) -> dict[str, Any]:
        amplitude = 1.0 / value
        wave = {
            "amplitude": amplitude,
            "angular_frequency": rate / (amplitude * math.cos(PHASE)),
            "phase": PHASE,
            "offset": wanted - amplitude * math.sin(PHASE),
        }
        laws: dict[str, Law | None] = {"arm_angle": SQUARE, "rack": 0.0, "heave": None}
        laws[driven] = {"sine": wave}
        return scene_content(car, laws["arm_angle"] or SQUARE, laws["rack"] or 0.0, laws["heave"], stop=0.5)

    return content


def expanded(power: int, start: float) -> list[float]:
    """Coefficients of 16 (t - start)^power, which doubles hold exactly for a start that is a power of two."""
    return [16.0 * math.comb(power, k) * (-start) ** (power - k) for k in range(power + 1)]


def cancelling_polynomial(power: int) -> Content:
    """The rack goes 16 mm in the second after a late start, all its terms as large as that is late."""

    def content(car: Car, value: float) -> dict[str, Any]:
        start = 1.0 / value
        return scene_content(car, SQUARE, expanded(power, start), start=start, stop=start + 1.0)

    return content


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
        cancelling_polynomial(power),
        f"right from 1/{1 / right_from(power):g} up; later right within its bound, or refused",
        {"pointcoord": ours, "pointcoord-newton": ours, "absolute": RIGHT, "relative": RIGHT},
    )


POWERS_OF_TEN = {power: f"1e{math.floor(math.log10(2.0 ** ((MOST + 1) * power)))}" for power in POWERS}

CASES: tuple[Case, ...] = (
    *(
        case
        for driven in ORDINARY
        for case in law_cases(
            f"cancelling-sine-{driven.replace('_', '-')}",
            "a large swing is all but cancelled by its offset, and what is left drives the input",
            "1 rad or 1 mm over the amplitude",
            tuple(1.0 / amplitude for amplitude in AMPLITUDES),
            cancelling_sine(driven),
            "right within the bound, which counts the rounding of the law",
        )
    ),
    *(case for power in POWERS for case in _polynomial_cases(power)),
)
