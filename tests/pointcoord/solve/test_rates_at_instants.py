"""The paper's algorithm at instants, and its formulas as printed: which of them hold and which fail."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from pointcoord import Motion, Scene, UnknownName, simulate
from pointcoord.linkage.constraints.on_line import OnLine
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.method import NEWTON, SERIES, Method
from pointcoord.numerics.newton import polish
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.solve.pointwise import square_velocity_term
from pointcoord.suspensions.macpherson import COLLINEAR
from validate.paper.printed import PRINTED, TOPOLOGY, PrintedQuotients, printed_square_velocity_term
from validate.paper.printed_parallel import PrintedParallel

Array = NDArray[np.float64]
Points = dict[str, tuple[float, float, float]]
EPS = np.finfo(float).eps
METHODS = (SERIES, NEWTON, PRINTED)
STEER = {"arm_angle": (np.pi / 2,), "rack": (0.0, 150.0, 25.0), "stop": 0.4}


def quarter_turn(vector: Array) -> Array:
    """Turned by 90 degrees about x, exactly: y becomes z, z becomes -y."""
    x, y, z = np.asarray(vector, dtype=float)
    return np.array([x, -z, y])


def cars(points: dict[str, Array], up: Array, right: Array) -> dict[str, Mechanism]:
    axes = {"up": up, "right": right}
    return {
        "slide": build_mechanism(COLLINEAR, points, axes),
        "printed": build_mechanism(TOPOLOGY, points, axes),
    }


def pose_of(mechanism: Mechanism, angle: float = 1.5) -> Pose:
    return assemble(mechanism, {"arm_angle": np.array(angle), "rack": np.array(0.0)})


@pytest.mark.parametrize("method", METHODS, ids=str)
def test_velocity_is_the_derivative_of_the_position(make_scene: Callable[..., Scene], method: Method) -> None:
    h = 2.0**-10
    motion = simulate(make_scene(rack=(0.0, 20.0), start=0.5, stop=0.5 + 8 * h, samples=9), method)
    bound = float(motion.proof().bound.max())
    for name, p in motion.position.items():
        # Central differences of order 8 over the nine instants: no truncation is left at this step (the
        # ninth derivative is below 1e9 mm / s^9, times h^8); rounding: the weights sum to 2.1.
        weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
        tolerance = 1e9 * h**8 + 2.1 * 2 * bound / h + 2.1 * 1e-9 * method.by_series / h * 1e-3
        assert np.abs(weights @ p / h - motion.velocity[name][4]).max() <= tolerance


def acceleration_gap(motion: Motion, h: float) -> float:
    weights = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
    return max(
        float(np.abs(weights @ v / h - motion.acceleration[n][4]).max()) for n, v in motion.velocity.items()
    )


def test_acceleration_is_the_derivative_of_the_velocity_and_the_printed_one_is_not(
    make_scene: Callable[..., Scene],
) -> None:
    h = 2.0**-10
    gaps = {
        method.name: acceleration_gap(
            simulate(make_scene(rack=(0.0, 20.0), start=0.5, stop=0.5 + 8 * h, samples=9), method), h
        )
        for method in METHODS
    }
    # Velocities up to 400 mm/s with the rounding of two solves, condition number below 100 and 4000 for the
    # two formulations, over h; no truncation is left.
    tolerance = 2.1 * 64 * EPS * 400.0 * 4000.0 / h
    assert gaps[SERIES.name] <= tolerance
    assert gaps[NEWTON.name] <= tolerance
    # Eq. (23) lacks a factor of two and repeats a row: off by more than any rounding.
    assert gaps[PRINTED.name] > 1e3 * tolerance
    assert gaps[PRINTED.name] > 1.0  # mm/s^2


def test_square_velocity_term_is_the_second_difference_of_the_constraints(strut: Mechanism) -> None:
    rng = np.random.default_rng(1)
    y, v = rng.integers(-50, 50, size=(2, strut.layout.size)).astype(float)
    bend = strut.map.residual(y + v) - 2.0 * strut.map.residual(y) + strut.map.residual(y - v)
    # A quadratic's second difference is its second derivative, exact for whole numbers.
    assert np.array_equal(square_velocity_term(strut.map, v), bend)


def test_printed_term_differs_in_the_rows_of_the_strut_only(table: Points) -> None:
    system = TOPOLOGY.map
    v = np.random.default_rng(2).normal(size=system.size)
    true, printed = square_velocity_term(system, v), printed_square_velocity_term(system, v)
    strut_rows = [i for i, label in enumerate(TOPOLOGY.labels) if "parallel" in label]
    others = [i for i in range(len(true)) if i not in strut_rows]
    assert np.array_equal(printed[others], true[others])
    assert np.array_equal(printed[strut_rows[:3]], true[strut_rows[:3]] / 2)
    assert printed[strut_rows[3]] == true[strut_rows[1]] / 2  # row 11 repeats row 9


def test_printed_formulation_has_the_same_positions_and_velocities(make_scene: Callable[..., Scene]) -> None:
    scene = make_scene(rack=(0.0, 20.0))
    newton, printed = simulate(scene, "newton"), simulate(scene, PRINTED)
    one, other = newton.proof(), printed.proof()
    for name in newton.position:
        gap = np.abs(newton.position[name] - printed.position[name]).max(axis=-1)
        assert (gap <= one.bound + other.bound).all()
        # The pose's error times its proven effect, and the rounding of one solve each. A carried point
        # moves up to 30 times as fast as its carriers (its weights).
        speed = np.abs(newton.velocity[name]).max()
        rounding = 64 * EPS * (one.condition + other.condition) * speed
        sensitive = one.velocity_sensitivity * one.bound + other.velocity_sensitivity * other.bound
        assert (
            np.abs(newton.velocity[name] - printed.velocity[name]).max(axis=-1) <= 30 * (sensitive + rounding)
        ).all()


@pytest.mark.parametrize("vertical", [True, False], ids=["strut upright", "strut of the paper laid flat"])
def test_printed_rows_lose_rank_where_the_strut_lies_flat_and_the_slide_does_not(
    table: Points, strut: Mechanism, vertical: bool
) -> None:
    points = {name: np.array(p) for name, p in table.items()}
    if vertical:
        # An upright strut: every point of its axis above the lower ball joint. A quarter turn about x
        # then lays it flat exactly.
        for name in ("strut_lower", "strut_rod_end", "strut_top"):
            points[name][:2] = points["lower_ball_joint"][:2]
        turned = {name: quarter_turn(p) for name, p in points.items()}
        up, right = quarter_turn([0.0, 0.0, 1.0]), quarter_turn([0.0, 1.0, 0.0])
        flat = build_mechanism(COLLINEAR, turned, {"up": up, "right": right})
        upright = build_mechanism(COLLINEAR, points, {"up": [0.0, 0.0, 1.0], "right": [0.0, 1.0, 0.0]})
        y, tolerance = flat.drawn, 0.0
    else:
        # The assembled strut of the paper, turned about x until its axis has no z component.
        upright, pose = strut, pose_of(strut)
        axis = np.subtract(*(pose.y[list(strut.layout.vector(n))] for n in ("strut_rod_end", "strut_top")))
        c, s = np.array([axis[1], -axis[2]]) / np.hypot(axis[1], axis[2])
        about = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])
        turned = {name: about @ p for name, p in points.items()}
        flat = build_mechanism(COLLINEAR, turned, {"up": about[:, 2], "right": about[:, 1]})
        pose = pose_of(flat)
        # The axis is flat up to the rounding of the turn and of the pose.
        y, tolerance = pose.y, 16 * EPS + 4 * float(pose.bound / flat.unit)
    shape = replace(
        TOPOLOGY,
        constraints=tuple(c for c in TOPOLOGY.constraints if isinstance(c, PrintedParallel)),
    )
    z = np.zeros(shape.layout.size)
    for name in (*shape.moving, *shape.chassis):
        z[list(shape.layout.vector(name))] = y[list(flat.layout.vector(name))]
    # Two printed rows per pair of lines; flat, both say the same: rank two instead of four.
    singular = np.linalg.svd(shape.map.jacobian(z), compute_uv=False)
    assert singular[1] > 0.1
    assert singular[2] <= 8 * tolerance
    # The slide has no preferred axis. The turned car's bounding box may give it another unit, half or twice
    # as long, which multiplies the rows of links and the columns of ratios by two.
    conditions = [
        np.linalg.cond(m.map.jacobian(pose_of(m).y if not vertical else m.drawn)) for m in (upright, flat)
    ]
    assert conditions[1] <= 4.001 * conditions[0]
    assert any(isinstance(c, OnLine) for c in flat.topology.constraints)


def test_printed_quotient_fails_in_the_steering_scene_and_least_squares_do_not(
    make_scene: Callable[..., Scene],
) -> None:
    scene = make_scene(**STEER, samples=81)
    ours, printed = simulate(scene, "newton"), simulate(scene, PRINTED)
    omega = ours.angular_velocity["knuckle"]
    # The arm stands still, so the knuckle turns about the steering axis through points 5 and 4.
    axis = ours.position["strut_top"] - ours.position["lower_ball_joint"]
    axis /= np.linalg.norm(axis, axis=-1, keepdims=True)
    across = np.linalg.norm(np.cross(omega, axis), axis=-1)
    size = np.linalg.norm(omega, axis=-1)
    # Points 5 and 7 are 60 mm apart: their velocities' rounding over that length.
    assert (across <= 1e-9 * size).all()
    assert size[0] == pytest.approx(1.46, abs=0.005)
    assert (np.diff(size) > 0.0).all()
    # The printed columns: not a number, or noise of the size of the numbers themselves.
    noisy = printed.angular_velocity["knuckle"]
    with np.errstate(invalid="ignore"):
        wrong = ~(np.linalg.norm(noisy - omega, axis=-1) <= 0.1 * size)
    assert wrong.mean() > 0.9
    assert any("not a number" in note and "angular velocity" in note for note in printed.notes) == bool(
        (~np.isfinite(noisy)).any()
    )
    assert ours.notes == (ours.closing.words,)


def test_printed_quotient_holds_for_a_turn_out_of_the_plane_of_the_points() -> None:
    rng = np.random.default_rng(3)
    points = rng.normal(size=(3, 3))
    omega, alpha = rng.normal(size=(2, 3))
    v = np.cross(omega, points)
    a = np.cross(alpha, points) + np.cross(omega, v)
    names = ("a", "b", "c")
    found = PrintedQuotients().rates(*(dict(zip(names, s, strict=True)) for s in (points, v, a)))
    r = points[2] - points[0]
    for exact, value in zip((omega, alpha), found, strict=True):
        # v65 x v75 = omega (v65 . r75): a few roundings over the cosine that the quotient divides by.
        spread = np.abs(np.cross(exact, points[1] - points[0]) @ r)
        assert np.abs(value - exact).max() <= 200 * EPS * (1 + np.linalg.norm(omega) ** 2) * 30 / spread**2


def test_unknown_method_is_refused_with_the_methods_that_exist(make_scene: Callable[..., Scene]) -> None:
    with pytest.raises(UnknownName, match="series, newton"):
        simulate(make_scene(), "newtom")


def test_newton_at_every_instant_ends_at_rounding(make_scene: Callable[..., Scene], strut: Mechanism) -> None:
    motion = simulate(make_scene(rack=(0.0, 20.0), samples=21, effects=()), "newton")
    proof = motion.proof()
    # eps times the condition number times the size of the car, with a margin of the row sums.
    assert (proof.bound <= 64 * EPS * proof.condition * float(strut.unit)).all()
    again = polish(strut.map, motion.start.y)
    assert again.first_step <= motion.start.bound


@pytest.mark.parametrize("method", ["series", "newton"])
@pytest.mark.parametrize("short", [1e-5, 1e-8])
def test_rates_near_a_lock_are_those_of_the_pose_that_is_reported(
    make_scene: Callable[..., Scene], strut: Mechanism, method: Method, short: float
) -> None:
    # A Jacobian of Newton's last but one place, off by more than the pose's error, gave velocities that
    # stretched the links of the reported pose.
    scene = make_scene((np.pi / 2,), (0.0, 130.10076831981567 * (1 - short)), stop=1.0, samples=2)
    motion = simulate(scene, method)
    p, v = motion.position, motion.velocity
    fast = max(np.abs(v[name]).max() for name in strut.layout.moving)
    for start, end in strut.layout.squared_lengths:
        stretch = (p[start][-1] - p[end][-1]) @ (v[start][-1] - v[end][-1])
        # r . v = 0 for every link. LU leaves some eps of the matrix times the solution, here 8; both factors
        # are rounded, coordinates up to 600 mm; three products.
        assert abs(stretch) <= 16 * EPS * 600.0 * 3 * fast
