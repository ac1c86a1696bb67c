"""Proven error bounds against poses refined in rational arithmetic, far beyond the bound's own rounding."""

from fractions import Fraction

import numpy as np
from certified import certify_alone
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import newton_refine
from pointcoord.solve.assembly import assemble

Array = NDArray[np.float64]
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
