"""The paper's formulas as printed: which of them hold and which fail, and where."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest

from pointcoord import Scene, SceneError, simulate
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.mechanism import mechanism_file
from pointcoord.mechanism.file import MECHANISMS
from pointcoord.numerics.arrays import Array
from pointcoord.solve.pointwise import square_velocity_term
from validate.paper.printed import (
    PRINTED,
    QUOTIENTS,
    TOPOLOGY,
    PrintedParallel,
    printed_square_velocity_term,
)

PAPER = Scene.load("bounce").mechanism.points
COLLINEAR = mechanism_file("macpherson").topology(PAPER, "collinear")

EPS = np.finfo(float).eps


def quarter_turn(vector: Array) -> Array:
    """Turned by 90 degrees about x, exactly: y becomes z, z becomes -y."""
    x, y, z = np.asarray(vector, dtype=float)
    return np.array([x, -z, y])


def test_printed_term_differs_in_the_rows_of_the_strut_only() -> None:
    system = TOPOLOGY.map
    v = np.random.default_rng(2).normal(size=system.size)
    true, printed = square_velocity_term(system, v), printed_square_velocity_term(system, v)
    strut_rows = [i for i, label in enumerate(TOPOLOGY.labels) if "parallel" in label]
    others = [i for i in range(len(true)) if i not in strut_rows]
    assert np.array_equal(printed[others], true[others])
    assert np.array_equal(printed[strut_rows[:3]], true[strut_rows[:3]] / 2)
    assert printed[strut_rows[3]] == true[strut_rows[1]] / 2  # row 11 repeats row 9


def test_printed_rows_lose_rank_where_the_strut_lies_flat_and_the_slide_does_not() -> None:
    # An upright strut: every point of its axis above the lower ball joint. A quarter turn about x lays it
    # flat exactly.
    points = {name: np.array(p) for name, p in PAPER.items()}
    for name in ("strut_lower", "strut_rod_end", "strut_top"):
        points[name][:2] = points["lower_ball_joint"][:2]
    turned = {name: quarter_turn(p) for name, p in points.items()}
    up, right = quarter_turn([0.0, 0.0, 1.0]), quarter_turn([0.0, 1.0, 0.0])
    flat = build_mechanism(COLLINEAR, turned, {"up": up, "right": right})
    upright = build_mechanism(COLLINEAR, points, {"up": [0.0, 0.0, 1.0], "right": [0.0, 1.0, 0.0]})
    shape = replace(
        TOPOLOGY,
        constraints=tuple(c for c in TOPOLOGY.constraints if isinstance(c, PrintedParallel)),
    )
    z = np.zeros(shape.layout.size)
    for name in (*shape.moving, *shape.chassis):
        z[list(shape.layout.vector(name))] = flat.drawn[list(flat.layout.vector(name))]
    # Two printed rows per pair of lines; flat, both say the same: rank two instead of four.
    singular = np.linalg.svd(shape.map.jacobian(z), compute_uv=False)
    assert singular[1] > 0.1
    assert singular[2] == 0.0
    # The slide has no preferred axis. The turned car's bounding box may give it another unit, half or twice
    # as long, which multiplies the rows of links and the columns of ratios by two.
    conditions = [np.linalg.cond(m.map.jacobian(m.drawn)) for m in (upright, flat)]
    assert conditions[1] <= 4.001 * conditions[0]
    assert any(c.aligned for c in flat.topology.constraints)


def test_printed_quotient_holds_for_a_turn_out_of_the_plane_of_the_points() -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(3, 3))
    omega, alpha = rng.normal(size=(2, 3))
    v = np.cross(omega, points)
    a = np.cross(alpha, points) + np.cross(omega, v)
    names = ("a", "b", "c")
    found = QUOTIENTS.rates(*(dict(zip(names, s, strict=True)) for s in (points, v, a)))
    r = points[2] - points[0]
    for exact, value in zip((omega, alpha), found, strict=True):
        # v65 x v75 = omega (v65 . r75): a few roundings over the cosine that the quotient divides by.
        spread = np.abs(np.cross(exact, points[1] - points[0]) @ r)
        assert np.abs(value - exact).max() <= 200 * EPS * (1 + np.linalg.norm(omega) ** 2) * 30 / spread**2


def with_tables(name: str, **changes: object) -> Scene:
    """A built-in scene that holds its mechanism's tables itself."""
    content = Scene.load(name).model_dump(exclude_none=True)
    part = content["mechanism"]
    part |= tomllib.loads((MECHANISMS / f"{part.pop('type')}.toml").read_text())
    part.pop("driven", None)
    part |= changes
    return Scene.from_mapping(content)


def test_the_papers_strut_is_known_by_its_linkage_and_not_by_its_name() -> None:
    motion, own = simulate(Scene.load("bounce"), PRINTED), simulate(with_tables("bounce"), PRINTED)
    for name, rate in motion.angular_velocity.items():
        assert np.array_equal(rate, own.angular_velocity[name], equal_nan=True)
    with pytest.raises(SceneError, match="cannot solve the macpherson with closure = 'drawn'"):
        simulate(with_tables("off-axis-strut", title="macpherson"), PRINTED)
