"""A user's solver as a formulation: plain data in, plain data out, no import of this project.

A solver is a function of one argument, an object with a method `solve` of one argument, or a class without
arguments that makes such an object. Its argument is a mapping (lengths in mm, angles in rad, times in s;
arrays are numpy's, and copies):

    suspension  "macpherson", "double_wishbone"; closure, such as "drawn" (see the README); side of the car
    up, right   unit vectors of the car's axes, [x, y, z]
    points      hardpoints as drawn, {name: [x, y, z]}
    carried     names of the points that are fixed to the knuckle but carry no joint
    wheel_radius, rack_per_turn    mm, or None if the scene does not give them
    car, loads  data of the whole car, and loads at its wheels, mm, N, N mm; empty if the scene has none
    instants    (N,)
    inputs      {name: {"position": (N,), "velocity": (N,), "acceleration": (N,)}} of every input that the
                scene drives, and of the inputs of the chassis even if it is at rest; also "jerk" and so on if
                the scene asks for such derivatives
    asked       the numbers that are compared, {quantity: [names]}

The answer is a mapping with any part of the requested numbers, as arrays or lists:

    {"position": {"wheel_centre": (N, 3)}, "velocity": {...}, "wheel": {"camber": (N,)}}

A number of the whole car, such as camber, may also be given directly: {"camber": (N,)}. A solver that answers
at other instants returns them: {"instants": (M,), ...}. At least one must be an instant that was given.
"""

from __future__ import annotations

import importlib
import traceback
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, cast

import numpy as np

from pointcoord import Scene, SceneError
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import QUANTITIES
from pointcoord.wording import meant, shown
from validate.arrays import Array
from validate.errors import UsageError
from validate.formulations.asked_numbers import asked_numbers, known_names
from validate.formulations.protocol import Accuracy, FormulationError, Solution, refusing
from validate.plain_text import named

Solve = Callable[[Mapping[str, Any]], Mapping[str, Any]]

INSTANTS = "instants"
METHOD = "solve"
ALIKE = 0.8  # similarity from which a name counts as misspelt; "iterations" is not "acceleration" misspelt
HERE, IMPORTING = Path(__file__).parent, Path(importlib.__file__).parent


class SolverFailed(Exception):
    """A solver raised an error, or its answer cannot be compared.

    Attributes:
        problem: what went wrong, in one line, with the solver's message.
        where: file and line in the solver's code.
    """

    def __init__(self, problem: str, where: str = "") -> None:
        self.problem = problem
        self.where = where
        super().__init__(problem + (f" at {where}" if where else ""))


def given_to_solver(scene: Scene) -> dict[str, Any]:
    """A scene as plain data, see the top of this file; new arrays at every call."""
    # Imported here: the laws need an optional package, and this module must be importable without it.
    from validate.formulations.input_rates import laws_of

    part, instants = scene.mechanism, scene.instants.copy()
    driven = laws_of(scene, instants)
    still = np.zeros_like(next(iter(driven.values())))
    laws = {name: driven.get(name, still) for name in part.topology.inputs}
    plain = part.plain(tuple(laws))
    return {
        "suspension": part.name,
        "closure": part.closure,
        "side": part.side,
        "up": list(part.up),
        "right": list(part.right),
        "points": {name: list(place) for name, place in part.points.items()},
        "carried": list(part.topology.carried),
        **{name: plain[name] for name in ("wheel_radius", "rack_per_turn", "car", "loads")},
        INSTANTS: instants,
        "inputs": {name: dict(zip(STATES, law.T.copy(), strict=False)) for name, law in laws.items()},
        "asked": {quantity: list(names) for quantity, names in asked_numbers(scene).items()},
    }


def as_function(solver: object, name: str) -> Solve:
    """The function of a solver.

    Raises:
        UsageError: the solver is not callable and has no method `solve`, or its class needs arguments.
    """
    if isinstance(solver, type):
        try:
            solver = solver()
        except Exception as error:
            remedy = "give a class without arguments, or an object or a function"
            raise UsageError(f"{name} cannot be made without arguments: {named(error)}; {remedy}") from error
    method = getattr(solver, METHOD, None)
    found = method if callable(method) else solver
    if not callable(found):
        problem = f"{name} is of type {type(solver).__name__}, which is not a solver"
        raise UsageError(f"{problem}; give a function, or an object or a class with a method {METHOD!r}")
    return cast("Solve", found)


def answer_of(solve: Solve, given: Mapping[str, Any]) -> Mapping[str, Any]:
    """The answer of a solver.

    Raises:
        SolverFailed: the solver raises an error, or does not return a mapping.
    """
    try:
        answer: object = solve(given)
    except SolverFailed:
        raise
    except (Exception, SystemExit) as error:
        raise SolverFailed(named(error), raised_at(error)) from error
    if not isinstance(answer, Mapping):
        what = "None" if answer is None else f"data of type {type(answer).__name__}"
        raise SolverFailed(f"it returns {what}; needed: a mapping of the numbers that it has")
    return answer


@dataclass(frozen=True)
class PlainSolver:
    """A user's solver with the accuracy that it states.

    Attributes:
        name: name in tables and messages.
        function: see the top of this file.
        accuracy: stated accuracy of every point, mm; `formulations.stated_accuracy` derives the error bound
            of each number from it.
    """

    name: str
    function: Solve
    accuracy: float

    def solve(self, scene: Scene) -> Solution:
        """Call the solver, and add the error bounds of its numbers.

        Raises:
            FormulationError: the solver raises an error (SolverFailed), or does not return a mapping.
        """
        with refusing(self.name, SolverFailed):
            answer = answer_of(self.function, given_to_solver(scene))
            times = _times(answer, scene)
        numbers, notes, faults = _numbers(self.name, answer, scene)
        accuracy, why_not = self._accuracy(scene)
        # Times that are not instants of the scene are not compared.
        places = np.clip(np.searchsorted(scene.instants, times), 0, len(scene.instants) - 1)
        return Solution(self.name, times, numbers, accuracy.at(places), (*notes, *why_not), faults)

    def _accuracy(self, scene: Scene) -> tuple[Accuracy, tuple[str, ...]]:
        """The error bounds at the scene's instants; if they cannot be derived, no bounds and a note why."""
        from validate.formulations.stated_accuracy import accuracy_for
        from validate.reference import NoReferenceError

        try:
            return replace(accuracy_for(scene, self.accuracy), stated=self.accuracy), ()
        except (FormulationError, SceneError, NoReferenceError) as error:
            every = np.ones(len(scene.instants), dtype=bool)
            note = f"no tolerance can be derived for {self.name}, so nothing is tested: {error}"
            return Accuracy(np.ones(len(every)), blind=every, stated=self.accuracy), (note,)


def _times(answer: Mapping[str, Any], scene: Scene) -> Array:
    if INSTANTS not in answer:
        return scene.instants
    try:
        times = np.asarray(answer[INSTANTS], dtype=float)
    except (ValueError, TypeError) as error:
        raise SolverFailed(f"its {INSTANTS} are not numbers ({error})") from error
    if times.ndim != 1 or not np.isin(times, scene.instants).any():
        problem = f"its {INSTANTS} have the shape {times.shape} and include no instant of the scene"
        raise SolverFailed(f"{problem}; needed: shape (M,), with instants that were given")
    return times


def _numbers(
    who: str, answer: Mapping[str, Any], scene: Scene
) -> tuple[dict[str, dict[str, Any]], tuple[str, ...], tuple[str, ...]]:
    """The requested numbers of an answer, notes on numbers not requested, and faults of unusable data."""
    asked, known = asked_numbers(scene), known_names(scene.mechanism.topology)
    every = (*known, *(name for q, names in known.items() if QUANTITIES[q].of == "car" for name in names))
    of_the_car = {n: q for q, names in asked.items() if QUANTITIES[q].of == "car" for n in names}
    found: dict[str, dict[str, Any]] = {}
    notes: list[str] = []
    faults: list[str] = []

    def ignore(name: object, what: str, known: Collection[str], there: Collection[str]) -> None:
        """Note a number that the scene does not ask for; it is a fault if its name is a misspelt one."""
        hint = meant(str(name), there)
        line = f"{who} gives {what}, which the scene does not ask for{hint}; it is ignored"
        misspelt = name not in known and get_close_matches(str(name).lower(), known, n=1, cutoff=ALIKE)
        (faults if misspelt else notes).append(line if hint else f"{line}; asked for: {', '.join(there)}")

    for key, part in answer.items():
        # A quantity of the car may have a number of the same name.
        if key in of_the_car and not (key in asked and isinstance(part, Mapping)):
            found.setdefault(of_the_car[key], {})[key] = part
        elif key in asked and isinstance(part, Mapping):
            for name, array in part.items():
                if name in asked[key]:
                    found.setdefault(key, {})[name] = array
                else:
                    ignore(name, f"{QUANTITIES[key].words} of {shown(name)}", known[key], asked[key])
        elif key in asked:
            faults.append(
                f"{who}: {key} is of type {type(part).__name__}; needed: arrays by name; it is ignored"
            )
        elif key != INSTANTS:
            ignore(key, shown(key), every, (*asked, *of_the_car))
    return found, tuple(notes), tuple(faults)


def raised_at(error: BaseException) -> str:
    """The file and line of the solver's code that raised; empty if no code of the solver was reached."""
    own = [f for f in traceback.extract_tb(error.__traceback__) if not _ours(f.filename)]
    return f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else ""


def _ours(file: str) -> bool:
    """Whether a file belongs to this folder or to Python's import system, and not to the solver."""
    return file.startswith("<frozen importlib") or Path(file).parent in (HERE, IMPORTING)
