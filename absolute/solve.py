"""Solve a motion: assemble the drawing, follow it through the instants, and take the rates there."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from absolute.effects import TIME, effects_of, inputs_of, numbers_of
from absolute.errors import AbsoluteError, InputError
from absolute.follow import through
from absolute.initial_assembly import assemble, locked
from absolute.input_arrays import checked, input_series, orders_of
from absolute.loads import forces
from absolute.mechanism import Mechanism
from absolute.model import Model
from absolute.newton import Configurations, leading, lengths, more_than_rounding, rates
from absolute.results import Instants, Motion
from absolute.solution import Array, Solution
from absolute.turning import Turning
from absolute.vectors import EPS

# Roundings of eps in the rate of a row, of its pose and its velocities, each as in its value (see `rows`).
LEFT_OUT = 3 * 4 * EPS


@dataclass(frozen=True)
class ClosedDrawing:
    """A drawing solved at its own inputs.

    Attributes:
        inputs: input name -> its value in the drawing, rad or mm.
        position: point name -> (3,) where it is when the drawing is closed, mm.
        movement: point name -> how far that is from where it is drawn, mm.
    """

    inputs: Mapping[str, float]
    position: Mapping[str, Array]
    movement: Mapping[str, float]


def close_drawing(model: Model) -> ClosedDrawing:
    """Solve a model at the inputs of its own drawing, chassis at rest.

    Raises:
        DescriptionError, AssemblyError, SingularError: as `solve`.
    """
    assembled = Assembled(model)
    inputs = assembled.drawn_inputs
    still = {name: np.array([[value, 0.0, 0.0]]) for name, value in inputs.items()}
    position = {name: place[0] for name, place in assembled.solve(still, rates=False).position.items()}
    drawn = model.drawing.points
    moved = {name: float(np.linalg.norm(place - drawn[name])) for name, place in position.items()}
    return ClosedDrawing(inputs, position, moved)


def solve(
    model: Model,
    inputs: Mapping[str, Array],
    chassis: Array | None = None,
    rates: bool = True,
    conditions: bool = False,
    effects: Sequence[str] = (),
    loads: bool = False,
) -> Solution:
    """Positions, velocities and accelerations of a linkage at N instants.

    Args:
        model: the linkage.
        inputs: name -> (N, 3) value, rate and acceleration of every value of the inputs (rad or mm, per s);
            and of turns of the chassis, which is not turned where they are not given. With the jerks of all
            as well, (N, 4), there are jerks of points, and so on, (N, orders).
        chassis: (N, orders, 3) translation, velocity, acceleration of the chassis and so on in the frame of
            the points, mm, mm/s, mm/s^2, after all turns; None for none.
        rates: False for positions only.
        conditions: also the condition number of the scaled Jacobian at each instant.
        effects: names of `effect_names(model)`.
        loads: also the forces of rods, joints and slides under the loads of the model.
    Returns:
        Solution with one row per instant.
    Raises:
        DescriptionError: an axis of the model has no length or its lines point apart; rows that are too many;
            loads of a mechanism that has none, or whose rows follow from each other; effects or loads of one
            that lacks a role, a number of the car, or an input to take derivatives by.
        InputError: names, shapes or values of inputs or chassis; an effect that is not known.
        AssemblyError: the bodies as drawn do not fit together.
        UnreachableError: the mechanism locks before the inputs of an instant.
        SingularError: the inputs of an instant do not fix the pose.
        Every error raised at an instant carries the motion before it as `partial`.

    >>> import absolute
    >>> model = absolute.compile({  # a crank on a hinge, and how high its end is
    ...     "name": "crank",
    ...     "bodies": {"chassis": ["a", "b"], "crank": ["a", "b", "end"]},
    ...     "inputs": {"turn": {"angle": "crank", "from": "drawing", "on": "chassis"}},
    ...     "points": {"a": (0, 0, 0), "b": (100, 0, 0), "end": (0, 300, 0)},
    ...     "up": (0, 0, 1), "right": (0, 1, 0), "side": "left",
    ... })
    >>> solution = solve(model, {"turn": np.array([[np.pi / 6, 0.0, 0.0]])})
    >>> bool(abs(solution.position["end"][0, 2] - 150.0) < 1e-12)
    True
    """
    return Assembled(model).solve(inputs, chassis, rates, conditions, effects, loads)


class Assembled:
    """A linkage whose drawing is put together, to be solved for any inputs.

    Raises:
        DescriptionError, AssemblyError, SingularError: as `solve`.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self._mechanism = Mechanism(model)
        with np.errstate(over="ignore", invalid="ignore"):
            self._drawn = assemble(self._mechanism)

    @property
    def drawn_inputs(self) -> dict[str, float]:
        """Values of the inputs in the drawing, rad or mm."""
        # A drawn rack at its centre is at 0, not at -0.
        return self._mechanism.named((self._mechanism.drawn_inputs + 0.0).tolist())

    def solve(
        self,
        inputs: Mapping[str, Array],
        chassis: Array | None = None,
        rates: bool = True,
        conditions: bool = False,
        effects: Sequence[str] = (),
        loads: bool = False,
    ) -> Solution:
        """The motion by inputs at N instants; arguments and errors are those of `solve`."""
        model, mechanism = self.model, self._mechanism
        asked = effects_of(effects, model)
        by = inputs_of(asked, model, inputs)
        rated = rates or any(one.effect.by == TIME for one in asked.values())
        driving = {n: law for n, law in inputs.items() if n not in model.turns or n in model.values}
        orders = orders_of(inputs)
        series = input_series(model.values, driving, orders)
        still = np.zeros((len(series), orders, 3))
        carried = still if chassis is None else checked("chassis", chassis, (orders, 3), len(series))
        turns = [
            (turn, checked(name, inputs[name], (orders,), len(series)))
            for name, turn in model.turns.items()
            if name in inputs
        ]
        # Inputs that take the same value have a column each.
        series = series[..., [model.values.index(drive.value) for drive in model.inputs]]
        followed = self._followed(series, rated, tuple(by.values()))

        def motion(count: int | None = None) -> Motion:
            found = Instants(*(np.concatenate(parts)[:count] for parts in zip(*runs, strict=True)))
            there = len(found.residual)
            turned = tuple(Turning(turn.about, turn.axis, angle[:there], turn.rolls) for turn, angle in turns)
            return Motion(mechanism, found, carried[:there], turned, tuple(by))

        def numbers(of: Motion) -> dict[str, Mapping[str, Array]]:
            return {"effects": numbers_of(asked, of), **(forces(of) if loads else {})}

        def solution(count: int | None = None) -> Solution:
            found = motion(count)
            return found.solution(rates, conditions, **numbers(found))

        with np.errstate(over="ignore", invalid="ignore"):
            # What effects and loads lack is missing from no instants as well.
            runs = [next(followed)]
            numbers(motion())
            try:
                for run in followed:
                    runs.append(run)
            except AbsoluteError as error:
                error.partial = solution() if len(runs) > 1 else None
                raise
            whole = solution()
            # Where rates overflow, so do accelerations.
            finite = np.ones(len(series), dtype=np.bool_)
            for rates_of in (whole.acceleration, *whole.higher):
                for rate in rates_of.values():
                    finite &= np.isfinite(rate).all(axis=1)
            if finite.all():
                return whole
            bad = leading(finite)
            refused = _overflow(bad, {name: np.array(law, float)[bad, 1:] for name, law in inputs.items()})
            refused.partial = solution(bad) if bad else None
            raise refused

    def _followed(self, series: Array, rated: bool, by: Sequence[str]) -> Iterator[Instants]:
        """The instants of inputs (N, orders, inputs), first none and then one run of them after the other,
        with the velocities for unit rates of some values."""
        mechanism, done = self._mechanism, 0
        targets = mechanism.targets(*series.swapaxes(0, 1))
        named = np.array([drive.value for drive in self.model.inputs])
        # Of a slide by its travel, whatever the value that drives it.
        unit_of = np.array([1.0 / drive.steers if drive.steers else 1.0 for drive in self.model.inputs])
        units = [mechanism.targets(series[:, 0], unit_of * (named == value))[1] for value in by]

        def at(found: Configurations, rated: bool) -> tuple[Instants, NDArray[np.bool_]]:
            """Also whether rows that were left out hold all velocities."""
            placed, here = found.placed, slice(done, done + len(found.q))
            shape = (*placed.origin.shape[:2], 2, 3)
            slopes, moving = np.zeros((len(units), *shape)), np.zeros((len(targets) - 1, *shape))
            held, residual = np.ones(len(found.q), dtype=np.bool_), found.residual
            for number, unit in enumerate(units):
                (slopes[number],) = rates(mechanism, found, unit[here])
                held &= _of_rates(mechanism, found, slopes[number])[1]
            if rated:
                moving[:] = rates(mechanism, found, *targets[1:, here])
                residual, followed = _of_rates(mechanism, found, moving[0])
                held &= followed
            moving, slopes = moving.swapaxes(0, 1), slopes.swapaxes(0, 1)
            return Instants(placed.rotation, placed.origin, moving, slopes, residual, found.corrections), held

        yield at(self._drawn.part(slice(0)), rated=False)[0]
        for found in through(mechanism, self._drawn, series[:, 0]):
            instants, held = at(found, rated)
            good = leading(held)
            if good:
                yield Instants._make(part[:good] for part in instants)
            done += good
            if not held.all():
                raise locked(mechanism, done, found.part(slice(good, good + 1)), series[done, 0].tolist())


def _of_rates(
    mechanism: Mechanism, found: Configurations, velocity: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """(N,) residuals with the rates of rows that were left out at unit speed, and whether these hold."""
    if not len(found.choice.left_out):
        return found.residual, np.ones(len(velocity), dtype=np.bool_)
    # A row that follows from the others has no rate, but for what the pose is off.
    unknown = velocity.reshape(len(velocity), 6 * velocity.shape[1]).take(mechanism.columns, 1)
    rate = np.abs(np.matvec(found.jacobian[:, found.choice.left_out], unknown)).max(axis=1)
    speed = lengths(velocity)
    missed = np.divide(rate, speed, out=np.zeros_like(rate), where=speed > 0.0)
    allowed = LEFT_OUT * more_than_rounding(found.inverse) * speed
    # What overflows is refused for that.
    return np.maximum(found.residual, missed), ~(rate > allowed)


def _overflow(instant: int, rates: Mapping[str, Array]) -> InputError:
    # The squares of speeds are accelerations, and so on.
    fastest = max(
        rates, key=lambda name: max(abs(rate) ** (1.0 / d) for d, rate in enumerate(rates[name], 1))
    )
    return InputError(
        f"instant {instant}: the rates and accelerations of points overflow; those of {fastest!r} are "
        f"{rates[fastest].tolist()}: give smaller ones",
        fastest,
        instant,
        rates[fastest].tolist(),
    )
