"""Solve a motion: assemble the drawing, track it through the instants, refine these to rounding."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from absolute.description import Model
from absolute.effects import effects_of
from absolute.errors import AbsoluteError, InputError, SingularError
from absolute.initial_assembly import assemble, branch_error, locked
from absolute.input_arrays import chassis_series, input_series
from absolute.limits import limited_by, limiting_input, limits_at
from absolute.mechanism import Mechanism
from absolute.refine import BATCH, Refined, refine
from absolute.results import Asked, Record
from absolute.solution import Array, Solution
from absolute.tracking import Found, Tracking
from absolute.turning import turnings

# Instants that are tracked before they are refined: enough for long runs.
BLOCK = 256


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
        BranchError: a pose is on another branch.
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
            solve_instants(Tracking(self._mechanism, *self._drawn), series, rates, record)
        except AbsoluteError as error:
            error.partial = record.solution() if record.written else None
            raise
        return record.solution()


def driven_series(model: Model, inputs: Mapping[str, Array]) -> Array:
    """(N, 3, inputs) of inputs by the names of their values; turns of the chassis are passed over.

    Raises:
        InputError: one is missing, unknown, of another length, or not finite.
    """
    driving = {name: law for name, law in inputs.items() if name not in model.turns}
    # Inputs that take the same value have a column each.
    columns = [model.values.index(drive.value or name) for name, drive in model.inputs.items()]
    return input_series(model.values, driving)[..., columns]


def solve_instants(tracking: Tracking, series: Array, rates: bool, record: Record) -> None:
    """Find the poses for inputs (N, 3, inputs) from the assembled drawing on, and write them down.

    Args:
        rates: as the record was told.
    Raises:
        AbsoluteError: an instant cannot be solved; those before it are in the record.
    """
    # Absurd inputs may overflow on the way; what is not finite is refused where it arises.
    with np.errstate(over="ignore", invalid="ignore"):
        for start in range(0, len(series), BLOCK):
            _solve_block(tracking, series[start : start + BLOCK], rates, record)


def _solve_block(tracking: Tracking, series: Array, rates: bool, record: Record) -> None:
    """Track the pose through some instants, then refine all that were reached, even if one was not.

    An instant that ends on another branch is tried once more, from the assembled drawing.
    """
    begin, again = record.written, -1
    mechanism, targets = tracking.mechanism, tracking.mechanism.target_series(series)
    values = series[:, 0].tolist()
    while record.written < begin + len(series):
        failure: AbsoluteError | None = None
        done = record.written - begin
        try:
            found = tracking.advance(values[done:])
        except AbsoluteError as error:
            failure, found = error, tracking.found
        wrong = _store(mechanism, found, targets[:, done:], rates, record)
        if wrong is None:
            if failure is not None:
                raise failure
            continue
        refined, place = wrong
        bad = record.written
        here = bad - begin
        if not refined.closed[place]:
            raise _stalled(mechanism, bad, values[here], refined, place)
        there = refined.rotation[place], refined.origin[place]
        if refined.kept[place]:
            left_out = mechanism.redundant
            if left_out is not None and not refined.held[place]:
                raise locked(mechanism, bad, left_out, left_out.place(*there), values[here])
            raise _overflow(mechanism, bad, series[here, 1:])
        if again == bad:
            jacobian = mechanism.stack.jacobian(mechanism.stack.place(*there))
            raise branch_error(mechanism, bad, values[here], jacobian)
        again = bad
        tracking.back_to(bad)


def _store(
    mechanism: Mechanism, found: Found, targets: Array, rates: bool, record: Record
) -> tuple[Refined, int] | None:
    """Refine and write down what was found, up to the first instant that is not right.

    Returns:
        Where there is such an instant, the part it is in, and its place there.
    """
    # Even parts: a small one at the end would cost as many calls as a full one.
    whole = len(found.q)
    parts = max(1, round(whole / BATCH))
    for number in range(parts if whole else 0):
        part = slice(whole * number // parts, whole * (number + 1) // parts)
        refined = refine(mechanism, found.part(part), targets[:, part], rates)
        good = refined.closed & refined.kept & refined.held
        if rates:
            good &= _in_range(mechanism, refined)
        count = len(good) if good.all() else int(np.argmin(good))
        record.store(refined, count)
        if count < len(good):
            return refined, count
    return None


def _in_range(mechanism: Mechanism, refined: Refined) -> NDArray[np.bool_]:
    """(N,) whether accelerations of all points are finite in mm: o'' + w' x r + w x (w x r), where no r is
    longer than twice the size, so that no component is more than 8 (|a| + |v|^2) for the largest of the
    numbers of the bodies."""
    speed, second = (np.abs(rate).max(axis=1) for rate in (refined.velocity, refined.acceleration))
    return np.asarray(np.isfinite(8.0 * (second + speed * speed) * max(1.0, mechanism.drawing.size)))


def _stalled(
    mechanism: Mechanism, instant: int, values: list[float], refined: Refined, place: int
) -> SingularError:
    stack, size = mechanism.stack, mechanism.drawing.size
    residual, step = float(refined.residual[place]), float(refined.step[place])
    goal, drawn = (
        mechanism.targets(each)[0, mechanism.joint_rows :]
        for each in (values, mechanism.drawn_inputs.tolist())
    )
    jacobian = stack.jacobian(stack.place(refined.rotation[place], refined.origin[place]))
    limits = limits_at(mechanism, jacobian)
    return SingularError(
        f"instant {instant}: Newton's corrections stall at {step * size:.3g} mm with rows "
        f"{residual * size:.3g} mm from closed, more than rounding explains: the pose is too close to a "
        f"singular one, or just beyond it; {limited_by(limits)}stay away from the limit of the motion",
        instant,
        mechanism.named(values),
        {},
        residual * size,
        limits=limits,
        limit=limiting_input(mechanism, jacobian, goal - drawn),
    )


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
