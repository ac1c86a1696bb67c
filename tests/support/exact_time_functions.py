"""Time functions in many digits: value, rate and acceleration of an input at an instant."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from validate.reference.errors import BadInputError, NotDecidedError
from validate.reference.exact import as_ball, as_fraction, centre_of
from validate.reference.solve import with_enough_digits

KINDS = ("constant", "polynomial", "sine")
SINE = ("offset", "amplitude", "angular_frequency", "phase")


def time_function_value(
    definition: Mapping[str, object], t: object, digits: int = 60
) -> tuple[Fraction, Fraction, Fraction]:
    """Value, rate and acceleration at time t, s.

    {"constant": c}
    {"polynomial": [c0, c1, ...]}    c0 + c1 t + c2 t^2 + ..., c_k in unit / s^k
    {"sine": {"offset": o, "amplitude": a, "angular_frequency": w, "phase": p}}   o + a sin(w t + p)

    Every number given is taken as exact. Constants and polynomials are exact; each number of a sine has an
    error of at most 10^-digits of its size. The sine's offset and phase may be left out (0).

    Raises:
        BadInputError: an unknown kind or entry, or not finite numbers.
    """
    if len(definition) != 1 or next(iter(definition)) not in KINDS:
        raise BadInputError("the time function", dict(definition), f"one of the kinds {', '.join(KINDS)}")
    kind, given = next(iter(definition.items()))
    time = as_fraction(t, "t")
    if kind == "sine":
        return _sine(given, time, digits)
    coefficients = [given] if kind == "constant" else given
    if not isinstance(coefficients, Sequence) or isinstance(coefficients, str) or not coefficients:
        raise BadInputError(kind, given, "a list of numbers, lowest power first")
    series = [as_fraction(c, kind) for c in coefficients]
    results = []
    for _ in range(3):
        total = sum((c * time**k for k, c in enumerate(series)), Fraction(0))
        results.append(total)
        series = [k * c for k, c in enumerate(series)][1:]
    return results[0], results[1], results[2]


def _sine(given: object, time: Fraction, digits: int) -> tuple[Fraction, Fraction, Fraction]:
    if not isinstance(given, Mapping) or not {"amplitude", "angular_frequency"} <= set(given) <= set(SINE):
        allowed = f"a mapping with {', '.join(SINE)} (offset and phase may be left out)"
        raise BadInputError("sine", given, allowed)
    offset, amplitude, frequency, phase = (as_fraction(given.get(name, 0), f"sine {name}") for name in SINE)

    def attempt(working: int) -> tuple[Fraction, Fraction, Fraction]:
        sine, cosine = as_ball(frequency * time + phase).sin_cos()
        swing = as_ball(amplitude)
        numbers = (
            as_ball(offset) + swing * sine,
            as_ball(amplitude * frequency) * cosine,
            -as_ball(amplitude * frequency**2) * sine,
        )
        for name, number in zip(("value", "rate", "acceleration"), numbers, strict=True):
            limit = abs(number) * as_ball(Fraction(1, 10**digits))
            if not number.rad() <= limit:
                raise NotDecidedError(f"digits of the sine's {name}", number, f"{digits} digits")
        return centre_of(numbers[0]), centre_of(numbers[1]), centre_of(numbers[2])

    return with_enough_digits(attempt, digits)
