r"""pointcoord's proven bounds held against the reference, a pose at a time.

The error of a pose is its distance from the reference, whose own is below 1e-40 of the car. It must never
exceed the bound:

    error <= bound,    and    loss = error / (eps (condition size + far))    must not grow to the end,

with size the power of two in which the mechanism counts lengths and far its distance from the origin.
Near the end of an input the condition number grows as distance^(-1/2), because the end is a fold, so an
error that follows condition eps has slope 1 over that rounding and -1/2 over the distance in
double-logarithmic scales.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from pointcoord import Motion, PointcoordError, Scene, simulate
from pointcoord.suspensions.macpherson import DRAWN
from validate.cars.closed_form import Closure
from validate.cars.near_singular import NearPose, near_pose
from validate.formulations.input_rates import rates
from validate.reference import InfeasibleError, Instant, NoReferenceError, solve_reference
from validate.reference.exact import as_fraction

Array = NDArray[np.float64]
Answer = TypeVar("Answer")

EPS = float(np.finfo(float).eps)
DIGITS = 40  # of the reference: its error is 1e-20 of any error in double precision
INSTANTS = 4  # per motion


@dataclass(frozen=True)
class Check:
    """One pose of pointcoord held against the reference; lengths in mm.

    Attributes:
        number, driven, lock, distance: of the `NearPose`; distance of the instant, for a motion.
        strut: the car's closure.
        instant: s, for a motion; a held pose has the instant 0.
        condition: of the Jacobian.
        size: of the mechanism, a power of two.
        far: largest coordinate of a point in the frame of the scene.
        error, bound: of the solved points. carried_error, carried_bound: of those carried.
    """

    number: int
    strut: Closure
    driven: str
    lock: str
    distance: float
    instant: float
    condition: float
    size: float
    far: float
    error: float
    bound: float
    carried_error: float
    carried_bound: float

    @property
    def share(self) -> float:
        """The larger error in parts of its bound: above 1 the bound is broken."""
        return max(self.error / self.bound, self.carried_error / self.carried_bound)

    @property
    def rounding(self) -> float:
        """What rounding may do: eps (condition size + far), mm."""
        return EPS * (self.condition * self.size + self.far)

    @property
    def loss(self) -> float:
        """Error in parts of that rounding."""
        return self.error / self.rounding


@dataclass(frozen=True)
class Refusal:
    """A pose without an answer: who refused it, and the kind of reason."""

    number: int
    strut: Closure
    distance: float
    reason: str


@dataclass(frozen=True)
class BoundStudy:
    """What a study found; `held` are poses at the end of an input, `moving` instants of motions."""

    seed: int
    held: tuple[Check, ...]
    moving: tuple[Check, ...]
    refusals: tuple[Refusal, ...]

    @property
    def broken(self) -> tuple[Check, ...]:
        """Where the bound is below the error."""
        return tuple(check for check in (*self.held, *self.moving) if not check.share <= 1.0)


def held_pose(pose: NearPose) -> list[Check | Refusal]:
    """The check of a car whose inputs are constant."""
    laws = {name: [value] for name, value in pose.inputs.items()}
    return _checked(pose, laws, np.zeros(1), stop=0.0)


def moving_instants(number: int, seed: int) -> list[Check | Refusal]:
    """Checks at random instants of a motion from the drawing towards the end of an input.

    All inputs run at constant rates for one second; half the instants lie anywhere, half towards the end.
    """
    pose = near_pose(number, seed, nearest=1e-8)
    rng = np.random.default_rng([seed, number, 1])
    laws = {name: [pose.home[name], value - pose.home[name]] for name, value in pose.inputs.items()}
    late = 1.0 - 10.0 ** rng.uniform(-8.0, 0.0, INSTANTS // 2)
    return _checked(pose, laws, np.concatenate([rng.uniform(0.0, 1.0, INSTANTS - len(late)), late]), stop=1.0)


def _checked(
    pose: NearPose, laws: Mapping[str, Sequence[float]], instants: Array, stop: float
) -> list[Check | Refusal]:
    car = pose.car
    scene = Scene.from_mapping(
        {
            "effects": [],
            "mechanism": {
                "type": "macpherson",
                "closure": car.closure,
                "side": car.side,
                "up": list(car.up),
                "right": list(car.right),
                "points": {name: list(place) for name, place in car.points.items()},
            },
            "inputs": {name: {"polynomial": list(law)} for name, law in laws.items()},
            "time": {"start": 0.0, "stop": stop, "samples": 1 if stop == 0.0 else 2},
        }
    )
    motion = _answer(lambda: simulate(scene))
    return [_check(pose, scene, float(t), motion) for t in instants]


def _check(pose: NearPose, scene: Scene, instant: float, motion: Motion | str) -> Check | Refusal:
    # The distance of a motion shrinks with the part of its way that is left.
    rate = (*(scene.inputs[pose.driven].polynomial or ()), 0.0)[1]
    distance = pose.distance + abs(rate) * (1.0 - instant) / pose.reach
    reference = _answer(lambda: _reference(pose, scene, instant))
    if isinstance(motion, str) or (isinstance(reference, str) and reference != InfeasibleError.__name__):
        return Refusal(
            pose.number,
            pose.car.closure,
            distance,
            f"pointcoord: {motion if isinstance(motion, str) else 'answers'}; "
            f"reference: {reference if isinstance(reference, str) else 'answers'}",
        )
    samples = motion.at(np.array([instant]))
    proof = motion.proof_of(samples)
    bound, carried = float(proof.bound[0]), float(proof.carried_bound[0])
    if not math.isfinite(bound):
        return Refusal(pose.number, pose.car.closure, distance, "pointcoord: no finite bound")
    error = carried_error = math.inf  # where the reference has no such assembly
    if isinstance(reference, Instant):
        each = {name: _error(reference, name, place[0]) for name, place in samples.position.items()}
        carried_error = max(each.pop(name) for name in DRAWN.carried if name in each)
        error = max(each.values())
    return Check(
        number=pose.number,
        strut=pose.car.closure,
        driven=pose.driven,
        lock=pose.lock,
        distance=distance,
        instant=instant,
        condition=float(proof.condition[0]),
        size=motion.unit,
        far=max(float(np.abs(place).max()) for place in samples.position.values()),
        error=error,
        bound=bound,
        carried_error=carried_error,
        carried_bound=carried,
    )


def _answer(ask: Callable[[], Answer]) -> Answer | str:
    """What is asked for, or the name of the error that refuses it."""
    try:
        return ask()
    except (PointcoordError, NoReferenceError) as error:
        return type(error).__name__


def _reference(pose: NearPose, scene: Scene, instant: float) -> Instant:
    """The reference for the values that the laws have in double precision, as the bound is for these."""
    at = np.array([instant])
    inputs = {name: (float(rates(law, at)[0, 0]), 0, 0) for name, law in scene.inputs.items()}
    car = pose.car
    return solve_reference(
        car.points,
        inputs,
        up=car.up,
        right=car.right,
        side=car.side,
        closure=car.closure,
        digits=DIGITS,
    )


def _error(reference: Instant, name: str, place: Array) -> float:
    """Largest component of the distance of a computed point from the true one, mm."""
    pairs = zip(reference.position[name], place, strict=True)
    return max(float(abs(as_fraction(exact, name) - Fraction(float(found)))) for exact, found in pairs)
