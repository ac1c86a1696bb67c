"""The mechanism in Pinocchio: free-flying bodies, and the rows that join them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from absolute.backend import pin
from absolute.errors import DescriptionError
from absolute.model import Model
from absolute.rows import Placed, RowStack
from absolute.vectors import Array, Places, product_rule

# Redundant rows depend on each other only approximately while the drawing is not closed.
LARGEST_DEPENDENT = 0.1
# Rows are chosen anew if the kept ones span less than this share of the largest volume. They span zero where
# a row that was left out becomes independent.
LEAST_SPANNED = 0.5

AXES = np.eye(3)
# (3, 9): from a vector v to the matrix [v] of the product v x.
CROSSED = np.cross(AXES[:, None], AXES).swapaxes(1, 2).reshape(3, 9)

# Instead of the number of a row or a column without a partner.
NONE = -1


class Choice(NamedTuple):
    """A choice of independent rows, as many as there are unknowns.

    Attributes:
        kept: numbers of the rows kept. left_out: numbers of the other rows, which are only checked.
        groups: rows and columns, equally many, of the kept rows' Jacobian for each group of bodies that they
            fix one after the other.
    """

    kept: slice | Places
    left_out: Places
    groups: Sequence[tuple[Places, Places]]


class Mechanism:
    """Bodies of a model as free flyers, in units of size, with all their rows.

    The body that stands still is the universe: the chassis, or the body on which it turns. Displacements of
    the car are added to the solution afterwards.

    Attributes:
        model, stack: the described model, its rows.
        columns: indices of the unknowns among [o', w] of all bodies; the first body stands, points do not
        turn.
        joint_rows: number of rows before the rows of the inputs.
        choice: choice of rows in the drawing.
        bodies: number of bodies. pin_model: the Pinocchio model of the moving ones.
        drawn: configuration of the drawing, (7 * moving bodies,).
        values: names of the inputs' values, one per row; then of the displacements of the car, if heights
            over the ground depend on them.
        drawn_inputs: (values,) the values in the drawing, rad or mm.
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        self.bodies = bodies = len(model.bodies)
        self._sizes = np.array([0, *(3 if body in model.unturned else 6 for body in [*model.bodies][1:])])
        self.columns = np.flatnonzero(np.arange(6) < self._sizes[:, None])
        rows = [*model.joints, *(drive.row for drive in model.inputs)]
        self.stack, self.joint_rows = RowStack(rows, bodies, self.columns), len(model.joints)
        self.pin_model = pin.Model()
        for body in [*model.bodies][1:]:
            self.pin_model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), body)
        self.drawn = pin.neutral(self.pin_model)
        self.drawn.reshape(-1, 7)[:, :3] = model.origins[1:]
        self._factors = np.array([drive.factor for drive in model.inputs])
        kinds = np.array([drive.row.kind for drive in model.inputs], dtype=str)
        self._cosines, self._turns = kinds == "angle", kinds == "turn"
        over = np.array([drive.over_ground for drive in model.inputs], dtype=np.bool_)
        moves = model.moves if over.any() else {}
        self.values = (*(drive.value for drive in model.inputs), *moves)
        self.drawn_inputs = np.array([*(drive.drawn for drive in model.inputs), *(0.0 for _ in moves)])
        ups = np.array([drive.row.along for drive in model.inputs]).reshape(-1, 3) * over[:, None]
        # Displacements of the car are subtracted from heights over the ground.
        self._shares = np.hstack([np.eye(len(ups)), *(-(ups @ way)[:, None] for way in moves.values())])
        self.choice = self._leaving_out(np.arange(0))
        if self.stack.count > self.stack.unknowns:
            # `initial_assembly` checks the rest when the drawing is closed.
            placed = self.stack.place(*self.poses(self.drawn[None]))
            self.choice = self._leaving_out(_largest(self.redundancies(placed, LARGEST_DEPENDENT)))

    def choice_at(self, placed: Placed, before: Choice) -> Choice:
        """The choice for a pose, (1,); the previous choice if its rows span nearly as much."""
        if not len(before.left_out):
            return before
        vanishing = self.redundancies(placed)
        left_out = _largest(vanishing)
        # The volume of the kept rows is that of the rows left out in the vanishing combinations.
        spanned, most = (abs(np.linalg.det(vanishing[rows])) for rows in (before.left_out, left_out))
        return before if spanned >= LEAST_SPANNED * most else self._leaving_out(left_out)

    def redundancies(self, placed: Placed, largest: float = np.inf) -> Array:
        """(joint rows, surplus) linear combinations of joint rows that vanish at a pose, (1,).

        Raises:
            DescriptionError: one does not, its strength being above `largest` as a share of the strongest.
        """
        combined, strengths, _ = np.linalg.svd(self.stack.jacobian(placed)[0, : self.joint_rows])
        independent = self.joint_rows - (self.stack.count - self.stack.unknowns)
        vanishing = combined[:, independent:]
        if (strengths[independent:] > largest * strengths[0]).any():
            owners = self.stack.owners_of(_largest(vanishing))
            raise DescriptionError(
                f"joints and inputs give {self.stack.count} rows for {self.stack.unknowns} unknown "
                f"velocities, and {vanishing.shape[1]} of them ({', '.join(owners)}) do not follow from the "
                "others in the drawing, so the mechanism is overconstrained: remove an input, or free a "
                "joint",
                owners[0],
                self.stack.count,
            )
        return vanishing

    def _leaving_out(self, rows: Places) -> Choice:
        kept = np.setdiff1d(np.arange(self.stack.count), rows)
        groups = groups_of(self.stack.first[kept], self.stack.second[kept], self._sizes)
        # A slice if all rows are kept: it is read without a copy.
        return Choice(kept if len(rows) else slice(None), rows, groups)

    def poses(self, q: Array) -> tuple[Array, Array]:
        """Rotations (..., bodies, 3, 3) and origins (..., bodies, 3), the standing body first, for
        configurations (..., 7 * moving bodies)."""
        each = q.reshape(*q.shape[:-1], -1, 7)
        rotation = np.empty((*q.shape[:-1], self.bodies, 3, 3))
        origin = np.zeros(rotation.shape[:-1])
        # For a unit quaternion (v, w): 1 + 2 w [v] + 2 [v] [v].
        across = (each[..., 3:6] @ CROSSED).reshape(*each.shape[:-1], 3, 3)
        rotation[...] = AXES
        rotation[..., 1:, :, :] += 2.0 * (each[..., 6:, None] * across + across @ across)
        origin[..., 1:, :] = each[..., :3]
        return rotation, origin

    def spread(self, step: Array) -> Array:
        """(..., bodies, 2, 3) [o', w] from the unknowns; the others are zero."""
        every = np.zeros((*step.shape[:-1], 6 * self.bodies))
        every[..., self.columns] = step
        return every.reshape(*step.shape[:-1], self.bodies, 2, 3)

    def moved(self, q: Array, rotation: Array, step: Array) -> Array:
        """Configurations (..., 7 * moving bodies) after steps [o', w], (..., bodies, 2, 3), in world axes, of
        bodies with rotations (..., bodies, 3, 3); Pinocchio uses body axes."""
        local = step[..., 1:, :, :] @ rotation[..., 1:, :, :]
        moved, model = np.empty_like(q), self.pin_model
        each = (q.reshape(-1, model.nq), local.reshape(-1, model.nv), moved.reshape(-1, model.nq))
        for one, way, there in zip(*each, strict=True):
            there[...] = pin.normalize(model, pin.integrate(model, one, way))
        return moved

    def named(self, values: Sequence[float]) -> dict[str, float]:
        """Values by name; the first one if several inputs share a name."""
        named: dict[str, float] = {}
        for name, value in zip(self.values, values, strict=True):
            named.setdefault(name, value)
        return named

    def targets(self, values: Array, *rates: Array) -> Array:
        """(1 + rates, ..., rows): targets of the rows and their rates, for values (..., values).

        Args:
            rates: (..., values) derivatives of the values, the first, the second and so on.
        """
        series = [of @ self._shares.T for of in (values, *rates)]
        # cos x is the real part of z = exp(i x), with z' = i x' z, and so on by the product rule.
        turned = [np.exp(1j * series[0])]
        for n in range(1, len(series)):
            turned.append(1j * product_rule(n - 1, (series[n - i] * turned[i] for i in range(n))))
        # Rows measure angles without whole turns, which would cost digits.
        series[0] = np.where(self._turns, np.angle(turned[0]), series[0])
        targets = np.zeros((len(series), *turned[-1].shape[:-1], self.stack.count))
        targets[0] = self.stack.drawn
        for target, angle, value in zip(targets, turned, series, strict=True):
            target[..., self.joint_rows :] = self._factors * np.where(self._cosines, angle.real, value)
        return targets


def groups_of(first: Places, second: Places, sizes: Places) -> list[tuple[Places, Places]]:
    """Rows and columns of the groups of moving bodies that their rows fix one after the other, each as small
    as possible.

    A group has as many rows among its bodies, the standing body and earlier groups as it has freedoms: first
    a driven link, then links attached to it, and so on (Assur groups). A group's determinant changes sign
    where its assemblies meet, so it tells more than their product, the determinant of the Jacobian. Each body
    is matched with as many rows as it has freedoms and depends on the other bodies of these rows. Bodies that
    depend on each other are a group (Dulmage and Mendelsohn, 1958). If the matching is incomplete, some body
    can still move, and all bodies are one group.

    Args:
        first, second: the two bodies of each row. sizes: freedoms of each body, zero for the first.
    """
    holder = np.repeat(np.arange(len(sizes)), sizes)
    taken = _matched((first[:, None] == holder) | (second[:, None] == holder))
    if len(first) != len(holder) or taken is None:
        return [(np.arange(len(first)), np.arange(len(holder)))]
    own = np.empty(len(first), dtype=np.intp)
    own[taken] = holder
    # Which bodies each body depends on: by its own rows, then through 1, 3, 7 .. other bodies.
    depends = np.eye(len(sizes))
    depends[own, first] = depends[own, second] = 1.0
    for _ in range(len(sizes).bit_length()):
        depends = np.minimum(depends @ depends, 1.0)
    # The first body of each body's group.
    group = (depends * depends.T).argmax(axis=1)
    return [
        (np.flatnonzero(group[own] == one), np.flatnonzero(group[holder] == one))
        for one in np.unique(group[1:])
    ]


def _matched(suits: Array) -> Places | None:
    """(columns,) a row for each column among those that suit it, (rows, columns), each row once.

    A column asks the columns of the rows that suit it to take another row, and so on, until one finds a free
    row. None if a column gets no row.
    """
    row_of, column_of = np.full(suits.shape[1], NONE), np.full(suits.shape[0], NONE)
    for start in range(suits.shape[1]):
        asked_by, asking = dict[int, int](), [start]
        for column in asking:
            new = [row for row in np.flatnonzero(suits[:, column]).tolist() if row not in asked_by]
            asked_by |= dict.fromkeys(new, column)
            asking += column_of[new].tolist()
            if NONE in asking:
                break
        else:
            return None
        row = next(row for row in asked_by if column_of[row] == NONE)
        while row != NONE:
            column = column_of[row] = asked_by[row]
            row, row_of[column] = row_of[column], row
    return row_of


def _largest(vanishing: Array) -> Places:
    """Numbers of the rows with the largest shares in (rows, combinations), as many as combinations."""
    from scipy.linalg import qr

    return np.sort(qr(vanishing.T, mode="r", pivoting=True)[1][: vanishing.shape[1]]).astype(np.intp)
