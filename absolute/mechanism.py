"""The mechanism in Pinocchio: one free-flying body each, and the rows that join them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from absolute.backend import pin
from absolute.errors import DescriptionError
from absolute.model import Model
from absolute.rows import Placed, RowStack
from absolute.vectors import Array, Places, product_rule

# Rows that depend on each other do so only nearly where the drawing does not close yet.
LARGEST_DEPENDENT = 0.1
# Rows are chosen anew where those kept span less than this share of the volume that the best choice spans.
# They span none where a row that was left out says what they do not.
LEAST_SPANNED = 0.5


AXES = np.eye(3)


def _turned() -> Array:
    """(16, 9) of the products of x, y, z, w of a unit quaternion, what its rotation has beside the identity:
    2 w [v] + 2 [v] [v] with [v] [v] = v v^T - v . v."""
    shares = np.zeros((4, 4, 3, 3))
    for i, axis in enumerate(AXES):
        shares[i, 3] = 2.0 * np.cross(axis, AXES).T
        shares[i, :3, i] += 2.0 * AXES
        shares[i, i] -= 2.0 * AXES
    return shares.reshape(16, 9)


TURNED = _turned()


class Group(NamedTuple):
    """Places of its rows and columns, as many, in the Jacobian."""

    rows: Places
    columns: Places


class Choice(NamedTuple):
    """Rows that say as much as all, as many as there are unknowns.

    Attributes:
        kept: their numbers. left_out: those of the others, which are only held to.
        groups: bodies that the rows kept fix one after the other.
    """

    kept: slice | Places
    left_out: Places
    groups: Sequence[Group]


class Mechanism:
    """Bodies of a model as free flyers on the universe, in units of size, with all their rows.

    What stands is the universe: the chassis, or what it turns on. Displacements of the car are added to the
    solution afterwards.

    Attributes:
        model, drawing, stack: what was described, its lengths, its rows.
        columns: of [o', w] of all bodies, which are unknown: the first one stands, and points do not turn.
        joint_rows: number of rows before the rows of the inputs.
        choice: of the rows, in the drawing.
        bodies: how many there are. pin_model: the Pinocchio model of those that move.
        drawn: configuration of the drawing, (7 * moving bodies,).
        values: names of the inputs' values, one for each row, and behind these of displacements of the car,
            where heights over the ground hang on them.
        drawn_inputs: (values,) the values in the drawing, rad or mm.
    """

    def __init__(self, model: Model) -> None:
        self.model, self.drawing = model, model.drawing
        self.bodies = bodies = len(model.bodies)
        self._sizes = np.array([0, *(3 if body in model.unturned else 6 for body in [*model.bodies][1:])])
        self.columns = np.flatnonzero(np.arange(6) < self._sizes[:, None])
        rows = [*model.joints, *(drive.row for drive in model.inputs)]
        self.stack, self.joint_rows = RowStack(rows, bodies, self.columns), len(model.joints)
        self.pin_model = pin.Model()
        for body in [*model.bodies][1:]:
            self.pin_model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), body)
        self.drawn = pin.neutral(self.pin_model)
        self.drawn.reshape(-1, 7)[:, :3] = self.drawing.origins[1:]
        self._factors = np.array([drive.factor for drive in model.inputs])
        self._cosines = np.array([drive.cosine for drive in model.inputs], dtype=np.bool_)
        self._turns = np.array([drive.row.kind == "turn" for drive in model.inputs], dtype=np.bool_)
        over = np.array([drive.over_ground for drive in model.inputs], dtype=np.bool_)
        moves = model.moves if over.any() else {}
        self.values = (*(drive.value for drive in model.inputs), *moves)
        self.drawn_inputs = np.array([*(drive.drawn for drive in model.inputs), *(0.0 for _ in moves)])
        ups = np.array([drive.row.along for drive in model.inputs]).reshape(-1, 3) * over[:, None]
        # Of a height over the ground the displacements of the car are taken off.
        self._shares = np.hstack([np.eye(len(ups)), *(-(ups @ way)[:, None] for way in moves.values())])
        self.choice = self._chosen()

    def _chosen(self) -> Choice:
        """The rows to keep in the drawing; it is seen when that is closed whether the others follow.

        Raises:
            DescriptionError: they do not follow there, not even nearly.
        """
        many = self.stack.count - self.stack.unknowns
        if many <= 0:
            return self._leaving_out(np.arange(0))
        vanishing, strengths = self._vanishing(self.stack.place(*self.poses(self.drawn)))
        left_out = _largest(vanishing)
        if strengths[self.joint_rows - many] > LARGEST_DEPENDENT * strengths[0]:
            raise too_many_rows(self.stack, left_out)
        return self._leaving_out(left_out)

    def choice_at(self, placed: Placed, before: Choice) -> Choice:
        """That of a pose, (1,), or the one before, where the rows that it keeps span nearly as much."""
        if not len(before.left_out):
            return before
        vanishing = self._vanishing(Placed(*(of[0] for of in placed)))[0]
        left_out = _largest(vanishing)
        # Rows kept span as much as those left out have part in the combinations that vanish.
        spanned, most = (abs(np.linalg.det(vanishing[rows])) for rows in (before.left_out, left_out))
        return before if spanned >= LEAST_SPANNED * most else self._leaving_out(left_out)

    def _vanishing(self, placed: Placed) -> tuple[Array, Array]:
        """(joint rows, too many) linear combinations of rows of joints that vanish, and singular values."""
        combined, strengths, _ = np.linalg.svd(self.stack.jacobian(placed)[: self.joint_rows])
        return combined[:, self.stack.unknowns - self.stack.count :], strengths

    def _leaving_out(self, rows: Places) -> Choice:
        kept = np.setdiff1d(np.arange(self.stack.count), rows)
        groups = groups_of(self.stack.first[kept], self.stack.second[kept], self._sizes)
        # All rows are read where they are.
        return Choice(kept if len(rows) else slice(None), rows, groups)

    def poses(self, q: Array) -> tuple[Array, Array]:
        """Rotations (..., bodies, 3, 3) and origins (..., bodies, 3), what stands first, at configurations
        (..., 7 * moving bodies)."""
        each = q.reshape(*q.shape[:-1], -1, 7)
        turned = each[..., 3:]
        products = (turned[..., :, None] * turned[..., None, :]).reshape(*turned.shape[:-1], 16)
        rotation, origin = (
            np.empty((*q.shape[:-1], self.bodies, 9)),
            np.zeros((*q.shape[:-1], self.bodies, 3)),
        )
        rotation[...] = AXES.ravel()
        rotation[..., 1:, :] += products @ TURNED
        origin[..., 1:, :] = each[..., :3]
        return rotation.reshape(*origin.shape, 3), origin

    def spread(self, step: Array) -> Array:
        """(..., bodies, 2, 3) [o', w] of unknowns: what is known is zero."""
        every = np.zeros((*step.shape[:-1], 6 * self.bodies))
        every[..., self.columns] = step
        return every.reshape(*step.shape[:-1], self.bodies, 2, 3)

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
        for name, value in zip(self.values, values, strict=True):
            named.setdefault(name, value)
        return named

    def targets(self, values: Array, *rates: Array) -> Array:
        """(1 + rates, ..., rows): what the rows shall equal and its rates, for values (..., values).

        Args:
            rates: (..., values) derivatives of the values, the first, the second and so on.
        """
        series = [of @ self._shares.T for of in (values, *rates)]
        # Of an angle x it is the real part of z = exp(i x), with z' = i x' z, and so on by the product rule.
        turned = [np.exp(1j * series[0])]
        for n in range(1, len(series)):
            turned.append(1j * product_rule(n - 1, (series[n - i] * turned[i] for i in range(n))))
        # Rows know turns up to whole ones, which would cost digits.
        series[0] = np.where(self._turns, np.angle(turned[0]), series[0])
        targets = np.zeros((len(series), *turned[-1].shape[:-1], self.stack.count))
        targets[0] = self.stack.drawn
        for target, angle, value in zip(targets, turned, series, strict=True):
            target[..., self.joint_rows :] = self._factors * np.where(self._cosines, angle.real, value)
        return targets


def groups_of(first: Places, second: Places, sizes: Places) -> list[Group]:
    """Groups of the moving bodies that their rows fix one after the other, each as small as can be.

    The bodies of a group have as many rows among themselves, what stands and the groups before as they have
    freedoms: a driven link alone, then what hangs between such (Assur). A group's determinant changes its
    sign where the assemblies of it meet, and so tells more than that of the Jacobian, which is the product of
    all. With each body as many rows are matched as it has freedoms. A body then waits for all others in its
    own rows, and bodies that wait for each other are a group (Dulmage and Mendelsohn, 1958). Where rows
    cannot be matched, all are one group: some body can still move.

    Args:
        first, second: the two bodies of each row. sizes: freedoms of each body, none of the first.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

    holder = np.repeat(np.arange(len(sizes)), sizes)
    held = csr_array((first[:, None] == holder) | (second[:, None] == holder))
    matched = maximum_bipartite_matching(held, perm_type="column")
    if len(first) != len(holder) or (matched < 0).any():
        return [Group(np.arange(len(first)), np.arange(len(holder)))]
    own = holder[matched]
    waits = np.zeros((len(sizes), len(sizes)), dtype=np.bool_)
    waits[own, first] = waits[own, second] = True
    _, group = connected_components(csr_array(waits), connection="strong")
    return [
        Group(np.flatnonzero(group[own] == one), np.flatnonzero(group[holder] == one))
        for one in np.unique(group[1:])
    ]


def _largest(vanishing: Array) -> Places:
    """Numbers of as many rows as there are combinations, (rows, combinations), with the largest parts."""
    from scipy.linalg import qr

    return np.sort(qr(vanishing.T, mode="r", pivoting=True)[1][: vanishing.shape[1]]).astype(np.intp)


def too_many_rows(stack: RowStack, left_out: Places) -> DescriptionError:
    """The refusal of rows that say something else than the others, by those too many."""
    owners = stack.owners_of(left_out)
    return DescriptionError(
        f"joints and inputs give {stack.count} rows for {stack.unknowns} unknown velocities, and "
        f"{len(left_out)} of them ({', '.join(owners)}) do not follow from the others in the "
        "drawing: the mechanism is held more than once: remove an input, or free a joint",
        owners[0],
        stack.count,
    )
