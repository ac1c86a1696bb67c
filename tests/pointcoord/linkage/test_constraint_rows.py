"""Every kind of constraint: its rows against its equation, its Jacobian against its own residual."""

import importlib
import inspect
import pkgutil
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.linkage import constraints
from pointcoord.linkage.constraints.constraint import Constraint
from pointcoord.linkage.constraints.contact_height import ContactHeight
from pointcoord.linkage.constraints.ground import Displaced, Ground, TurnedBack
from pointcoord.linkage.constraints.in_body import AxisInBody, Normal, PointInBody
from pointcoord.linkage.constraints.link import Link
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.constraints.scalar_product import KeptTurn, ScalarProduct
from pointcoord.linkage.constraints.turn import Turn
from pointcoord.linkage.layout import Layout
from pointcoord.numerics.quadratic import quadratic_map
from validate.paper.printed import PrintedParallel

Array = NDArray[np.float64]
U = np.finfo(float).eps / 2
LARGEST = 4.0
BODY = Normal("n", "a", "b", "c")
AXIS = AxisInBody("axis", "a", "b", BODY)
HELD = OnLine("c", "d", "axis", "axis", "held", "held", axis=AXIS)
HEIGHT = ScalarProduct("height", ("d", ""), ("e", ""), "drawn height", "travel")
CONTACT = ContactHeight("a", "d", "travel", 0.3)
BACK = TurnedBack("roll", "up", "e", "o", "travel", "sine")
BACK_AGAIN = TurnedBack("pitch", BACK.name, "up", "o", "sine", "travel")
MOVED = Displaced((("travel", "e"), ("sine", "up")))
OVER_GROUND = ContactHeight("b", "c", "travel", 0.3, Ground((BACK, BACK_AGAIN), (MOVED,)))
KEPT = KeptTurn("turn about the line", ("a", "b"), ("c", "d"), "kept product")
LINKS = (Link("a", "b"), Link("a", "o"))
FURTHER = PointInBody("d", "body", BODY)
TURN = Turn("turn", "c", "a", "b", "travel", "sine")
TURN_ON_BODY = Turn("other turn", "d", "a", "b", "travel", "sine", BODY)
WITH_CONSTANTS = (AXIS, HELD, HEIGHT, CONTACT, OVER_GROUND, KEPT, FURTHER, TURN, TURN_ON_BODY, *LINKS)
LAYOUT = Layout(
    moving=("a", "b", "c", "d"),
    ratios=("place", *CONTACT.slides, *OVER_GROUND.slides, *TURN.slides, *TURN_ON_BODY.slides),
    chassis=("o",),
    directions=("e", "up"),
    driven=("travel", "sine"),
    vectors=("n", "axis", *TURN_ON_BODY.vectors, *BACK.vectors, *BACK_AGAIN.vectors, *MOVED.vectors),
    constants=tuple(name for constraint in WITH_CONSTANTS for name in constraint.constants),
)


class Read:
    """y by name."""

    def __init__(self, y: Array) -> None:
        self.y = y

    def __getattr__(self, name: str) -> Array:
        return self.y[list(LAYOUT.vector(name))]

    def scalar(self, name: str) -> float:
        return float(self.y[LAYOUT.scalar(name)])

    def scalars(self, names: Sequence[str]) -> Array:
        return np.array([self.scalar(name) for name in names])

    def in_body(self, names: Sequence[str]) -> Array:
        a, b, c = self.scalars(names)
        return np.asarray(a * (self.b - self.a) + b * (self.c - self.a) + c * self.n)


def vectors(p: Read, constraint: Constraint) -> list[Array]:
    return [p.y[list(LAYOUT.vector(name))] for name in constraint.vectors]


def contact(p: Read) -> Array:
    return lowest(p, CONTACT, p.a, p.d, p.up, 0.0)


def contact_over_ground(p: Read) -> Array:
    (*_, rolled), (*_, pitched), (moved,) = (vectors(p, part) for part in OVER_GROUND.ground.constraints)
    lift = p.o @ (p.up - rolled) + p.o @ (rolled - pitched) + p.up @ moved
    return lowest(p, OVER_GROUND, p.b, p.c, pitched, lift)


def lowest(p: Read, own: ContactHeight, inner: Array, centre: Array, up: Array, lift: float) -> Array:
    rise, reach = p.scalars(own.slides)
    square, share, drawn = p.scalars(own.constants)
    height = centre @ up + lift - share * reach - drawn - p.scalar("travel")
    return np.array([rise - (centre - inner) @ up, rise**2 + reach**2 - square, height])


def turned_back(p: Read, own: TurnedBack, before: Array, axis: Array) -> Array:
    across, aside, after = vectors(p, own)
    cosine, sine = p.scalar(own.cosine), p.scalar(own.sine)
    # Rodrigues' formula by -a, with before - (axis . before) axis = aside.
    turned = after - (cosine * aside + (before - aside) + sine * across)
    return np.concatenate([across - np.cross(before, axis), aside - np.cross(axis, across), turned])


def turned(turn: Turn, v: Array, across: Array, along: Array, p: Read) -> Array:
    alpha, beta = p.scalars(turn.slides)
    row = p.scalar("travel") * alpha - p.scalar("sine") * beta
    return np.array([alpha - v @ across, beta - v @ along, row])


def turned_on_body(p: Read) -> Array:
    across, along = (p.y[list(LAYOUT.vector(name))] for name in TURN_ON_BODY.vectors)
    first, second = TURN_ON_BODY.constants[:3], TURN_ON_BODY.constants[3:]
    rest = (across - p.in_body(first), along - p.in_body(second))
    return np.concatenate([turned(TURN_ON_BODY, p.d - p.a, across, along, p), *rest])


# Each kind with instances and its equation, written as vectors.
CASES: list[tuple[Constraint, Callable[[Read], Array]]] = [
    (LINKS[0], lambda p: np.array([(p.a - p.b) @ (p.a - p.b) - p.scalar(LINKS[0].constants[0])])),
    (LINKS[1], lambda p: np.array([(p.a - p.o) @ (p.a - p.o) - p.scalar(LINKS[1].constants[0])])),
    (
        OnLine("c", "a", "line", "b", "place", between=True),
        lambda p: p.c - p.a - p.scalar("place") * (p.b - p.a),
    ),
    (OnLine("a", "o", "rack", "e", "travel", "driven"), lambda p: p.a - p.o - p.scalar("travel") * p.e),
    (OnLine("o", "a", "axis", "axis", "place", axis=AXIS), lambda p: p.o - p.a - p.scalar("place") * p.axis),
    (HELD, lambda p: p.c - p.d - p.scalar("held") * p.axis),
    (
        ScalarProduct("rise", ("a", "o"), ("e", ""), "", "travel"),
        lambda p: np.array([(p.a - p.o) @ p.e - p.scalar("travel")]),
    ),
    (BODY, lambda p: p.n - np.cross(p.b - p.a, p.c - p.a)),
    (
        AXIS,
        lambda p: (
            p.axis
            - p.scalar("axis along b") * (p.b - p.a)
            - p.scalar("axis along c") * (p.c - p.a)
            - p.scalar("axis along n") * p.n
        ),
    ),
    (HEIGHT, lambda p: np.array([p.d @ p.e - p.scalar(HEIGHT.constants[0]) - p.scalar("travel")])),
    (CONTACT, contact),
    (OVER_GROUND, contact_over_ground),
    (BACK, lambda p: turned_back(p, BACK, p.up, p.e)),
    (BACK_AGAIN, lambda p: turned_back(p, BACK_AGAIN, vectors(p, BACK)[-1], p.up)),
    (MOVED, lambda p: vectors(p, MOVED)[0] - p.scalar("travel") * p.e - p.scalar("sine") * p.up),
    (
        ScalarProduct("distance", ("a", "d"), ("a", "d"), "", "travel"),
        lambda p: np.array([(p.a - p.d) @ (p.a - p.d) - p.scalar("travel")]),
    ),
    (KEPT, lambda p: np.array([(p.a - p.b) @ (p.c - p.d) - p.scalar(KEPT.constants[0])])),
    (FURTHER, lambda p: p.d - p.a - p.in_body(FURTHER.constants)),
    (TURN, lambda p: turned(TURN, p.c - p.a, *p.scalars(TURN.constants).reshape(2, 3), p)),
    (TURN_ON_BODY, turned_on_body),
    (
        PrintedParallel("a", "b", "c", "d"),
        # x component as it is; the second row is minus the y component of the cross product
        lambda p: np.cross(p.b - p.a, p.d - p.c)[:2] * np.array([1.0, -1.0]),
    ),
]


def states() -> st.SearchStrategy[Array]:
    """Coordinates up to LARGEST with the constants 0 and 1 in place."""

    def settle(values: list[float]) -> Array:
        y = np.array(values)
        y[LAYOUT.zero], y[LAYOUT.one] = 0.0, 1.0
        return y

    return st.lists(
        st.floats(-LARGEST, LARGEST, allow_subnormal=False), min_size=LAYOUT.size, max_size=LAYOUT.size
    ).map(settle)


def kinds(of: type[Constraint]) -> set[type[Constraint]]:
    """A kind and those that are made of it, but for what they only share."""
    own = set() if inspect.isabstract(of) else {of}
    return own.union(*(kinds(kind) for kind in of.__subclasses__()))


def test_every_kind_of_constraint_takes_part_in_the_properties_below() -> None:
    for module in pkgutil.iter_modules(constraints.__path__, f"{constraints.__name__}."):
        importlib.import_module(module.name)
    assert {type(constraint) for constraint, _ in CASES} == kinds(Constraint)


@pytest.mark.parametrize(("constraint", "equation"), CASES, ids=lambda case: type(case).__name__)
@settings(deadline=None, max_examples=max(20, settings.default.max_examples // 5))
@given(y=states())
def test_rows_are_the_equation(constraint: Constraint, equation: Callable[[Read], Array], y: Array) -> None:
    rows = constraint.rows(LAYOUT)
    assert len(rows) == len(constraint.labels) == len(set(constraint.labels))
    system = quadratic_map(rows, LAYOUT.unknowns, LAYOUT.size)
    # Four terms of differences up to 2 LARGEST, two evaluations with fewer than 10 roundings each.
    tolerance = 2 * 10 * U * 4 * (2 * LARGEST) ** 2
    assert np.abs(system.residual(y) - equation(Read(y))).max() <= tolerance
