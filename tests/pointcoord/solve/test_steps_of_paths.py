"""Steps of proven paths: as long as their condition allows, and what stops them is told."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray
from sample_cars import SAMPLES

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.linear import factorise
from pointcoord.solve import assembly
from pointcoord.solve.assembly import Pose, assemble, follow, proven_step

Array = NDArray[np.float64]
MECHANISMS = {car.name: car.mechanism() for car in SAMPLES}
by_mechanism = pytest.mark.parametrize("mechanism", MECHANISMS.values(), ids=MECHANISMS.keys())


def at(mechanism: Mechanism, angle: object, rack: object) -> Pose:
    return assemble(mechanism, {"arm_angle": np.asarray(angle, float), "rack": np.asarray(rack, float)})


@by_mechanism
@pytest.mark.parametrize("off", [1e-5, 1e-3, 10.0])
def test_a_step_from_a_place_that_is_off_is_as_long_as_its_condition_allows(
    mechanism: Mechanism, off: float
) -> None:
    pose, rng = at(mechanism, 1.3, 10.0), np.random.default_rng(4)
    system, n, factors = mechanism.map, mechanism.layout.unknowns, pose.factors
    tangent, correction = np.zeros(system.size), np.zeros(system.size)
    tangent[mechanism.layout.scalar("arm_angle rise")] = 0.5
    tangent[:n] = -factors.solve(2.0 * system.polar(pose.y, tangent))
    correction[:n] = off * rng.uniform(-1.0, 1.0, n)
    inverse = np.linalg.inv(system.jacobian(pose.y))

    def bent(rows: Array) -> Array:
        return np.asarray(np.abs(inverse @ rows))

    bend, own = bent(system.residual(tangent)), bent(system.residual(correction))
    both = bent(2.0 * system.polar(correction, tangent))

    def holds(s: float) -> bool:
        """The condition, in any of the three norms."""
        for plain, much in ((1.0, 0.0), (0.3, 1.0), (0.02, 1.0)):
            g = plain * (bend.max() if much else 1.0) + much * bend
            omega = float(system.lipschitz(inverse, g))
            z = float((np.abs(inverse @ system.jacobian(tangent)) @ g / g).max())
            room = 1.0 - omega * float((np.abs(correction[:n]) / g).max()) - s * z
            q, c, b = (float((part / g).max()) for part in (bend, both, own))
            if room > 0.0 and room * room >= 2.0 * omega * (q * s * s + c * s + b):
                return True
        return False

    step = float(proven_step(system, factors, tangent, correction))
    if off > 1.0:
        assert step == 0.0
        assert not holds(0.0)
    else:
        assert holds(0.999 * step)
        assert not holds(1.001 * step)


@by_mechanism
def test_the_step_of_one_exact_place_is_that_of_many(mechanism: Mechanism) -> None:
    poses = at(mechanism, [1.2, 1.5, 1.9], [-10.0, 0.0, 20.0])
    system, n = mechanism.map, mechanism.layout.unknowns
    tangents = np.zeros_like(poses.y)
    tangents[:, mechanism.layout.scalar("rack travel")] = 0.3
    tangents[:, :n] = -poses.factors.solve(2.0 * system.polar(poses.y, tangents))
    steps = proven_step(system, poses.factors, tangents)
    for number, step in enumerate(steps.tolist()):
        one = factorise(system.jacobian(poses.y[number]))
        assert float(proven_step(system, one, tangents[number])) == pytest.approx(step, rel=1e-9)


@by_mechanism
def test_the_residual_of_poses_is_that_of_each(mechanism: Mechanism) -> None:
    poses = at(mechanism, np.linspace(1.2, 1.8, 5), np.linspace(-10.0, 10.0, 5))
    apart = np.random.default_rng(5).uniform(-1e-3, 1e-3, poses.y.shape)
    off = replace(poses, y=poses.y + apart)
    each = [float(np.abs(mechanism.map.residual(y)).max()) for y in off.y]
    np.testing.assert_allclose(off.residual, each, rtol=1e-12)


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
def test_many_poses_are_led_where_each_is_led(mechanism: Mechanism) -> None:
    start, ends = at(mechanism, 1.5, 0.0), at(mechanism, [1.2, 1.6, 1.9], [-20.0, 5.0, 25.0])
    n, eps = mechanism.layout.unknowns, np.finfo(float).eps
    many = follow(mechanism.map, start.y, ends.y[:, n:])
    assert (many.done == 1.0).all()
    for number, end in enumerate(ends.y):
        one = follow(mechanism.map, start.y, end[n:])
        assert one.done == 1.0
        # Each ends with a Newton step that has shrunk to rounding, of coordinates up to 2.
        allowed = 4 * eps * float(ends.condition[number])
        assert np.abs(one.y - end).max() <= allowed
        assert np.abs(many.y[number] - end).max() <= allowed


@by_mechanism
@pytest.mark.parametrize("moved", ["arm_angle", "rack"])
def test_an_input_that_is_held_is_not_to_be_brought_back(mechanism: Mechanism, moved: str) -> None:
    pose, inputs = at(mechanism, 1.3, 20.0), {"arm_angle": 1.3, "rack": 20.0}
    inputs[moved] += 1e-3
    goal = mechanism.known_series({name: np.array([value]) for name, value in inputs.items()})[0]
    assert assembly.blocked(mechanism, "no way", pose, goal, np.array(True), None).reduce == moved
