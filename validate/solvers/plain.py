"""Anybody's solver as a formulation: plain data in, plain data out, no import of this project.

A solver is a function of one argument, or an object with a method `solve` of one argument, or a class without
arguments that makes one. What it is given is a mapping (lengths in mm, angles in rad, times in s; arrays are
numpy's, its own copies, and cannot be written to):

    suspension  "macpherson", "double_wishbone"; closure, such as "drawn" (see the README); side of the car
    up, right   unit vectors of the car's axes, [x, y, z]
    points      where the hardpoints are drawn, {name: [x, y, z]}
    carried     names of the points that ride on the knuckle without holding it
    wheel_radius, rack_per_turn    mm, or None where the scene does not say it
    car, loads  what the scene says of the whole car and of loads at its wheels, mm, N, N mm; empty if nothing
    instants    (N,)
    inputs      {name: {"position": (N,), "velocity": (N,), "acceleration": (N,)}} of those that the scene
                drives and of what can move the chassis, though it rests; and "jerk" and so on, if such are
                asked for
    asked       what is compared, {quantity: [names]}

It answers with a mapping of what it has, any part of what is asked, as arrays or lists:

    {"position": {"wheel_centre": (N, 3)}, "velocity": {...}, "wheel": {"camber": (N,)}}

A number that the whole car has, such as camber, may also stand by itself: {"camber": (N,)}. A solver that has
other instants than it was given, of which some are among these, names them: {"instants": (M,), ...}.
"""

from __future__ import annotations

import importlib
import traceback
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from pointcoord import Scene, SceneError
from pointcoord.effects.point_states import STATES
from pointcoord.effects.registry import QUANTITIES
from pointcoord.wording import meant, shown
from validate.errors import UsageError
from validate.formulations.asked_numbers import asked_numbers, known_names
from validate.formulations.protocol import Accuracy, FormulationError, Solution

Array = NDArray[np.float64]
Solve = Callable[[Mapping[str, Any]], Mapping[str, Any]]

INSTANTS = "instants"
METHOD = "solve"
ALIKE = 0.8  # of their letters, of names of which one is the other misspelt: "iterations" is no acceleration
HERE, IMPORTING = Path(__file__).parent, Path(importlib.__file__).parent


class SolverFailed(Exception):
    """A solver raised an error, or answered with nothing that can be compared.

    Attributes:
        problem: what went wrong, in one line, with the solver's own words. where: its own file and line.
    """

    def __init__(self, problem: str, where: str = "") -> None:
        self.problem = problem
        self.where = where
        super().__init__(problem + (f" at {where}" if where else ""))


def given_to_solver(scene: Scene) -> dict[str, Any]:
    """A scene as plain data, in the form that the top of this file tells; new arrays at every call."""
    # The many digits that laws are rounded from are an extra; this module is imported without it.
    from validate.formulations.input_rates import laws_of

    part, instants = scene.mechanism, scene.instants.copy()
    driven = laws_of(scene, instants)
    still = np.zeros_like(next(iter(driven.values())))
    laws = {name: driven.get(name, still) for name in part.topology.inputs}
    plain = part.plain(tuple(laws))
    given = {
        "suspension": part.name,
        "closure": part.closure,
        "side": part.side,
        "up": list(part.up),
        "right": list(part.right),
        "points": {name: list(place) for name, place in part.points.items()},
        "carried": list(part.topology.carried),
        **{name: plain[name] for name in ("wheel_radius", "rack_per_turn", "car", "loads")},
        INSTANTS: instants,
        "inputs": {
            name: {order: rate.copy() for order, rate in zip(STATES, law.T, strict=False)}
            for name, law in laws.items()
        },
        "asked": {quantity: list(names) for quantity, names in asked_numbers(scene).items()},
    }
    return read_only(given)


def read_only(given: dict[str, Any]) -> dict[str, Any]:
    """Data whose arrays cannot be written to."""
    for part in given.values():
        if isinstance(part, np.ndarray):
            part.flags.writeable = False
        elif isinstance(part, dict):
            read_only(part)
    return given


def as_function(solver: object, name: str) -> Solve:
    """What to call of a solver.

    Raises:
        UsageError: it is nothing that can be called and has no method `solve`, or it cannot be made.
    """
    if isinstance(solver, type):
        try:
            solver = solver()
        except Exception as error:
            remedy = "give a class without arguments, or an object or a function"
            raise UsageError(f"{name} cannot be made without arguments: {said(error)}; {remedy}") from error
    method = getattr(solver, METHOD, None)
    found = method if callable(method) else solver
    if not callable(found):
        problem = f"{name} is of type {type(solver).__name__}, which is no solver"
        raise UsageError(f"{problem}; give a function, or an object or a class with a method {METHOD!r}")
    return cast("Solve", found)


def said(error: BaseException) -> str:
    """An error in its own words, with its class, in one line."""
    words = " ".join(str(error).split())
    return f"{type(error).__name__}: {words}" if words else type(error).__name__


def no_mapping(answer: object) -> str:
    """What is wrong with an answer that is none."""
    what = "None" if answer is None else f"data of type {type(answer).__name__}"
    return f"it answers with {what}; needed: a mapping of what it has"


@dataclass(frozen=True)
class PlainSolver:
    """Anybody's solver, held to the accuracy that it states.

    Attributes:
        name: in tables and messages.
        function: see the top of this file.
        accuracy: how exactly it says it places every point, mm; what that makes of each number is derived in
            `formulations.stated_accuracy`.
    """

    name: str
    function: Solve
    accuracy: float

    def solve(self, scene: Scene) -> Solution:
        """Ask the solver, and say how far off its numbers may be.

        Raises:
            FormulationError: the solver raises an error (SolverFailed), or answers with no mapping.
        """
        given = given_to_solver(scene)
        try:
            answer = self.function(given)
        except SolverFailed as error:
            raise FormulationError(self.name, error) from error
        except (Exception, SystemExit) as error:
            raise FormulationError(self.name, SolverFailed(said(error), raised_at(error))) from error
        if not isinstance(answer, Mapping):
            raise FormulationError(self.name, SolverFailed(no_mapping(answer)))
        numbers, notes, faults = _numbers(self.name, answer, scene)
        times = self._times(answer, scene)
        accuracy, untold = self._accuracy(scene)
        # Of times that are none of the scene's nothing is compared.
        places = np.clip(np.searchsorted(scene.instants, times), 0, len(scene.instants) - 1)
        return Solution(self.name, times, numbers, accuracy.at(places), (*notes, *untold), faults)

    def _accuracy(self, scene: Scene) -> tuple[Accuracy, tuple[str, ...]]:
        """What is claimed at the scene's instants; nothing, and why, of a scene without a reference."""
        from validate.formulations.stated_accuracy import accuracy_for
        from validate.reference import NoReferenceError

        try:
            return replace(accuracy_for(scene, self.accuracy), stated=self.accuracy), ()
        except (FormulationError, SceneError, NoReferenceError) as error:
            every = np.ones(len(scene.instants), dtype=bool)
            note = f"no tolerance can be derived for {self.name}, so that nothing is tested: {error}"
            return Accuracy(np.ones(len(every)), blind=every, stated=self.accuracy), (note,)

    def _times(self, answer: Mapping[str, Any], scene: Scene) -> Array:
        if INSTANTS not in answer:
            return scene.instants
        try:
            times = np.asarray(answer[INSTANTS], dtype=float)
        except (ValueError, TypeError) as error:
            raise FormulationError(
                self.name, SolverFailed(f"its {INSTANTS} are no numbers ({error})")
            ) from error
        if times.ndim != 1 or not np.isin(times, scene.instants).any():
            problem = f"its {INSTANTS} have the shape {times.shape} and none of the scene's among them"
            raise FormulationError(
                self.name, SolverFailed(f"{problem}; give (M,) of those that it was given")
            )
        return times


def _numbers(
    who: str, answer: Mapping[str, Any], scene: Scene
) -> tuple[dict[str, dict[str, Any]], tuple[str, ...], tuple[str, ...]]:
    """What was asked for, of all that was answered; a line for what was not; one for what cannot be used."""
    asked, known = asked_numbers(scene), known_names(scene.mechanism.topology)
    every = (*known, *(name for q, names in known.items() if QUANTITIES[q].of == "car" for name in names))
    of_the_car = {n: q for q, names in asked.items() if QUANTITIES[q].of == "car" for n in names}
    found: dict[str, dict[str, Any]] = {}
    notes: list[str] = []
    faults: list[str] = []
    for key, part in answer.items():
        # Some numbers of the car are called as their quantity is.
        if key in of_the_car and not (key in asked and isinstance(part, Mapping)):
            found.setdefault(of_the_car[key], {})[key] = part
        elif key in asked and isinstance(part, Mapping):
            for name, array in part.items():
                if name in asked[key]:
                    found.setdefault(key, {})[name] = array
                else:
                    what = f"{QUANTITIES[key].words} of {shown(name)}"
                    told = faults if _misspelt(name, known[key]) else notes
                    told.append(_left_out(who, what, name, asked[key]))
        elif key in asked:
            faults.append(
                f"{who}: {key} is of type {type(part).__name__}; needed: arrays by name; it is left out"
            )
        elif key != INSTANTS:
            told = faults if _misspelt(key, every) else notes
            told.append(_left_out(who, shown(key), key, (*asked, *of_the_car)))
    return found, tuple(notes), tuple(faults)


def _misspelt(name: object, known: Collection[str]) -> bool:
    """Whether a name is one of the known ones misspelt; else it may be another."""
    return name not in known and bool(get_close_matches(str(name).lower(), known, n=1, cutoff=ALIKE))


def _left_out(who: str, what: str, name: object, there: Iterable[str]) -> str:
    names = tuple(there)
    hint = meant(str(name), names)
    return f"{who} gives {what}, which the scene does not ask for{hint}; it is left out" + (
        "" if hint else f"; asked for: {', '.join(names)}"
    )


def raised_at(error: BaseException) -> str:
    """The file and line that raised, of the solver's own if the call got so far."""
    own = [f for f in traceback.extract_tb(error.__traceback__) if not _ours(f.filename)]
    return f"{Path(own[-1].filename).name}:{own[-1].lineno}" if own else ""


def _ours(file: str) -> bool:
    """Whether a file is of this folder, or Python's own that imports: neither is the solver's."""
    return file.startswith("<frozen importlib") or Path(file).parent in (HERE, IMPORTING)
