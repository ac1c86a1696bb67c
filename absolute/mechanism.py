"""The mechanism in Pinocchio: one free-flying body each, and the rows that join them."""

from collections.abc import Sequence
from math import comb

import numpy as np

from absolute.backend import pin
from absolute.errors import DescriptionError
from absolute.groups import groups_of
from absolute.model import Model
from absolute.rows import RowStack
from absolute.solution import Array

# Rows that depend on each other do so only nearly where the drawing does not close yet.
LARGEST_DEPENDENT = 0.1


class Mechanism:
    """Bodies of a model as free flyers on the universe, in units of size, with all their rows.

    The chassis is the universe: its motion is added to the solution afterwards.

    Attributes:
        model, drawing, stack: what was described, its lengths, its rows.
        redundant: rows that depend on others in the drawing, so that they are left out and only held to;
            None where there are no such.
        columns: of [o', w] of all bodies, which are unknown: the chassis stands, and points do not turn.
        groups: bodies that their rows fix one after the other.
        joint_rows: number of rows before the rows of the inputs.
        pin_model, pin_data: the Pinocchio model of the moving bodies.
        drawn: configuration of the drawing, (7 * moving bodies,).
        drawn_inputs: (inputs,) values of the inputs in the drawing, rad or mm.
    """

    def __init__(self, model: Model) -> None:
        self.model, self.drawing = model, model.drawing
        bodies, inputs = len(model.bodies), len(model.inputs)
        sizes = np.array([0, *(3 if body in model.unturned else 6 for body in model.moving)])
        self.columns = np.flatnonzero(np.arange(6) < sizes[:, None])
        rows, senses = [*model.joints, *(drive.row for drive in model.inputs)], model.senses
        self.stack, self.redundant = RowStack(rows, bodies, self.columns, senses), None
        still = np.broadcast_to(np.eye(3), (bodies, 3, 3)), self.drawing.origins
        if left_out := _left_out(self.stack, inputs, *still):
            kept = [row for number, row in enumerate(rows) if number not in left_out]
            self.stack = RowStack(kept, bodies, self.columns, senses)
            self.redundant = RowStack([rows[number] for number in sorted(left_out)], bodies, self.columns)
        self.groups = groups_of(self.stack.first, self.stack.second, sizes)
        self.joint_rows = self.stack.count - inputs
        self.pin_model = pin.Model()
        for body in model.moving:
            self.pin_model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), body)
        # After the last joint and frame: data made earlier would be too small.
        self.pin_data = self.pin_model.createData()
        self.drawn = pin.neutral(self.pin_model)
        self.drawn.reshape(-1, 7)[:, :3] = self.drawing.origins[1:]
        # Of all bodies, the universe first; they change with the data.
        self._rotations = [placement.rotation for placement in self.pin_data.oMi]
        self._factors = np.array([drive.factor for drive in model.inputs])
        self._cosines = np.array([drive.cosine for drive in model.inputs], dtype=np.bool_)
        self.drawn_inputs = np.array([drive.drawn for drive in model.inputs])

    def signs(self, jacobian: Array) -> Array:
        """(..., groups) signs of the determinants of Jacobians (..., rows, rows), group by group."""
        blocks = (jacobian[..., rows[:, None], columns] for rows, columns in self.groups)
        return np.stack([np.sign(np.linalg.det(block)) for block in blocks], axis=-1)

    def poses(self, q: Array) -> tuple[Array, Array]:
        """Rotations (..., bodies, 3, 3) and origins (..., bodies, 3), the chassis first, at configurations
        (..., 7 * moving bodies)."""
        lead, bodies = q.shape[:-1], len(self._rotations)
        rotation, origin = np.empty((*lead, bodies, 3, 3)), np.zeros((*lead, bodies, 3))
        # All bodies fly freely on the universe.
        origin[..., 1:, :] = q.reshape(*lead, bodies - 1, 7)[..., :3]
        each = q.reshape(-1, self.pin_model.nq), rotation.reshape(-1, bodies, 3, 3)
        for one, turned in zip(*each, strict=True):
            pin.forwardKinematics(self.pin_model, self.pin_data, one)
            turned[...] = self._rotations
        return rotation, origin

    def spread(self, step: Array) -> Array:
        """(..., bodies, 2, 3) [o', w] of unknowns: what is known is zero."""
        every = np.zeros((*step.shape[:-1], 6 * len(self._rotations)))
        every[..., self.columns] = step
        return every.reshape(*step.shape[:-1], len(self._rotations), 2, 3)

    def moved(self, q: Array, rotation: Array, step: Array) -> Array:
        """Configurations (..., 7 * moving bodies) after steps [o', w], (..., bodies, 2, 3), in world axes, of
        bodies with rotations (..., bodies, 3, 3); Pinocchio takes body axes."""
        local = step[..., 1:, :, :] @ rotation[..., 1:, :, :]
        moved, model = np.empty_like(q), self.pin_model
        each = (q.reshape(-1, model.nq), local.reshape(-1, model.nv), moved.reshape(-1, model.nq))
        for one, way, there in zip(*each, strict=True):
            there[...] = pin.normalize(model, pin.integrate(model, one, way))
        return moved

    def named(self, values: Sequence[float]) -> dict[str, float]:
        """Values by name; of inputs that take the same one, that of the first."""
        named: dict[str, float] = {}
        for drive, value in zip(self.model.inputs, values, strict=True):
            named.setdefault(drive.value, value)
        return named

    def targets(self, values: Array, *rates: Array) -> Array:
        """(1 + rates, ..., rows): what the rows shall equal and its rates, for inputs (..., inputs).

        Args:
            rates: (..., inputs) derivatives of the inputs, the first, the second and so on.
        """
        series = [values, *rates]
        # Of an angle x it is the real part of z = exp(i x), with z' = i x' z, and so on by the product rule.
        turned = [np.exp(1j * values)]
        for n in range(1, len(series)):
            turned.append(1j * sum(comb(n - 1, i) * series[n - i] * turned[i] for i in range(n)))
        targets = np.zeros((len(series), *turned[-1].shape[:-1], self.stack.count))
        targets[0] = self.stack.drawn
        for target, angle, value in zip(targets, turned, series, strict=True):
            target[..., self.joint_rows :] = self._factors * np.where(self._cosines, angle.real, value)
        return targets


def _left_out(stack: RowStack, inputs: int, rotation: Array, origin: Array) -> set[int]:
    """Numbers of the rows of joints that are too many, chosen so that the others say as much as all.

    Those rows whose parts in the linear combinations of rows that vanish in the drawing are largest. Whether
    they do follow from the others is seen when the drawing is closed.
    """
    many = stack.count - stack.unknowns
    if many <= 0:
        return set()
    joints = stack.jacobian(stack.place(rotation, origin))[: stack.count - inputs]
    combined, strengths, _ = np.linalg.svd(joints)
    vanishing, chosen = combined[:, len(joints) - many :], set[int]()
    for _ in range(many):
        row = int(np.argmax(np.vecdot(vanishing, vanishing)))
        chosen.add(row)
        way = vanishing[row] / np.linalg.norm(vanishing[row])
        vanishing = vanishing - np.outer(vanishing @ way, way)
    if strengths[len(joints) - many] > LARGEST_DEPENDENT * strengths[0]:
        raise too_many_rows(tuple(stack.owners[row] for row in sorted(chosen)), stack.count - many)
    return chosen


def too_many_rows(owners: tuple[str, ...], unknowns: int) -> DescriptionError:
    """The refusal of rows that say something else than the others, by the owners of those too many."""
    return DescriptionError(
        f"joints and inputs give {unknowns + len(owners)} rows for {unknowns} unknown velocities, and "
        f"{len(owners)} of them ({', '.join(dict.fromkeys(owners))}) do not follow from the others in the "
        "drawing: the mechanism is held more than once: remove an input, or free a joint",
        owners[0],
        unknowns + len(owners),
    )
