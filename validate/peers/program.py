r"""A mechanism in another program: the program gives the residuals of the loops, Newton's method closes them.

A program places its bodies from its joints' coordinates q. It gives the gap between the two sides of each
loop, r, and the Jacobian J of r by the joints' rates. With u the unknown and d the driven joints,

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
from collections import Counter
from collections.abc import Sequence

import numpy as np
from scipy.linalg import qr
from scipy.linalg.lapack import dgecon, dgesv
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, maximum_bipartite_matching

from validate.arrays import Array, Flags, Indices, Integers
from validate.errors import NoAnswer
from validate.peers.motion import Poses, Rates
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
FREE = "as many inputs as degrees of freedom, and a drawing that is not singular"


class Program(ABC):
    """A mechanism in a program. It keeps the last pose, so it is not safe for several threads.

    Attributes:
        as_drawn: coordinates of the joints in the drawing.
        driven_at: indices of the driven joints among the coordinates.
        driven, unknown: indices of the driven and of the free joints among the joints' rates.
        rows: the rows that are solved.
        blocks: rows and columns of the diagonal blocks of J_u.
        drawn: signs of the determinants of these blocks as drawn.
        jacobian: J of the last Newton step.
        way: direction of the path at the last pose.
        begun: condition number at the start of the path.
        nearest: the largest condition number on the path, if it is larger than `begun`.
    """

    tree: SpanningTree
    as_drawn: Array
    driven_at: Indices
    driven: Indices
    unknown: Indices
    rows: slice | Integers = slice(None)
    blocks: Sequence[tuple[Integers, Integers]] = ()
    drawn: Array
    jacobian: Array
    way: Array
    begun: float = 1.0
    nearest: float = 1.0

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
    def misses(self) -> tuple[Array, Array]:
        """Place all bodies. The residual of the loops, (rows,), and its Jacobian by the joints' rates."""

    @abstractmethod
    def places(self) -> Array:
        """Place all bodies. The positions of the moving points, (points, 3)."""

    @abstractmethod
    def apart(self, rates: Array, accelerations: Array) -> Array:
        """Relative acceleration of the two sides of the loops, (rows,), for these rates and accelerations of
        the joints at the pose of the last call of `misses`.
        """

    @abstractmethod
    def moving(self, rates: Array, accelerations: Array) -> tuple[Array, Array]:
        """Velocities and accelerations of all moving points, then angular ones of the knuckles, (points +
        knuckles, 3) each; for the same arguments.
        """

    def closed(self, tolerance: float) -> Poses:
        """The drawing, closed at its own inputs: one pose.

        Args:
            tolerance: Newton's method ends with a correction of all joints below it, rad and car sizes.
        Raises:
            NoAnswer: its inputs do not drive the mechanism, or it does not close in the drawn assembly.
        """
        counted, drawn = Counter[str](), self.tree.drawn_inputs
        self.put(self.as_drawn)
        self._at(drawn)
        jacobian = self.misses()[1]
        unknown, count = jacobian[:, self.unknown], len(self.unknown)
        rows = independent_rows(unknown)
        if len(rows) < count:
            words = f"is free to move as drawn: {len(rows)} independent rows for {count} unknowns"
            raise NoAnswer("the mechanism", words, FREE)
        both = np.concatenate([self.unknown, self.driven])
        if len(independent_rows(jacobian[:, both])) > count:
            raise NoAnswer("an input", "does not move the mechanism in addition to the others", FREE)
        self.rows = slice(None) if len(rows) == len(jacobian) else rows
        if count:  # an arm on one hinge, which is driven, has no loop
            # All three rows of a loop: that one of them is zero as drawn may be chance.
            moved = (np.abs(unknown) > TURNED).reshape(-1, 3, count).any(axis=1)
            self.blocks = diagonal_blocks(np.repeat(moved, 3, axis=0)[self.rows])
        self.drawn = self.signs(unknown[self.rows])
        step = self._newton(drawn, tolerance, counted, shorten=True)
        if step is None:
            raise self._refusal("cannot be closed in the drawn assembly", None, drawn, drawn)
        condition, _ = self._folded()
        if not condition < FOLDED:
            raise self._refusal("lies on a fold", None, drawn, drawn)
        return self._named(drawn[None], self.coordinates[None], self.places()[None], [step], counted)

    def poses(self, inputs: Array, tolerance: float, start: Poses) -> Poses:
        """Solve at inputs, each pose from the one before.

        Args:
            inputs: of the drives, (N, drives), rad and the tree's unit.
            tolerance: see `closed`.
            start: the motion from whose last pose the first pose is solved.
        Raises:
            NoAnswer: a pose is not reached without meeting another assembly; `partial` has those before.
        """
        counted, count = Counter[str](), len(inputs)
        coordinates = np.empty((count, start.coordinates.shape[1]))
        places, steps = np.empty((count, len(self.tree.moving), 3)), np.empty(count)
        here = start.inputs[-1]
        self.put(start.coordinates[-1])
        self.jacobian, self.way = self.misses()[1], np.zeros(len(self.unknown) + len(self.driven))

        def refusal(problem: str, i: int, reached: Array) -> NoAnswer:
            error = self._refusal(problem, i, inputs[i], reached)
            error.partial = self._named(inputs, coordinates, places, steps, counted).first(i) if i else None
            return error

        for i in range(count):
            done, step = self._go(here, inputs[i], tolerance, counted)
            if done < 1.0:
                raise refusal("cannot be reached", i, here + done * (inputs[i] - here))
            here, steps[i], places[i], coordinates[i] = inputs[i], step, self.places(), self.coordinates
            if not isinstance(self.rows, slice):
                missed = float(np.abs(self.misses()[0]).max())
                if not missed <= HELD + step**2:
                    words = f"violates closures that are dependent in the drawing by {missed:.3g}"
                    raise refusal(words, i, inputs[i])
        return self._named(inputs, coordinates, places, steps, counted)

    def rates(self, poses: Poses, series: Array) -> Rates:
        """Velocities and accelerations of poses.

        Args:
            series: the input of each drive with two time derivatives, (N or more, drives, 3).
        Raises:
            NoAnswer: the rates are not determined at a pose; `partial` has those before.
        """
        count, names, bodies = len(poses.inputs), list(self.tree.moving), self.tree.knuckles
        first, second = (np.empty((count, len(names) + len(bodies), 3)) for _ in range(2))
        driven = self.tree.coordinates(series[:count])
        for i in range(count):
            self.put(poses.coordinates[i])
            jacobian = self.misses()[1][self.rows]
            velocity, acceleration = (np.zeros(jacobian.shape[1]) for _ in range(2))
            velocity[self.driven], acceleration[self.driven] = driven[i, :, 1], driven[i, :, 2]
            try:
                inverse = np.linalg.inv(jacobian[:, self.unknown])
            except np.linalg.LinAlgError:
                error = self._refusal("is singular", i, poses.inputs[i], poses.inputs[i])
                error.partial = poses.first(i) if i else None
                raise error from None
            velocity[self.unknown] = -inverse @ (jacobian[:, self.driven] @ driven[i, :, 1])
            acceleration[self.unknown] = -inverse @ self.apart(velocity, acceleration)[self.rows]
            first[i], second[i] = self.moving(velocity, acceleration)
        found: Rates = {}
        for quantity, array in (("velocity", first), ("acceleration", second)):
            found[quantity] = {name: array[:, k] for k, name in enumerate(names)}
            found[f"angular_{quantity}"] = {body: array[:, k] for k, body in enumerate(bodies, len(names))}
        return found

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

    def _go(self, start: Array, goal: Array, tolerance: float, counted: Counter[str]) -> tuple[float, float]:
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
            step = self._newton(there, tolerance, counted)
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
        jacobian, count = self.jacobian[self.rows], len(self.unknown)
        if not count:
            return driven, 1.0
        square = jacobian[:, self.unknown]
        factors, _, unknown, info = dgesv(square, -jacobian[:, self.driven] @ driven)
        if info:
            return np.full(count + len(driven), np.nan), np.inf
        inverse, _ = dgecon(factors, float(np.abs(square).sum(axis=0).max()))
        return np.concatenate([unknown, driven]), 1.0 / max(inverse, UNIT_ROUNDOFF)

    def _newton(
        self, inputs: Array, tolerance: float, counted: Counter[str], shorten: bool = False
    ) -> float | None:
        """Close the loops at inputs; the last step, None if it fails.

        Args:
            shorten: whether a step that is too long is shortened; if not, it fails.
        """
        self._at(inputs)
        unknown, previous = self.unknown, np.inf
        if not len(unknown):
            self.jacobian = self.misses()[1]
            return 0.0
        step: Array | None = None
        for number in range(LIMIT):
            missed, jacobian = self.misses()
            self.jacobian = jacobian
            if step is None:
                step = np.zeros(jacobian.shape[1])
            counted.update(factorisations=1, jacobians=1, residuals=1)
            square = jacobian[self.rows][:, unknown]
            _, _, solved, info = dgesv(square, -missed[self.rows])
            if info:
                return None
            step[unknown] = solved
            size = float(np.abs(solved).max())
            if not size <= LONGEST_STEP:
                if not (shorten and np.isfinite(size)):
                    return None
                step *= LONGEST_STEP / size
            elif number == 1 and size > CONTRACTED * previous and size > ROUNDING_STEP and not shorten:
                return None
            self.move(step)
            counted["newton_steps"] += 1
            if size <= tolerance or (size < ROUNDING_STEP and size >= 0.5 * previous):
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

    def _named(
        self,
        inputs: Array,
        coordinates: Array,
        places: Array,
        steps: Sequence[float] | Array,
        counted: Counter[str],
    ) -> Poses:
        named = {name: places[:, k] for k, name in enumerate(self.tree.moving)}
        return Poses(inputs, coordinates, named, np.asarray(steps), dict(counted))


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
