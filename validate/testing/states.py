"""What a test hands over as a solver's states: whether it can be compared at all, number by number."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene
from pointcoord.effects.registry import QUANTITIES
from pointcoord.wording import meant, shown
from validate.formulations.asked_numbers import asked_numbers
from validate.formulations.protocol import shape_of
from validate.solvers.names import known_names, misspelt
from validate.solvers.plain import INSTANTS

Array = NDArray[np.float64]
FORM = "an array for each name, such as {'position': {'wheel_centre': [[x, y, z], ...]}}"


class WrongStates(AssertionError):
    """States hold something that cannot be compared, or not what is needed.

    A comparison would leave it out and judge the rest; a test must not pass for that reason.

    Attributes:
        what: the part of the states. problem: what is wrong with it. allowed: what is needed.
    """

    def __init__(self, what: str, problem: str, allowed: str) -> None:
        self.what = what
        self.problem = problem
        self.allowed = allowed
        super().__init__(f"the states: {what} {problem}; needed: {allowed}")

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.what, self.problem, self.allowed)


def require_comparable(states: Mapping[str, Any], scene: Scene) -> None:
    """See that every number of states has the form of its kind.

    What no scene asks for and is no misspelt name is nobody's business, and goes unnoticed.

    Raises:
        WrongStates: one has another shape, no numbers, or a name that is misspelt.
    """
    known = known_names(scene.mechanism.topology)
    alone = {name: q for q, names in known.items() if QUANTITIES[q].of == "car" for name in names}
    count = len(scene.instants)
    if INSTANTS in states and np.ndim(states[INSTANTS]) == 1:
        count = len(states[INSTANTS])
    for key, part in states.items():
        if key in alone:
            _require_array(str(key), part, shape_of(alone[key], count))
        elif key in QUANTITIES:
            for name, array in _by_name(key, part):
                if name in known[key]:
                    what = f"{key} of {name}"
                    _require_array(what, array, shape_of(key, count))
                elif hint := misspelt(name, known[key]):
                    problem = f"is of no {QUANTITIES[key].of} that there is{hint}"
                    raise WrongStates(f"{key} of {shown(name)}", problem, ", ".join(known[key]))
        elif key != INSTANTS and (hint := misspelt(key, (*QUANTITIES, *alone))):
            raise WrongStates(shown(key), f"is no quantity{hint}", ", ".join((*QUANTITIES, *alone)))


def require_given(states: Mapping[str, Any], scene: Scene, needed: Collection[str]) -> None:
    """See that states hold all numbers of some quantities that a scene asks for.

    Args:
        needed: names of quantities, or of numbers of the car, such as "camber".
    Raises:
        WrongStates: one is missing, or the scene does not ask for it.
    """
    asked = asked_numbers(scene)
    alone = {name: q for q, names in asked.items() if QUANTITIES[q].of == "car" for name in names}
    for need in needed:
        if need not in asked and need not in alone:
            hint = meant(str(need), (*asked, *alone))
            problem = f"is needed, and the scene does not ask for it{hint}"
            raise WrongStates(shown(need), problem, f"some of {', '.join((*asked, *alone))}")
        quantity, names = (need, asked[need]) if need in asked else (alone[need], (need,))
        given = {name for name, _ in _by_name(quantity, states.get(quantity, {}))}
        lacking = [name for name in names if name not in given and not (name in alone and name in states)]
        if lacking:
            of = "" if lacking == [need] else f" of {', '.join(lacking)}"
            form = "one number for each instant" if lacking == [need] else "an array for each of these"
            raise WrongStates(need, f"is needed and missing{of}", form)


def numbers_of(states: Mapping[str, Any], scene: Scene) -> tuple[Array, list[Array]]:
    """The instants of comparable states, (N,), and every array of theirs, (N, 3) or (N,)."""
    known = known_names(scene.mechanism.topology)
    alone = {name for q, names in known.items() if QUANTITIES[q].of == "car" for name in names}
    found = [
        np.asarray(array, dtype=float)
        for key, part in states.items()
        for name, array in (_by_name(key, part) if key in QUANTITIES else [(key, part)])
        if name in (known[key] if key in QUANTITIES else alone)
    ]
    return np.asarray(states.get(INSTANTS, scene.instants), dtype=float), found


def _by_name(quantity: str, part: object) -> Iterator[tuple[str, object]]:
    if not isinstance(part, Mapping):
        raise WrongStates(quantity, f"is a {type(part).__name__}", FORM)
    yield from part.items()


def _require_array(what: str, raw: object, shape: tuple[int, ...]) -> None:
    form = f"{shape}, {'three numbers' if shape[1:] else 'one number'} for each instant"
    try:
        array = np.asarray(raw)
    except (ValueError, TypeError) as error:
        raise WrongStates(what, f"is no array ({error})", form) from None
    if isinstance(raw, np.ma.MaskedArray) and (masked := int(np.sum(raw.mask))):
        raise WrongStates(what, f"has {masked} masked entries", "numbers, NaN where there are none")
    if array.dtype.kind not in "iuf":
        raise WrongStates(what, f"is of type {array.dtype}", "real numbers")
    if array.shape != shape:
        raise WrongStates(what, f"has the shape {array.shape}", form)
