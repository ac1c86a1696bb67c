"""Proven error bounds against poses refined in rational arithmetic, far beyond the bound's own rounding."""

from collections.abc import Callable, Mapping
from fractions import Fraction
from math import isqrt

import numpy as np
import pytest
from certified import certify_alone
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from sample_cars import SampleCar, by_car

from pointcoord import AssemblyError, Scene, simulate
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import newton_refine
from pointcoord.simulation import scene_mechanism
from pointcoord.solve.assembly import assemble

Array = NDArray[np.float64]
Points = dict[str, tuple[float, float, float]]
BITS = 2**220
N = 17
plain = settings(deadline=None)


def trim(value: Fraction) -> Fraction:
    """Rounded to 220 bits after the point, so that numbers do not grow without end."""
    return Fraction(round(value * BITS), BITS)


def exact_residual(mechanism: Mechanism, y: list[Fraction]) -> list[Fraction]:
    return [
        sum(
            (
                Fraction(p.coefficient) * (y[p.left[0]] - y[p.left[1]]) * (y[p.right[0]] - y[p.right[1]])
                for p in row
            ),
            Fraction(0),
        )
        for row in mechanism.map.rows
    ]


def refine(mechanism: Mechanism, start: Array, known: list[Fraction]) -> list[Fraction]:
    """The assembly near `start` for rational known coordinates, to 200 bits; start must be nearly solved."""
    inverse = [[Fraction(v) for v in row] for row in factorise(mechanism.map.jacobian(start)).preconditioner]
    u = [Fraction(v) for v in start[: mechanism.map.unknowns]]
    for _ in range(30):
        residual = exact_residual(mechanism, u + known)
        step = [
            trim(sum((a * b for a, b in zip(row, residual, strict=True)), Fraction(0))) for row in inverse
        ]
        u = [a - b for a, b in zip(u, step, strict=True)]
        if max(abs(s) for s in step) < Fraction(1, 2**200):
            return u
    raise AssertionError("the refinement does not converge")


def root(value: Fraction) -> Fraction:
    return Fraction(isqrt(int(value * BITS * BITS)), BITS)


def cosine(angle: Fraction) -> Fraction:
    term, total, k = Fraction(1), Fraction(1), 0
    while abs(term) > Fraction(1, 2**210):
        k += 2
        term = trim(-term * angle * angle / (k * (k - 1)))
        total += term
    return total


def square(a: tuple[Fraction, ...], b: tuple[Fraction, ...]) -> Fraction:
    return sum(((p - q) ** 2 for p, q in zip(a, b, strict=True)), Fraction(0))


def cross(a: list[Fraction], b: list[Fraction]) -> list[Fraction]:
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def exact_known(mechanism: Mechanism, points: Points, angle: float, rack: float) -> list[Fraction]:
    """The known coordinates from the user's numbers, without rounding."""
    layout, unit = mechanism.layout, Fraction(float(mechanism.unit))
    first = layout.unknowns
    origin = [Fraction(o) for o in mechanism.origin]
    place = {name: tuple(Fraction(c) for c in p) for name, p in points.items()}
    known = [Fraction(0)] * (layout.size - first)
    known[layout.one - first] = Fraction(1)
    for name in layout.chassis:
        for i, index in enumerate(layout.vector(name)):
            known[index - first] = (place[name][i] - origin[i]) / unit
    known[layout.vector("up")[2] - first] = Fraction(1)
    known[layout.vector("left")[1] - first] = Fraction(-1)
    arm, travel = mechanism.topology.drives
    length = root(square(place[arm.point], place[arm.pivot]))
    known[layout.scalar(arm.coordinate) - first] = length * cosine(Fraction(angle)) / unit
    known[layout.scalar(travel.coordinate) - first] = Fraction(rack) / unit
    for start, end in layout.squared_lengths:
        known[layout.squared_length(start, end) - first] = square(place[start], place[end]) / unit**2
    if mechanism.topology.layout.constants:
        for name, value in exact_axis(place, unit).items():
            known[layout.scalar(name) - first] = value
    return known


def exact_axis(place: dict[str, tuple[Fraction, ...]], unit: Fraction) -> dict[str, Fraction]:
    """The strut axis in the knuckle, and the rod end on it, in the units of the mechanism."""

    def between(start: str, end: str) -> list[Fraction]:
        return [(b - a) / unit for a, b in zip(place[start], place[end], strict=True)]

    axis, scale = between("strut_lower", "strut_top"), Fraction(1)
    length = sum(c * c for c in axis)
    while scale * scale * length >= 1:
        scale /= 2
    while scale * scale * length < Fraction(1, 4):
        scale *= 2
    axis = [scale * c for c in axis]
    e1, e2 = (between("lower_ball_joint", name) for name in ("tie_rod_outer", "strut_lower"))
    frame = [e1, e2, cross(e1, e2)]
    values = dict(
        zip(
            [
                f"strut axis along {part}"
                for part in ("tie_rod_outer", "strut_lower", "normal of the knuckle")
            ],
            components(axis, frame),
            strict=True,
        )
    )
    rod = between("strut_top", "strut_rod_end")
    side = 1 if sum(a * b for a, b in zip(rod, axis, strict=True)) >= 0 else -1
    reach = sum(c * c for c in rod) / sum(c * c for c in axis)
    return values | {"place of strut_rod_end on the strut axis": side * root(reach)}


def components(vector: list[Fraction], frame: list[list[Fraction]]) -> list[Fraction]:
    """The weights of three vectors that give a fourth, by Cramer's rule."""
    volume = triple(*frame)
    return [triple(*(vector if i == j else frame[j] for j in range(3))) / volume for i in range(3)]


def triple(a: list[Fraction], b: list[Fraction], c: list[Fraction]) -> Fraction:
    return sum((p * q for p, q in zip(a, cross(b, c), strict=True)), Fraction(0))


def exact_positions(mechanism: Mechanism, points: Points, u: list[Fraction]) -> dict[str, list[Fraction]]:
    """Moving points and carried ones, mm."""
    unit = Fraction(float(mechanism.unit))
    result = {
        name: [
            u[i] * unit + Fraction(float(o))
            for i, o in zip(mechanism.layout.vector(name), mechanism.origin, strict=True)
        ]
        for name in mechanism.topology.moving
    }

    def frame(place: Mapping[str, list[Fraction]], carriers: tuple[str, str, str]) -> list[list[Fraction]]:
        base, first, second = (place[name] for name in carriers)
        e1, e2 = ([a - b for a, b in zip(p, base, strict=True)] for p in (first, second))
        return [e1, e2, cross(e1, e2)]

    drawn = {name: [Fraction(c) for c in place] for name, place in points.items()}
    for name, carriers in mechanism.topology.carried.items():
        offset = [a - b for a, b in zip(drawn[name], drawn[carriers[0]], strict=True)]
        weights, moved = components(offset, frame(drawn, carriers)), frame(result, carriers)
        result[name] = [
            result[carriers[0]][i] + sum((w * v[i] for w, v in zip(weights, moved, strict=True)), Fraction(0))
            for i in range(3)
        ]
    return result


@by_car
@settings(deadline=None, max_examples=max(8, settings.default.max_examples // 2))
@given(
    angle=st.floats(0.6, 2.6),
    rack=st.floats(-80.0, 120.0),
    shift=st.sampled_from([0.0, 0.1, 12345.678, 1e9]),
    turn=st.floats(-3.0, 3.0),
)
def test_every_point_of_a_pose_lies_within_its_proven_bound(
    make_scene: Callable[..., Scene],
    car: SampleCar,
    angle: float,
    rack: float,
    shift: float,
    turn: float,
) -> None:
    # Turned about the vertical and moved, so that no coordinate is a round number.
    about = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    points = {name: tuple((about @ np.array(p) + shift).tolist()) for name, p in car.points.items()}
    points["tie_rod_inner"] = points["rack_centre"]
    inboard, wheel = points[car.topology.inboard], points[car.topology.wheel_centre]
    side = "left" if wheel[1] < inboard[1] else "right"
    scene = make_scene([angle], [rack], start=0.0, stop=0.0, samples=1, points=points, side=side, car=car)
    try:
        motion = simulate(scene)
    except AssemblyError:
        assume(False)
    proof = motion.proof()
    # Proven twice, with factors of two poses that differ by rounding: both must hold.
    solved = min(float(proof.bound[0]), float(motion.start.bound))
    carried = float(proof.carried_bound[0])
    mechanism = scene_mechanism(scene)
    u = refine(mechanism, motion.start.y, exact_known(mechanism, points, angle, rack))
    for name, exact in exact_positions(mechanism, points, u).items():
        for i in range(3):
            error = abs(Fraction(float(motion.position[name][0, i])) - exact[i])
            assert error <= Fraction(carried if name in car.topology.carried else solved)
    # A bound that is of use: a few thousand roundings of the size of the car and of its distance, unless
    # the pose is near a singular one.
    if float(motion.start.condition) < 1e3:
        assert max(solved, carried) <= 1e5 * np.finfo(float).eps * (1000.0 + shift)


@plain
@given(seed=st.integers(0, 2**32 - 1), power=st.floats(-18.0, -1.0))
def test_distance_of_a_displaced_pose_is_at_most_the_radius_and_the_radius_is_not_far_above_it(
    strut: Mechanism, seed: int, power: float
) -> None:
    pose = assemble(strut, {"arm_angle": np.array(1.2), "rack": np.array(-15.0)})
    exact = refine(strut, pose.y, [Fraction(v) for v in pose.y[N:]])
    y = pose.y.copy()
    y[:N] += 10.0**power * np.random.default_rng(seed).uniform(-1.0, 1.0, size=N)
    certificate = certify_alone(strut.map, y)
    distance = float(max(abs(Fraction(a) - b) for a, b in zip(y[:N], exact, strict=True)))
    # distance is a rounded number: one part in 2^53, below the certificate's own inflation.
    assert distance <= certificate.radius
    if np.isfinite(certificate.radius):
        assert distance <= certificate.unique_within
        # eta <= (1 + omega distance / 2) distance and radius <= 2 eta / (1 - z): below 4 distances where
        # omega distance < 1, plus rounding: |C_u^-1| below 100 times twenty roundings of numbers up to 4.
        assert certificate.radius <= 4.0 * distance + 100 * 20 * 4 * np.finfo(float).eps
    else:
        assert power > -3.0  # so far out that h > 1


def test_nothing_is_proven_where_there_is_nothing_to_prove(strut: Mechanism) -> None:
    pose = assemble(strut, {"arm_angle": np.array(1.2), "rack": np.array(0.0)})
    cases = np.stack([pose.y] * 4)
    cases[1, :N] = np.nan
    cases[2, :N] += 0.5  # nowhere near an assembly
    cases[3, : N - 2] = np.tile(pose.y[:3], 5)  # all moving points at one place: C_u has zero rows
    certificate = certify_alone(strut.map, cases)
    assert np.isfinite(certificate.radius).tolist() == [True, False, False, False]
    assert (certificate.unique_within[1:] == 0.0).all()
    assert certificate.unique_within[0] > 1e-3


def test_a_bound_never_holds_where_no_assembly_exists(strut: Mechanism) -> None:
    # A rack so far away that the tie rod cannot reach it has no assembly: least distance to one is proven
    # nowhere, whatever the pose.
    pose = assemble(strut, {"arm_angle": np.array(np.pi / 2), "rack": np.array(0.0)})
    rng = np.random.default_rng(4)
    y = np.repeat(pose.y[None], 300, axis=0)
    y[:, :N] += rng.normal(size=(300, N)) * np.geomspace(1e-3, 1.0, 300)[:, None]
    y[:, strut.layout.scalar("rack travel")] = 2000.0 / float(strut.unit)
    certificate = certify_alone(strut.map, y)
    assert not np.isfinite(certificate.radius).any()


def test_two_assemblies_never_lie_in_one_ball_of_uniqueness(strut: Mechanism) -> None:
    pose = assemble(strut, {"arm_angle": np.array(1.2), "rack": np.array(0.0)})
    rng = np.random.default_rng(8)
    starts = np.repeat(pose.y[None], 400, axis=0)
    starts[:, :N] += rng.normal(size=(400, N))
    reached = newton_refine(strut.map, starts)
    found = reached.y[reached.converged]
    certificate = certify_alone(strut.map, found)
    found, radius, within = (
        item[np.isfinite(certificate.radius)]
        for item in (found, certificate.radius, certificate.unique_within)
    )
    gaps = np.abs(found[:, None, :N] - found[None, :, :N]).max(axis=-1)
    same = gaps <= radius[:, None] + radius[None]
    assert (~same).any()  # the linkage does have other assemblies for the same inputs
    # Either the same assembly, or outside the ball of the other by at least the error of both.
    assert (gaps[~same] >= (within[:, None] - radius[None])[~same]).all()


@pytest.mark.parametrize(("angle", "rack"), [(np.deg2rad(152.012), 0.0), (np.pi / 2, 130.1)])
def test_bound_grows_towards_the_end_of_the_range_and_still_holds(
    strut: Mechanism, angle: float, rack: float
) -> None:
    # A thousandth of a degree or of a millimetre before the end: distances to it enter as square roots,
    # so the inverse Jacobian has grown by the root of 1e5 at least.
    poses = assemble(strut, {"arm_angle": np.array([1.5, angle]), "rack": np.array([0.0, rack])})
    assert poses.condition[1] > 30 * poses.condition[0]
    assert poses.bound[0] < poses.bound[1] < np.inf
    exact = refine(strut, poses.y[1], [Fraction(v) for v in poses.y[1, N:]])
    distance = float(max(abs(Fraction(a) - b) for a, b in zip(poses.y[1, :N], exact, strict=True)))
    assert distance * float(strut.unit) <= poses.bound[1]
