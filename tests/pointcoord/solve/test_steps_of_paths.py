"""Steps of proven paths: as long as their condition allows, and what stops them is told."""

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import SAMPLES

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.solve import assembly
from pointcoord.solve.assembly import Pose, assemble
from pointcoord.solve.follower import follow
from pointcoord.solve.proven_step import ROOM, straight_way

Array = NDArray[np.float64]
MECHANISMS = {car.name: car.mechanism() for car in SAMPLES}
by_mechanism = pytest.mark.parametrize("mechanism", MECHANISMS.values(), ids=MECHANISMS.keys())


def at(mechanism: Mechanism, angle: object, rack: object) -> Pose:
    return assemble(mechanism, {"arm_angle": np.asarray(angle, float), "rack": np.asarray(rack, float)})


def driven(mechanism: Mechanism, y: Array, coordinate: str, by: float) -> Array:
    """Known coordinates of which one is moved."""
    target = y[..., mechanism.layout.unknowns :].copy()
    target[..., mechanism.layout.scalar(coordinate) - mechanism.layout.unknowns] += by
    return target


@by_mechanism
@pytest.mark.parametrize("off", [0.0, 1e-5, 1e-3, 10.0])
def test_a_way_is_proven_where_the_condition_holds_in_one_of_three_norms(
    mechanism: Mechanism, off: float
) -> None:
    pose, rng = at(mechanism, 1.3, 10.0), np.random.default_rng(4)
    system, n, y = mechanism.map, mechanism.layout.unknowns, pose.y.copy()
    y[:n] += off * rng.uniform(-1.0, 1.0, n)
    inverse = np.linalg.inv(system.jacobian(y))
    proven = set()
    for length in (1e-9, 1e-4, 1e-2, 0.3, 3.0):
        target = driven(mechanism, y, "arm_angle rise", length)
        way = straight_way(system, inverse, y, target)
        proof = way.best_proof(system, inverse)
        tangent, lacking = way.tangent, system.residual(y)
        # Newton's way to the target, to rounding.
        assert np.abs(lacking + 2.0 * system.polar(y, tangent)).max() <= 1e-9 * (1.0 + np.abs(tangent).max())
        bend = np.abs(inverse @ system.residual(tangent))
        eta = np.abs(inverse @ lacking) + bend
        turned = np.abs(inverse @ system.jacobian(tangent))
        margins = []
        for plain, much in ((1.0, 0.0), (0.3, 1.0), (0.02, 1.0)):
            g = plain * (bend.max() if much else 1.0) + much * bend
            omega, z = float(system.lipschitz(inverse, g)), float((turned @ g / g).max())
            margins.append(z + float(np.sqrt(2.0 * omega * (eta / g).max())))
        # Rounding of the inverse and of the end of the tangent counts besides.
        assert float(proof.used) == pytest.approx(min(margins), rel=1e-3, abs=1e-6)
        assert bool(proof.holds) == (float(proof.used) <= ROOM)
        proven.add(bool(proof.holds))
    assert proven == ({False} if off > 1.0 else {True, False})


@by_mechanism
@pytest.mark.parametrize("moved", ["arm_angle", "rack"])
def test_the_input_that_goes_on_is_the_one_to_bring_back(mechanism: Mechanism, moved: str) -> None:
    start, held = at(mechanism, 1.5, 20.0), {"arm_angle": 1.5, "rack": 20.0}
    far = {"arm_angle": (0.1, 3.0, 0.01, 3.13), "rack": (1000.0,)}[moved]
    stopped = 0
    for value in far:
        wanted = {**held, moved: value}
        known = mechanism.known_series({name: np.array([v]) for name, v in wanted.items()})[0]
        path = follow(mechanism.map, start.y, known, start.factors)
        if path.done < 1.0:
            stopped += 1
            status = assembly.blocked(mechanism, "no way", path, known, path.done < 1.0, None)
            assert status.reduce == moved
            assert status.wanted == pytest.approx(wanted, abs=1e-9)
    assert stopped > 0


@by_mechanism
@pytest.mark.parametrize("bow", [0.0, 0.05])
@pytest.mark.parametrize("off", [0.0, 1e-3])
def test_a_law_leads_where_the_straight_path_leads(mechanism: Mechanism, bow: float, off: float) -> None:
    """Also from a pose that is not closed: what it lacks is taken back along either path."""
    start, end = at(mechanism, 1.5, 0.0), at(mechanism, 1.2, 20.0)
    n, y = mechanism.layout.unknowns, start.y.copy()
    y[:n] += off * np.random.default_rng(8).uniform(-1.0, 1.0, n)
    first, last = y[n:], end.y[n:]

    def law(members: NDArray[np.intp], shares: Array) -> Array:
        assert set(members.tolist()) == {0}
        share = shares[:, None]
        return np.where(share == 1.0, last, first + (share + bow * share * (1.0 - share)) * (last - first))

    for path in (follow(mechanism.map, y, last), follow(mechanism.map, y, law, longest=0.3)):
        assert path.done == 1.0
        assert np.abs(path.y - end.y).max() <= 4 * np.finfo(float).eps * float(end.condition)
