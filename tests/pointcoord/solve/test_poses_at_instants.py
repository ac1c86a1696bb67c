"""Poses and rates at instants: which are proven to continue each other, and the paper's algorithm."""

from collections.abc import Callable

import numpy as np
import pytest
from parabola import AT_ONE, PARABOLA
from sample_cars import by_car

from pointcoord import Scene, simulate
from pointcoord.drawing_stands import drawn_inputs
from pointcoord.method import MAP, METHODS, NEWTON, Method
from pointcoord.numerics.arrays import Array
from pointcoord.numerics.linear import factorise
from pointcoord.simulation import pose_tolerance, prepare_task, scene_mechanism
from pointcoord.solve import pointwise
from pointcoord.solve.follower import follow
from pointcoord.solve.proven_step import ROOM

STRUT = scene_mechanism(Scene.load("bounce"))
EPS = np.finfo(float).eps


@pytest.mark.parametrize("way", [-0.7, -0.524, -0.519, -0.1, 0.1, 10.0, 14.0, 30.0])
def test_the_next_pose_is_proven_as_far_as_the_condition_holds(way: float) -> None:
    # From the next pose u back along w: u (1 - e s / 2 - e^2 s^2 / 8), e = dw / w there; omega = 1 / u.
    e = way / (1.0 + way)
    z = abs(e / 4.0 + e**2 / 32.0) + abs(e / 4.0 + e**2 / 16.0) + e**2 / 32.0
    eta = abs(e) ** 3 / 16.0 + e**4 / 128.0
    proven = z + np.sqrt(2.0 * eta) < ROOM
    factors = factorise(PARABOLA.jacobian(AT_ONE))
    targets = np.array([[1.0 + way, 0.0, 1.0]])
    for chord in (False, True):
        count = pointwise._ahead(PARABOLA, AT_ONE, factors, targets, 0.0, chord)[0]
        # A kept inverse is given up sooner, where it contracts by less than a tenth.
        assert count == proven or (chord and not count)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_what_a_kept_inverse_leaves_is_no_less_than_the_error(tolerance: float) -> None:
    # u^2 = w with the inverse at u = 1, as far as it contracts by a tenth.
    w = np.linspace(0.85, 1.15, 61)
    targets = np.stack([w, np.zeros_like(w), np.ones_like(w)], axis=-1)
    factors = factorise(PARABOLA.jacobian(AT_ONE))
    guess = pointwise._guessed(PARABOLA, factors, AT_ONE, targets)
    y, found, left, _ = pointwise._by_chord(PARABOLA, factors.preconditioner, guess, tolerance)
    assert found.all()
    assert np.count_nonzero(left) > 30
    # A step is rounded, and the root too.
    assert (np.abs(y[:, 0] - np.sqrt(w)) <= left + 4.0 * EPS).all()


def test_one_factorisation_serves_many_instants_by_chord(make_scene: Callable[..., Scene]) -> None:
    arm = {"sine": {"amplitude": 0.2, "angular_frequency": 2.0, "offset": 1.5}}
    rack = {"sine": {"amplitude": 10.0, "angular_frequency": 3.0}}
    motion = simulate(make_scene(arm, rack, stop=1.0, samples=400, effects=()), "chord")
    assert len(motion.times) == 400
    assert motion.work.factorisations < 40


# So near a fold no patch of a map can be proven.
@pytest.mark.parametrize("method", [name for name in METHODS if name != MAP.name])
@pytest.mark.parametrize("short", [1e-5, 1e-8])
def test_rates_near_a_lock_are_those_of_the_pose_that_is_reported(
    make_scene: Callable[..., Scene], method: Method, short: float
) -> None:
    # A Jacobian of Newton's last but one place, off by more than the pose's error, gave velocities that
    # stretched the links of the reported pose.
    scene = make_scene((np.pi / 2,), (0.0, 130.10076831981567 * (1 - short)), stop=1.0, samples=2)
    motion = simulate(scene, method)
    p, v = motion.position, motion.velocity
    fast = max(np.abs(v[name]).max() for name in STRUT.layout.moving)
    for start, end in (ends for one in STRUT.topology.constraints for ends in one.squared_lengths):
        stretch = (p[start][-1] - p[end][-1]) @ (v[start][-1] - v[end][-1])
        # r . v = 0 for every link. LU leaves some eps of the matrix times the solution, here 8; both factors
        # are rounded, coordinates up to 600 mm; three products.
        assert abs(stretch) <= 16 * EPS * 600.0 * 3 * fast


Make = Callable[..., Scene]


def plainly(scene: Scene) -> tuple[Array, float, float]:
    """Poses by proven steps from each to the next, what they may be off in units, and the unit, mm."""
    task = prepare_task(scene, NEWTON)
    mechanism = task.readout.mechanism
    allowed = pose_tolerance(scene, NEWTON, mechanism)
    known = mechanism.known_series({n: f.series(scene.instants, 0) for n, f in task.functions.items()})[:, 0]
    poses = [task.start.y]
    for goal in known[1:]:
        path = follow(mechanism.map, poses[-1], goal, None, allowed)
        if path.done < 1.0:
            break
        poses.append(path.y)
    return np.array(poses), allowed, float(mechanism.unit)


@by_car
def test_another_assembly_is_not_taken_for_the_next_pose(
    make_scene: Make, car: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    offset = drawn_inputs(Scene.load(car))["arm_angle"]
    scene = make_scene([offset, 0.1], [0.0, 5.0], car=car, samples=12, stop=1.0, effects=())
    plain, allowed, unit = plainly(scene)
    system = prepare_task(scene, NEWTON).readout.mechanism.map
    n, rng = system.unknowns, np.random.default_rng(7)
    others = []
    for pose in plain[1:]:
        tries = np.tile(pose, (200, 1))
        tries[:, :n] += rng.uniform(-1.0, 1.0, (200, n))
        reached = pointwise.newton_refine(system, tries)
        elsewhere = reached.converged & (np.abs(reached.y - pose).max(axis=-1) > 0.05)
        others.append(reached.y[np.argmax(elsewhere)])
        assert elsewhere.any()
    # Newton's method is started at another assembly of each instant, and stays there.
    monkeypatch.setattr(pointwise, "_guessed", lambda system, factors, start, targets: at(others, targets, n))
    motion = simulate(scene, "newton")
    found = motion.solved.coordinates(scene.instants, 0)[0]
    assert unit * np.abs(found - plain).max() <= 2.0 * (unit * allowed + float(motion.proof().bound.max()))


def at(poses: list[Array], targets: Array, unknowns: int) -> Array:
    """Those of the poses that have these known coordinates."""
    return np.array([min(poses, key=lambda y: np.abs(y[unknowns:] - w).max()) for w in targets])
