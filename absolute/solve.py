"""Solve a motion: assemble the drawing, follow it through the instants, and take the rates there."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from absolute.description import Model
from absolute.effects import effects_of
from absolute.errors import AbsoluteError, InputError
from absolute.follow import through
from absolute.initial_assembly import assemble, locked
from absolute.input_arrays import chassis_series, input_series
from absolute.mechanism import Mechanism
from absolute.newton import Configurations, leading, lengths, more_than_rounding, rates
from absolute.precision import EPS
from absolute.results import Asked, Record
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
        effects: names of EFFECTS. One that needs derivatives over time brings the rates with it.
    Returns:
        Solution with one row per instant.
    Raises:
        DescriptionError: an axis of the model has no length or its lines point apart; rows that are too many;
            effects of a linkage that lacks what they are effects of.
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
        model = self.model
        asked = effects_of(effects)
        for effect in asked:
            model.corner.ends(effect.role)
        rates = rates or any(effect.derivative > 0 for effect in asked)
        series = driven_series(model, inputs)
        carried = chassis_series(chassis, len(series))
        turns = turnings(model, inputs, len(series))
        record = Record(self._mechanism, carried, Asked(rates, conditions, asked), turns)
        try:
            self._follow(series, rates, record)
        except AbsoluteError as error:
            error.partial = record.solution() if record.written else None
            raise
        return record.solution()

    def _follow(self, series: Array, rated: bool, record: Record) -> None:
        """Find the poses for inputs (N, 3, inputs) from the assembled drawing on, and write them down."""
        mechanism = self._mechanism
        # Absurd inputs may overflow on the way; what is not finite is refused where it arises.
        with np.errstate(over="ignore", invalid="ignore"):
            targets = mechanism.targets(*series.swapaxes(0, 1))
            for found in through(mechanism, self._drawn, series[:, 0]):
                if not rated:
                    record.store(found, found.residual)
                    continue
                of = slice(record.written, record.written + len(found.q))
                velocity, acceleration = rates(mechanism, found, *targets[1:, of])
                residual, held = _of_rates(mechanism, found, velocity)
                finite = _in_range(mechanism, velocity, acceleration)
                good = leading(held & finite)
                part = slice(good)
                record.store(found.part(part), residual[part], velocity[part], acceleration[part])
                if good < len(found.q):
                    bad = record.written
                    if not held[good]:
                        at = found.part(slice(good, good + 1))
                        raise locked(mechanism, bad, at, series[bad, 0].tolist())
                    raise _overflow(mechanism, bad, series[bad, 1:])


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


def _in_range(mechanism: Mechanism, velocity: Array, acceleration: Array) -> NDArray[np.bool_]:
    """(N,) whether accelerations of all points are finite in mm: o'' + w' x r + w x (w x r), where no r is
    longer than twice the size, so that no component is more than 8 (|a| + |v|^2) for the largest of the
    numbers of the bodies."""
    speed, second = (np.abs(rate).max(axis=1) for rate in (velocity, acceleration))
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
