"""Solve a motion: assemble the drawing, follow it through the instants, and take the rates there."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from absolute.description import Model
from absolute.effects import effects_of, inputs_of, numbers_of
from absolute.errors import AbsoluteError, InputError
from absolute.follow import through
from absolute.initial_assembly import assemble, locked
from absolute.input_arrays import chassis_series, input_series
from absolute.mechanism import Mechanism
from absolute.newton import Configurations, leading, lengths, more_than_rounding, rates, velocities
from absolute.precision import EPS
from absolute.results import Instants, Motion
from absolute.solution import Array, Solution
from absolute.turning import turnings

# Roundings of eps in the rate of a row, of its pose and its velocities, each as in its value (see `stack`).
LEFT_OUT = 3 * 4 * EPS


def solve(
    model: Model,
    inputs: Mapping[str, Array],
    chassis: Array | None = None,
    rates: bool = True,
    conditions: bool = False,
    effects: Sequence[str] = (),
) -> Solution:
    """Positions, velocities and accelerations of a linkage at N instants.

    Args:
        model: the linkage.
        inputs: name -> (N, 3) value, rate and acceleration of every value of the inputs (rad or mm, per s);
            and of turns of the chassis, which is not turned where they are not given.
        chassis: (N, 3, 3) translation, velocity, acceleration of the chassis in the frame of the
            points, mm, mm/s, mm/s^2, after all turns; None for none.
        rates: False for positions only.
        conditions: also the condition number of the scaled Jacobian at each instant.
        effects: names of EFFECTS.
    Returns:
        Solution with one row per instant.
    Raises:
        DescriptionError: an axis of the model has no length or its lines point apart; rows that are too many;
            effects of a linkage that lacks what they are effects of, or an input to take derivatives by.
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
    return Assembled(model).solve(inputs, chassis, rates, conditions, effects)


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

    def solve(
        self,
        inputs: Mapping[str, Array],
        chassis: Array | None = None,
        rates: bool = True,
        conditions: bool = False,
        effects: Sequence[str] = (),
    ) -> Solution:
        """The motion by inputs at N instants; arguments and errors are those of `solve`."""
        model, mechanism = self.model, self._mechanism
        asked = effects_of(effects)
        by = inputs_of(asked, model)
        series = driven_series(model, inputs)
        carried = chassis_series(chassis, len(series))
        turns = turnings(model, inputs, len(series))
        bodies = len(mechanism.drawing.bodies)
        rotation, origin, moving, slopes, residual = (
            np.zeros((0, *shape))
            for shape in ((bodies, 3, 3), (bodies, 3), (2, bodies, 2, 3), (len(by), bodies, 2, 3), ())
        )
        runs = [Instants(rotation, origin, moving, slopes, residual, np.zeros(0, dtype=np.int64))]

        def motion() -> Motion:
            instants = Instants(*(np.concatenate(parts) for parts in zip(*runs, strict=True)))
            count = len(instants.residual)
            turned = tuple(turn.first(count) for turn in turns)
            return Motion(mechanism, instants, carried[:count], turned, tuple(by))

        def solution() -> Solution:
            found = motion()
            return found.solution(rates, conditions, numbers_of(asked, found))

        # What effects lack is missing from no instants as well.
        numbers_of(asked, motion())
        # Absurd inputs may overflow on the way; what is not finite is refused where it arises.
        try:
            with np.errstate(over="ignore", invalid="ignore"):
                for run in self._followed(series, rates, tuple(by.values())):
                    runs.append(run)
        except AbsoluteError as error:
            error.partial = solution() if len(runs) > 1 else None
            raise
        return solution()

    def _followed(self, series: Array, rated: bool, by: Sequence[str]) -> Iterator[Instants]:
        """The instants of inputs (N, 3, inputs), one run of them after the other, and the velocities for unit
        rates of some values."""
        mechanism, done = self._mechanism, 0
        targets = mechanism.targets(*series.swapaxes(0, 1))
        named = np.array([drive.value or name for name, drive in self.model.inputs.items()])
        units = np.array([mechanism.targets(series[:, 0], 1.0 * (named == value))[1] for value in by])
        for found in through(mechanism, self._drawn, series[:, 0]):
            count, bodies = found.origin.shape[:2]
            moving, residual = np.zeros((count, 2, bodies, 2, 3)), found.residual
            slopes = np.zeros((count, len(by), bodies, 2, 3))
            held = fine = np.ones(count, dtype=np.bool_)
            for number, unit in enumerate(units):
                velocity = velocities(found, unit[done : done + count])
                slopes[:, number, 1:] = velocity.reshape(count, -1, 2, 3)
                held = held & _of_rates(mechanism, found, velocity)[1]
            if rated:
                both = np.stack(rates(mechanism, found, *targets[1:, done : done + count]), axis=1)
                moving[:, :, 1:] = both.reshape(count, 2, -1, 2, 3)
                residual, followed = _of_rates(mechanism, found, both[:, 0])
                held, fine = held & followed, _in_range(mechanism, both)
            good = leading(held & fine)
            if good:
                few, fewer = found.part(slice(good)), (moving[:good], slopes[:good], residual[:good])
                yield Instants(few.rotation, few.origin, *fewer, few.corrections)
            done += good
            if good < count:
                if held[good]:
                    raise _overflow(mechanism, done, series[done, 1:])
                raise locked(mechanism, done, found.part(slice(good, good + 1)), series[done, 0].tolist())


def driven_series(model: Model, inputs: Mapping[str, Array]) -> Array:
    """(N, 3, inputs) of inputs by the names of their values; turns of the chassis are passed over.

    Raises:
        InputError: one is missing, unknown, of another length, or not finite.
    """
    driving = {name: law for name, law in inputs.items() if name not in model.turns}
    # Inputs that take the same value have a column each.
    columns = [model.values.index(drive.value or name) for name, drive in model.inputs.items()]
    return input_series(model.values, driving)[..., columns]


def _of_rates(
    mechanism: Mechanism, found: Configurations, velocity: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """(N,) residuals with the rates of rows that were left out at unit speed, and whether these hold."""
    left_out = mechanism.redundant
    if left_out is None:
        return found.residual, np.ones(len(found.q), dtype=np.bool_)
    # A row that follows from the others has no rate, but for what the pose is off.
    placed = left_out.place(found.rotation, found.origin)
    rate = np.abs(np.matvec(left_out.jacobian(placed), velocity)).max(axis=1)
    speed = lengths(velocity)
    missed = np.divide(rate, speed, out=np.zeros_like(rate), where=speed > 0.0)
    return np.maximum(found.residual, missed), rate <= LEFT_OUT * more_than_rounding(found.inverse) * speed


def _in_range(mechanism: Mechanism, rates: Array) -> NDArray[np.bool_]:
    """(N,) whether accelerations of all points are finite in mm: o'' + w' x r + w x (w x r), where no r is
    longer than twice the size, so that no component is more than 8 (|a| + |v|^2) for the largest of the
    numbers (N, 2, rows) of the bodies."""
    speed, second = np.abs(rates).max(axis=2).T
    return np.asarray(np.isfinite(8.0 * (second + speed * speed) * max(1.0, mechanism.drawing.size)))


def _overflow(mechanism: Mechanism, instant: int, rates: Array) -> InputError:
    names = [drive.value or name for name, drive in mechanism.model.inputs.items()]
    speed, second = np.abs(rates)
    # The squares of speeds are accelerations.
    fastest = int(np.argmax(np.maximum(speed, np.sqrt(second))))
    return InputError(
        f"instant {instant}: rates and accelerations {rates.tolist()} of the inputs {names} overflow; "
        "give smaller ones",
        names[fastest],
        instant,
        rates.tolist(),
    )
