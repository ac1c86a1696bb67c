"""Solves a motion: assembles the drawing, follows it through the instants, computes the rates there."""

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from absolute.effects import TIME, effects_of, numbers_of
from absolute.errors import AbsoluteError, InputError
from absolute.follow import through
from absolute.initial_assembly import assemble, locked
from absolute.loads import forces
from absolute.mechanism import Mechanism
from absolute.model import Model
from absolute.newton import Configurations, leading, lengths, more_than_rounding, rates
from absolute.results import Instants, Motion, solution_of
from absolute.solution import Solution
from absolute.vectors import EPS, Array

# Roundings of eps in the rate of a row, from its pose and its velocities, each as in the row's value (see
# `rows`).
LEFT_OUT = 3 * 4 * EPS


@dataclass(frozen=True)
class ClosedDrawing:
    """A drawing solved at the drawn inputs.

    Attributes:
        inputs: input name -> its drawn value, rad or mm.
        position: point name -> (3,) place in the closed drawing, mm.
        movement: point name -> distance from the drawn to the closed place, mm.
    """

    inputs: Mapping[str, float]
    position: Mapping[str, Array]
    movement: Mapping[str, float]


def close_drawing(model: Model) -> ClosedDrawing:
    """Solve a model at the drawn inputs.

    Raises:
        DescriptionError, PoseError: as `solve`.
    """
    assembled = Assembled(model)
    inputs = assembled.drawn_inputs
    still = {name: np.array([[value, 0.0, 0.0]]) for name, value in inputs.items()}
    position = {name: place[0] for name, place in assembled.solve(still, rates=False).position.items()}
    drawn = model.points
    moved = {name: float(np.linalg.norm(place - drawn[name])) for name, place in position.items()}
    return ClosedDrawing(inputs, position, moved)


def solve(
    model: Model,
    inputs: Mapping[str, Array],
    rates: bool = True,
    effects: Sequence[str] = (),
    loads: bool = False,
) -> Solution:
    """Positions, velocities and accelerations of a linkage at N instants.

    Args:
        model: the linkage.
        inputs: name -> (N, 3) value, rate and acceleration of every input of the model (rad or mm, per s).
            With higher rates of all inputs, (N, orders), the solution has these rates of points too.
        rates: False for positions only.
        effects: names of `effects_in(model)`.
        loads: whether to compute forces of rods, joints and slides under the loads of the model.
    Returns:
        Solution with one row per instant.
    Raises:
        DescriptionError: an axis has no length, or lines have opposite senses; surplus rows are not
            redundant; the model has no loads, or redundant rows, though loads are requested; it lacks a role,
            car data, or an input to take derivatives by, for the effects or loads.
        InputError: wrong names, shapes or values of inputs; an unknown effect.
        PoseError: the drawn bodies do not fit together, the mechanism locks before the inputs of an instant
            are reached, or these do not determine the pose.
        Every error at an instant carries the motion before it as `partial`.

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
    return Assembled(model).solve(inputs, rates, effects, loads)


class Assembled:
    """A linkage with its drawing assembled, to be solved for any inputs.

    Raises:
        DescriptionError, PoseError: as `solve`.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self._mechanism = Mechanism(model)
        with np.errstate(over="ignore", invalid="ignore"):
            self._drawn = assemble(self._mechanism)

    @property
    def drawn_inputs(self) -> dict[str, float]:
        """Values of the inputs in the drawing, rad or mm."""
        # Adding 0 turns -0 into 0, for a rack drawn at its centre.
        drawn = self._mechanism.named((self._mechanism.drawn_inputs + 0.0).tolist())
        return dict.fromkeys(self.model.moves, 0.0) | drawn

    def solve(
        self,
        inputs: Mapping[str, Array],
        rates: bool = True,
        effects: Sequence[str] = (),
        loads: bool = False,
    ) -> Solution:
        """The motion for inputs at N instants; arguments and errors as for `solve`."""
        model, mechanism = self.model, self._mechanism
        asked, by = effects_of(effects, model)
        rated = rates or any(one.effect.by == TIME for one in asked.values())
        series = _series({*mechanism.values, *model.moves}, inputs)
        # Rows with the same value have a column each.
        columns = np.zeros((0, 3, 0))
        if series:
            columns = np.stack([series[name] for name in mechanism.values], axis=-1)
        displaced = np.zeros((*columns.shape[:2], 3))
        for name, way in model.moves.items():
            displaced += series[name][..., None] * way
        followed = self._followed(columns, rated, tuple(by.values()))

        def solution(count: int | None = None) -> Solution:
            found = Instants(*(np.concatenate(parts)[:count] for parts in zip(*runs, strict=True)))
            motion = Motion(model, *found[:3], tuple(by))
            loaded = forces(mechanism, motion) if loads else {}
            moved, numbers = displaced[: len(found.residual)], numbers_of(asked, motion)
            return solution_of(model, found, moved, rates, effects=numbers, **loaded)

        with np.errstate(over="ignore", invalid="ignore"):
            runs = [next(followed)]
            # A description that lacks data for effects or loads is refused before solving, even for N = 0.
            solution()
            try:
                runs += followed
            except AbsoluteError as error:
                error.partial = solution() if len(runs) > 1 else None
                raise
            whole = solution()
            # Accelerations overflow wherever rates do.
            finite = np.ones(len(columns), dtype=np.bool_)
            for rates_of in (whole.acceleration, *whole.higher):
                for rate in rates_of.values():
                    finite &= np.isfinite(rate).all(axis=1)
            if finite.all():
                return whole
            bad = leading(finite)
            refused = _overflow(bad, {name: law[bad, 1:] for name, law in series.items()})
            refused.partial = solution(bad) if bad else None
            raise refused

    def _followed(self, series: Array, rated: bool, by: Sequence[str]) -> Iterator[Instants]:
        """The instants of values (N, orders, values), with the velocities for unit rates of some inputs: an
        empty run first, then one run after the other."""
        mechanism, done = self._mechanism, 0
        targets = mechanism.targets(*series.swapaxes(0, 1))
        # For a slide, per unit of its travel, whatever value drives it.
        steers = [drive.steers or 1.0 for drive in self.model.inputs]
        per = np.array(steers + [1.0] * (series.shape[2] - len(steers)))
        named = np.array(mechanism.values)
        units = [mechanism.targets(series[:, 0], (named == value) / per)[1] for value in by]

        def at(found: Configurations) -> tuple[Instants, NDArray[np.bool_]]:
            """The results at some configurations, and whether left-out rows hold for all velocities."""
            rotation, origin = found.placed[:2]
            here = slice(done, done + len(origin))
            if rated:
                moving = rates(mechanism, found, *targets[1:, here])
            else:
                moving = [np.zeros((*origin.shape[:2], 2, 3))] * (len(targets) - 1)
            slopes = np.stack([*(rates(mechanism, found, unit[here])[0] for unit in units), moving[0]], 1)
            higher = np.stack(moving[1:], 1)
            held, residual = np.ones(len(origin), dtype=np.bool_), found.residual
            for velocity in slopes.swapaxes(0, 1):
                residual, followed = _of_rates(mechanism, found, velocity)
                held &= followed
            results = residual, found.condition, found.corrections
            return Instants(rotation, origin, slopes, higher, *results), held

        yield at(self._drawn.part(slice(0)))[0]
        for found in through(mechanism, self._drawn, series[:, 0]):
            instants, held = at(found)
            good = leading(held)
            if good:
                yield Instants._make(part[:good] for part in instants)
            done += good
            if not held.all():
                raise locked(mechanism, done, found.part(slice(good, good + 1)), series[done, 0].tolist())


def _series(names: Collection[str], inputs: Mapping[str, object]) -> dict[str, Array]:
    """name -> (N, orders): value, rate, acceleration and any higher rates of every input.

    Raises:
        InputError: an input is missing, unknown, of another length, or not finite.
    """
    unknown, missing = sorted({*inputs} - {*names}), sorted({*names} - {*inputs})
    if unknown or missing:
        raise InputError(
            f"inputs must be exactly {sorted(names)}; unknown: {unknown}, missing: {missing}",
            (unknown or missing)[0],
        )
    series = {name: _array(name, values) for name, values in inputs.items()}
    orders = max([3, *(law.shape[1] for law in series.values() if law.ndim == 2)])
    count = len(next(iter(series.values()), ()))
    for name, law in series.items():
        if law.shape[1:] != (orders,):
            raise InputError(
                f"{name!r} has shape {law.shape}; {('N', orders)} is needed: value, rate and acceleration at "
                "each instant, and as many higher rates as the other inputs have",
                name,
                law.shape,
            )
        instant = leading(np.asarray(np.isfinite(law).all(axis=1)))
        if instant < len(law):
            found = law[instant].tolist()
            raise InputError(
                f"{name!r} is {found} at instant {instant}; all its numbers must be finite",
                name,
                found,
                instant,
            )
        if len(law) != count:
            raise InputError(
                f"{name!r} has {len(law)} instants, the others have {count}; give all the same number",
                name,
                len(law),
            )
    return series


def _array(name: str, values: object) -> Array:
    try:
        # An array without dimensions becomes one instant without numbers.
        return np.atleast_1d(np.array(values, dtype=float))
    except (TypeError, ValueError) as error:
        raise InputError(f"{name!r} is not an array of numbers: {error}", name, values) from error


def _of_rates(
    mechanism: Mechanism, found: Configurations, velocity: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """(N,) residuals including the rates of left-out rows at unit speed, and whether these rows hold."""
    if not len(found.choice.left_out):
        return found.residual, np.ones(len(velocity), dtype=np.bool_)
    # A redundant row has zero rate, apart from the error of the pose.
    unknown = velocity.reshape(len(velocity), 6 * velocity.shape[1]).take(mechanism.columns, 1)
    rate = np.abs(np.matvec(found.jacobian[:, found.choice.left_out], unknown)).max(axis=1)
    speed = lengths(velocity)
    missed = np.divide(rate, speed, out=np.zeros_like(rate), where=speed > 0.0)
    allowed = LEFT_OUT * more_than_rounding(found.inverse) * speed
    # NaN passes here: overflow is reported elsewhere.
    return np.maximum(found.residual, missed), ~(rate > allowed)


def _overflow(instant: int, rates: Mapping[str, Array]) -> InputError:
    # Accelerations are of the order of squared speeds, and so on.
    fastest = max(
        rates, key=lambda name: max(abs(rate) ** (1.0 / d) for d, rate in enumerate(rates[name], 1))
    )
    return InputError(
        f"instant {instant}: the rates and accelerations of points overflow; those of {fastest!r} are "
        f"{rates[fastest].tolist()}: give smaller ones",
        fastest,
        rates[fastest].tolist(),
        instant,
    )
