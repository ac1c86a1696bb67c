"""The mechanism in Pinocchio: one free-flying body each, and the rows that join them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import as_strided

from absolute.backend import pin
from absolute.branch_signs import BranchSigns, sign_vectors
from absolute.description import Model
from absolute.drawing import Drawing
from absolute.features import Features
from absolute.groups import groups_of
from absolute.laws import LAWS
from absolute.rows import rows_of
from absolute.solution import Array
from absolute.stack import RowStack


class Poses(NamedTuple):
    """Poses of all bodies, the chassis first: rotation (bodies, 3, 3), origin (bodies, 3)."""

    rotation: Array
    origin: Array


def address(array: Array) -> int:
    """Where the first number of an array is kept."""
    return int(array.ctypes.data)


class Mechanism:
    """Bodies of a model as free flyers on the universe, in units of size, with all their rows.

    The chassis is the universe: its motion is added to the solution afterwards.

    Attributes:
        model, drawing, stack, branch_signs: what was described, its lengths, its rows, its branch.
        groups: bodies that their rows fix one after the other.
        joint_rows: number of rows before the rows of the inputs.
        pin_model, pin_data: the Pinocchio model of the moving bodies.
        drawn: configuration of the drawing, (7 * moving bodies,).
        drawn_inputs: (inputs,) values of the inputs in the drawing, rad or mm.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.drawing = drawing = Drawing(model)
        rows = rows_of(model, drawing)
        features = Features(len(drawing.bodies))
        vectors = sign_vectors(model, drawing, rows.senses, features)
        self.stack = RowStack(rows, features)
        self.branch_signs = BranchSigns(model, vectors, features)
        self.groups = groups_of(self.stack.first, self.stack.second, len(drawing.bodies))
        self.joint_rows = self.stack.count - len(model.inputs)
        self.pin_model = pin.Model()
        for body in model.moving:
            self.pin_model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), body)
        # After the last joint and frame: data made earlier would be too small.
        self.pin_data = self.pin_model.createData()
        self.drawn = pin.neutral(self.pin_model)
        self.drawn.reshape(-1, 7)[:, :3] = drawing.origins[1:]
        # Pinocchio keeps the placements one after the other, the universe first: two views reach
        # them all, and `poses` copies these out.
        placements = self.pin_data.oMi
        rotation, origin = placements[0].rotation, placements[0].translation
        apart = address(placements[1].rotation) - address(rotation)
        count = len(drawing.bodies)
        self._rotations = as_strided(rotation, (count, 3, 3), (apart, *rotation.strides))
        self._origins = as_strided(origin, (count, 3), (apart, *origin.strides))
        # A rotation and the translation after it, column by column.
        self._placements = as_strided(rotation, (count, 12), (apart, rotation.itemsize))
        self._laws = [
            (LAWS[drive.law].expand, drive.factor / drawing.size) for drive in model.inputs.values()
        ]
        self.drawn_inputs = np.array(
            [
                LAWS[drive.law].invert(
                    float(row.direction @ drawing.line(drive.axis.through, drive.point)) / factor
                )
                for drive, row, (_, factor) in zip(
                    model.inputs.values(),
                    rows.offsets[len(rows.offsets) - len(model.inputs) :],
                    self._laws,
                    strict=True,
                )
            ]
        )

    def poses(self, q: Array) -> Poses:
        """Poses of all bodies at a configuration."""
        pin.forwardKinematics(self.pin_model, self.pin_data, q)
        return Poses(self._rotations.copy(), self._origins.copy())

    def poses_of(self, q: Array) -> Poses:
        """Poses at N configurations (N, 7 * moving bodies): (N, bodies, 3, 3) and (N, bodies, 3)."""
        held = np.empty((len(q), *self._placements.shape))
        model, data, placements = self.pin_model, self.pin_data, self._placements
        for each, found in zip(q, held, strict=True):
            pin.forwardKinematics(model, data, each)
            found[...] = placements
        # Pinocchio keeps the columns of a rotation one after the other.
        rotation = held[..., :9].reshape(*held.shape[:-1], 3, 3).swapaxes(-1, -2)
        return Poses(rotation.copy(), held[..., 9:].copy())

    def moved(self, q: Array, rotation: Array, step: Array) -> Array:
        """Configuration after a step [o', w] per body in world axes; Pinocchio takes body axes."""
        local = step.reshape(-1, 2, 3) @ rotation[1:]
        return self.normalized(pin.integrate(self.pin_model, q, local.ravel()))

    def moved_all(self, q: Array, rotation: Array, steps: Array) -> Array:
        """N configurations after a step each: (N, 7 * moving bodies), (N, bodies, 3, 3), (N, rows)."""
        local = (steps.reshape(len(steps), -1, 2, 3) @ rotation[:, 1:]).reshape(len(steps), -1)
        moved = np.empty_like(q)
        for number, (each, step) in enumerate(zip(q, local, strict=True)):
            moved[number] = pin.normalize(self.pin_model, pin.integrate(self.pin_model, each, step))
        return moved

    def normalized(self, q: Array) -> Array:
        """A configuration with unit quaternions."""
        unit: Array = pin.normalize(self.pin_model, q)
        return unit

    def named(self, values: Sequence[float]) -> dict[str, float]:
        """Values of the inputs by name."""
        return dict(zip(self.model.inputs, values, strict=True))

    def targets(self, values: list[float], rates: list[float], seconds: list[float]) -> Array:
        """(3, rows): what the rows shall equal, and its first and second rate, for inputs and their rates."""
        driven = []
        for (law, factor), value, speed, second in zip(self._laws, values, rates, seconds, strict=True):
            f, f1, f2 = law(value)
            driven.append((factor * f, factor * f1 * speed, factor * (f2 * speed * speed + f1 * second)))
        targets = np.zeros((3, self.stack.count))
        targets[:, self.joint_rows :] = np.array(driven).T
        return targets

    def target_series(self, series: Array) -> Array:
        """(3, N, rows): targets and their rates for inputs (N, 3, inputs) over N instants."""
        targets = np.zeros((3, len(series), self.stack.count))
        for row, ((law, factor), column) in enumerate(
            zip(self._laws, series.transpose(2, 1, 0), strict=True), self.joint_rows
        ):
            _, speed, second = column
            f, f1, f2 = factor * np.array([law(value) for value in column[0].tolist()]).reshape(-1, 3).T
            targets[:, :, row] = f, f1 * speed, f2 * speed * speed + f1 * second
        return targets

    def target_slopes(self, series: Array) -> Array:
        """(3, 3, N, inputs): how the targets of the inputs' rows, and their first and second rates, change
        with value, rate and acceleration of the input, (N, 3, inputs): slopes[of the input, of the target].
        """
        slopes = np.zeros((3, 3, len(series), series.shape[-1]))
        for place, (drive, (law, factor), column) in enumerate(
            zip(self.model.inputs.values(), self._laws, series.transpose(2, 1, 0), strict=True)
        ):
            third = LAWS[drive.law].third
            terms = [(*law(value)[1:], third(value)) for value in column[0].tolist()]
            f1, f2, f3 = factor * np.array(terms).reshape(-1, 3).T
            _, speed, second = column
            slopes[0, :, :, place] = f1, f2 * speed, f3 * speed * speed + f2 * second
            slopes[1, 1:, :, place] = f1, 2.0 * f2 * speed
            slopes[2, 2, :, place] = f1
        return slopes
