r"""A mechanism in another program: the program gives the residuals of the loops, Newton's method closes them.

A program places its bodies from its joints' coordinates q. It gives the positions of the two sides of each
loop, r is their difference, and the Jacobian J of r by the joints' rates. With u the unknown and d the driven
joints,

    J_u dq = -r,    J_u v_u = -J_d v_d,    J_u a_u = -J_d a_d - (dJ/dt) v.

The last two terms are the relative acceleration of the two sides of the loops while the unknown joints do not
accelerate; a program gives the acceleration of any point. Rows of J_u that depend on other rows in the
drawing are left out, and their residual is checked in every pose. Two assemblies meet where the determinant
of a diagonal block of J_u is zero, so the signs of these determinants must stay those of the drawing.

From one pose to the next the inputs change along a straight line. A step is accepted if the second Newton
correction is at most a quarter of the first, so that there are poses all along the step (Deuflhard, Newton
Methods for Nonlinear Problems, 2011, ch. 5). Where branches cross, a path that changes to another branch
keeps the sign of the determinant, but has a corner (Allgower and Georg, Numerical Continuation Methods, 1990,
ch. 8). So the direction of the path, (v_u, v_d), may change only little in a step, and a path that came so
near to a singular pose that rounding mixes the branches is not followed further.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

from validate.arrays import Array, Flags, Integers
from validate.errors import NoAnswer
from validate.peers.motion import Motion
from validate.spanning_tree.tree import UNIT_ROUNDOFF, SpanningTree

# Newton's method doubles its correct digits: six steps lead from half a digit to all; twice that is the
# limit.
LIMIT = 12
# rad and car sizes: a longer step may lead to another assembly, so the step of the inputs is halved.
LONGEST_STEP = 0.25
# Halved also if the second step is more than this share of the first: then a pose nearby is not certain.
CONTRACTED = 0.25
# Greatest difference between the directions at the two ends of a step, relative to the larger one.
CORNER = 0.5
# At the condition number C crossing branches are 1 / C apart, and rounding U moves a pose by U C: above an
# eighth of the inverse root of U a corner between them is not seen.
BLURRED = 2.0**23
HALVINGS = 44
# Car sizes. The residual of a dependent row is the square of the last step plus the rounding multiplied by
# the condition number, some 1e-13 of the car.
HELD = 1e-11
# A step below the root of the rounding unit that does not halve is rounding.
ROUNDING_STEP = 1e-8
# At a fold a rounding U moves the pose by sqrt(U): above this condition number its two sides look the same.
FOLDED = 2.0**26
# Share of a row's length: the rounding of an entry for a joint that does not move the loop.
TURNED = 1e-14
# Rows that are dependent apart from the rounding of points, some 1e-15 of the car, have a remainder of that
# size. A mechanism that a rounding moves by 1e-9 of the car is singular for every use.
DEPENDENT = 1e-9
State = tuple[Array, Array, Array, float]
"""A pose: as in `Motion`, the joints' coordinates, the linear and the angular part, and the last step."""
FREE = "as many inputs as degrees of freedom, and a drawing that is not singular"


class Program(ABC):
    """A mechanism in a program. It keeps the last pose, so it is not safe for several threads.

    Attributes:
        points, ends, bodies: which sites (see `SpanningTree.sites`) are moving points, first and then second
            sides of the loops, and origins of the knuckles.
        as_drawn: coordinates of the joints in the drawing.
        driven_at: indices of the driven joints among the coordinates.
        driven, unknown: indices of the driven and of the free joints among the joints' rates.
        rows: the rows that are solved.
        blocks: rows and columns of the diagonal blocks of J_u.
        drawn: signs of the determinants of these blocks as drawn.
        tolerance: limit of the last correction in the present call of `closed` or `motion`.
        jacobian: J of the last Newton step.
        way: direction of the path at the last pose.
        begun: condition number at the start of the path.
        nearest: the largest condition number on the path, if it is larger than `begun`.
    """

    rows: Integers
    blocks: Sequence[tuple[Integers, Integers]] = ()
    drawn: Array
    tolerance: float
    jacobian: Array
    way: Array
    begun: float = 1.0
    nearest: float = 1.0

    def __init__(self, tree: SpanningTree, rates: int, rods_spin: bool = True) -> None:
        """Number the joints of a program's model, which is made before.

        Args:
            rates: number of rates of all joints.
            rods_spin: whether the joint of a rod has three rates, the last one about the rod.
        """
        self.tree, self.as_drawn = tree, self.coordinates
        first = len(tree.moving)
        last = first + 2 * len(tree.loops)
        self.points, self.ends, self.bodies = slice(first), slice(first, last), slice(last, None)
        driven = np.array([self.joint(driven.body) for driven in tree.driven], dtype=np.intp)
        self.driven_at, self.driven = driven.reshape(-1, 2).T
        # The spin of a rod has no effect: its rate is fixed at 0.
        idle = [self.joint(rod)[1] + 2 for rod in tree.rods] if rods_spin else []
        self.unknown = np.setdiff1d(np.arange(rates), [*self.driven, *idle])

    @abstractmethod
    def joint(self, body: str) -> tuple[int, int]:
        """Index of the first coordinate and of the first rate of the joint that carries a body."""

    @property
    @abstractmethod
    def coordinates(self) -> Array:
        """A copy of the joints' coordinates."""

    @abstractmethod
    def put(self, coordinates: Array) -> None:
        """Set all joints."""

    @abstractmethod
    def move(self, step: Array) -> None:
        """Move all joints by a small step, as their rates would in a unit of time."""

    @abstractmethod
    def positions(self, which: slice) -> Array:
        """Place all bodies. The positions of some sites, (sites, 3)."""

    @abstractmethod
    def gap_jacobian(self) -> Array:
        """Place all bodies. The derivative of first - second of each loop by the rates, (rows, rates)."""

    @abstractmethod
    def set_rates(self, rates: Array, accelerations: Array) -> None:
        """Set rates and accelerations of the joints at the pose of the last call of `gap_jacobian`."""

    @abstractmethod
    def rates_of(self, which: slice, order: int) -> Array:
        """Linear and angular velocity of some sites, or their accelerations for order 2, (sites, 2, 3)."""

    def misses(self) -> tuple[Array, Array]:
        """The residual of the loops, (rows,), and its Jacobian by the joints' rates."""
        return _apart(self.positions(self.ends)), self.gap_jacobian()

    def apart(self, rates: Array, accelerations: Array) -> Array:
        """Relative acceleration of the two sides of the loops, (rows,), for these rates of the joints."""
        self.set_rates(rates, accelerations)
        return _apart(self.rates_of(self.ends, 2)[:, 0])

    def closed(self, tolerance: float) -> Motion:
        """The drawing, closed at its own inputs: one pose, at rest.

        Args:
            tolerance: Newton's method ends with a correction of all joints below it, rad and car sizes.
        Raises:
            NoAnswer: its inputs do not drive the mechanism, or it does not close in the drawn assembly.
        """
        self.tolerance, drawn = tolerance, self.tree.drawn_inputs
        self.put(self.as_drawn)
        self._at(drawn)
        jacobian = self.misses()[1]
        unknown, count = jacobian[:, self.unknown], len(self.unknown)
        rows = independent_rows(unknown)
        if len(rows) < count:
            words = f"is free to move as drawn: {len(rows)} independent rows for {count} unknowns"
            raise NoAnswer("the mechanism", words, FREE)
        if len(independent_rows(jacobian[:, [*self.unknown, *self.driven]])) > count:
            raise NoAnswer("an input", "does not move the mechanism in addition to the others", FREE)
        self.rows = rows
        if count:  # an arm on one hinge, which is driven, has no loop
            # All three rows of a loop: that one of them is zero as drawn may be chance.
            moved = (np.abs(unknown) > TURNED).reshape(-1, 3, count).any(axis=1)
            self.blocks = diagonal_blocks(np.repeat(moved, 3, axis=0)[self.rows])
        self.drawn = self.signs(unknown[self.rows])
        step = self._newton(drawn, shorten=True)
        if step is None:
            raise self._refusal("cannot be closed in the drawn assembly", None, drawn, drawn)
        condition, _ = self._folded()
        if not condition < FOLDED:
            raise self._refusal("lies on a fold", None, drawn, drawn)
        return _in_series(drawn[None], [self._state(step)])

    def motion(self, series: Array, tolerance: float, start: Motion, moves: bool = True) -> Motion:
        """Solve at inputs, each pose from the one before.

        Args:
            series: the input of each drive with two time derivatives, (N, drives, 3), rad and the unit.
            tolerance: see `closed`.
            start: the motion from whose last pose the first pose is solved.
            moves: whether velocities and accelerations are computed.
        Raises:
            NoAnswer: a pose is not reached without meeting another assembly, or its rates are not determined;
                `partial` has those before.
        """
        self.tolerance, inputs, here = tolerance, series[..., 0], start.inputs[-1]
        self.put(start.coordinates[-1])
        self.jacobian, self.way = self.misses()[1], np.zeros(len(self.unknown) + len(self.driven))
        driven = self.tree.coordinates(series)
        found: list[State] = []

        def refusal(problem: str, reached: Array) -> NoAnswer:
            error = self._refusal(problem, len(found), inputs[len(found)], reached)
            error.partial = _in_series(inputs, found) if found else None
            return error

        for wanted, rates in zip(inputs, driven, strict=True):
            done, step = self._go(here, wanted)
            if done < 1.0:
                raise refusal("cannot be reached", here + done * (wanted - here))
            here = wanted
            if len(self.rows) < 3 * len(self.tree.loops):
                missed = float(np.abs(self.misses()[0]).max())
                if not missed <= HELD + step**2:
                    words = f"violates closures that are dependent in the drawing by {missed:.3g}"
                    raise refusal(words, wanted)
            try:
                found.append(self._state(step, rates if moves else None))
            except np.linalg.LinAlgError:
                raise refusal("is singular", wanted) from None
        return _in_series(inputs, found)

    def _state(self, step: float, driven: Array | None = None) -> State:
        """The present pose, and its rates.

        Args:
            step: the last correction of Newton's method.
            driven: the driven coordinates with two time derivatives, (drives, 3); None for no rates.
        Raises:
            LinAlgError: the rates are not determined.
        """
        orders = 1 if driven is None else 3
        linear = np.empty((orders, len(self.tree.moving), 3))
        angular = np.empty((orders - 1, len(self.tree.knuckles), 3))
        linear[0] = self.positions(self.points)
        if driven is not None:
            jacobian = self.misses()[1][self.rows]
            velocity, acceleration = (np.zeros(jacobian.shape[1]) for _ in range(2))
            velocity[self.driven], acceleration[self.driven] = driven[:, 1], driven[:, 2]
            inverse = np.linalg.inv(jacobian[:, self.unknown])
            velocity[self.unknown] = -inverse @ (jacobian[:, self.driven] @ driven[:, 1])
            acceleration[self.unknown] = -inverse @ self.apart(velocity, acceleration)[self.rows]
            self.set_rates(velocity, acceleration)
        for order in range(1, orders):
            linear[order] = self.rates_of(self.points, order)[:, 0]
            angular[order - 1] = self.rates_of(self.bodies, order)[:, 1]
        return self.coordinates, linear, angular, step

    def signs(self, jacobian: Array) -> Array:
        """Signs of the determinants of the diagonal blocks of J_u, (blocks,)."""
        return np.array(
            [np.linalg.slogdet(jacobian[rows[:, None], columns])[0] for rows, columns in self.blocks]
        )

    def _at(self, inputs: Array) -> None:
        """Set the driven joints to inputs, (drives,)."""
        series = np.stack([inputs, *np.zeros((2, len(inputs)))], axis=-1)
        coordinates = self.coordinates
        coordinates[self.driven_at] = self.tree.coordinates(series)[:, 0]
        self.put(coordinates)

    def _go(self, start: Array, goal: Array) -> tuple[float, float]:
        """Follow the inputs to a goal, by halves where Newton's method would step too far.

        Returns:
            The share of the path that was followed, and the last step.
        """
        done, share, last = 0.0, 1.0, 0.0
        way, condition = self._way(start, goal - start)
        if not way @ self.way > 0.0:  # the path begins, or turns back
            self.begun, self.nearest = condition, 1.0
        self.way = way
        while done < 1.0:
            kept, share = self.coordinates, min(share, 1.0 - done)
            there = start + (done + share) * (goal - start) if done + share < 1.0 else goal
            step = self._newton(there)
            if step is not None:
                way, condition = self._way(there, goal - start)
            if step is None or self._turns_off(way, condition):
                self.put(kept)
                share *= 0.5
                if share < 0.5**HALVINGS:
                    break
            else:
                done, last, share = done + share, step, 2.0 * share
                self.way = way
                if condition > self.begun:
                    self.nearest = max(condition, self.nearest)
        return done, last

    def _turns_off(self, way: Array, condition: float) -> bool:
        """Whether the path may have changed to another branch since the last pose."""
        largest = max(float(np.abs(each).max(initial=0.0)) for each in (way, self.way))
        corner = not np.abs(way - self.way).max(initial=0.0) <= CORNER * largest
        return corner or (self.nearest > BLURRED and condition < 0.5 * self.nearest)

    def _way(self, inputs: Array, rates: Array) -> tuple[Array, float]:
        """Rates of the joints at the last Newton step, (unknown + driven,), for these rates of the inputs.

        Returns:
            The rates, NaN at a singular pose, and the condition number of J_u.
        """
        driven = self.tree.coordinates(np.stack([inputs, rates, np.zeros(len(rates))], axis=-1))[:, 1]
        jacobian = self.jacobian[self.rows]
        square = jacobian[:, self.unknown]
        try:
            unknown = np.linalg.solve(square, -jacobian[:, self.driven] @ driven)
            condition = float(np.linalg.cond(square, 1)) if len(unknown) else 1.0
        except np.linalg.LinAlgError:
            return np.full(len(self.unknown) + len(driven), np.nan), np.inf
        return np.concatenate([unknown, driven]), min(condition, 1.0 / UNIT_ROUNDOFF)

    def _newton(self, inputs: Array, shorten: bool = False) -> float | None:
        """Close the loops at inputs; the last step, None if it fails.

        Args:
            shorten: whether a step that is too long is shortened; if not, it fails.
        """
        self._at(inputs)
        previous = np.inf
        for number in range(LIMIT):
            missed, self.jacobian = self.misses()
            step = np.zeros(self.jacobian.shape[1])
            square = self.jacobian[self.rows][:, self.unknown]
            try:
                step[self.unknown] = np.linalg.solve(square, -missed[self.rows])
            except np.linalg.LinAlgError:
                return None
            size = float(np.abs(step).max())
            if not size <= LONGEST_STEP:
                if not (shorten and np.isfinite(size)):
                    return None
                step *= LONGEST_STEP / size
            elif number == 1 and size > CONTRACTED * previous and size > ROUNDING_STEP and not shorten:
                return None
            self.move(step)
            if size <= self.tolerance or (size < ROUNDING_STEP and size >= 0.5 * previous):
                return size if (self.signs(square) == self.drawn).all() else None
            previous = size
        return None

    def _folded(self) -> tuple[float, tuple[str, ...]]:
        """Condition number of J_u at this pose, and the parts that lock each other if it is nearly singular.

        The multipliers u of the rows, with u J_u = 0 nearly, load the drives by u J_d. The parts with more
        than half of the largest share are named, the strongest first.
        """
        jacobian = self.misses()[1][self.rows]
        if not len(self.unknown):
            return 1.0, ()
        left, sizes, _ = np.linalg.svd(jacobian[:, self.unknown])
        share = np.abs(np.concatenate([left[:, -1], left[:, -1] @ jacobian[:, self.driven]]))
        of_rows = np.repeat([loop.name for loop in self.tree.loops], 3)[self.rows]
        names = [*of_rows.tolist(), *(driven.input for driven in self.tree.driven)]
        order = np.argsort(-share, kind="stable")
        strong = [names[k] for k in order if share[k] > 0.5 * share[order[0]]]
        with np.errstate(divide="ignore"):
            return float(sizes[0] / sizes[-1]), tuple(dict.fromkeys(strong))

    def _refusal(self, problem: str, instant: int | None, wanted: Array, reached: Array) -> NoAnswer:
        """Why a pose is not reached, judged at the pose that was solved last."""
        condition, links = self._folded()
        asked, last = self.tree.named(wanted), self.tree.named(reached)
        each = (", ".join(f"{name} = {value:.10g}" for name, value in one.items()) for one in (asked, last))
        return NoAnswer(
            "the drawing" if instant is None else f"instant number {instant}",
            f"{problem}, because {' and '.join(', '.join(links).rsplit(', ', 1))} lock each other: wanted "
            f"{'; reached '.join(each)}, where the condition number is {condition:.3g}",
            "inputs before that pose, or other hardpoints",
            name="",
            instant=instant,
            wanted=asked,
            reached=last,
            condition=condition,
            links=links,
        )


def _in_series(inputs: Array, states: Sequence[State]) -> Motion:
    """The motion of the first poses at these inputs."""
    return Motion(inputs[: len(states)], *map(np.array, zip(*states, strict=True)))


def _apart(ends: Array) -> Array:
    """First minus second side of each loop, (rows,), from vectors of all first and then all second sides."""
    first, second = ends.reshape(2, -1)
    return np.asarray(first - second)


def independent_rows(jacobian: Array) -> Integers:
    """A largest set of independent rows of a Jacobian (rows, columns), in increasing order.

    Rows are chosen by pivoting (Golub and Van Loan, Matrix Computations, 5.4.2), so the rows left out are
    those that depend most on the others.
    """
    if not jacobian.size:
        return np.zeros(0, dtype=np.int64)
    _, triangle, order = qr(jacobian.T, mode="economic", pivoting=True)
    count = int((np.abs(np.diag(triangle)) > DEPENDENT).sum())
    return np.sort(order[:count]).astype(np.int64)


def diagonal_blocks(pattern: Flags) -> list[tuple[Integers, Integers]]:
    """Rows and columns of the diagonal blocks of a square pattern in block triangular form.

    The determinant of the matrix is the product of those of the blocks (Duff and Reid, ACM Transactions on
    Mathematical Software 4, 1978).
    """
    row_of = maximum_bipartite_matching(csr_matrix(pattern), perm_type="row")
    count, label = connected_components(csr_matrix(pattern[row_of]), directed=True, connection="strong")
    members = [np.flatnonzero(label == k) for k in range(count)]
    return [(np.asarray(row_of[columns], dtype=np.int64), columns) for columns in members]
