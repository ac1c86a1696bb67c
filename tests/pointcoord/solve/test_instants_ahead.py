"""Newton's method at many instants at once: the same poses as one after the other, and the same refusals."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from one_by_one import one_by_one
from sample_cars import SampleCar, by_car

from pointcoord import AssemblyError, Scene, simulate
from pointcoord.method import NEWTON
from pointcoord.simulation import pose_tolerance, prepare_task
from pointcoord.solve import pointwise
from pointcoord.solve.assembly import assemble, close_drawing
from pointcoord.solve.pointwise import straight_way

Array = NDArray[np.float64]
Make = Callable[..., Scene]


def plainly(scene: Scene) -> tuple[Array, float, float]:
    """Poses one after the other, what they may be off in units, and the unit, mm."""
    task = prepare_task(scene, NEWTON)
    mechanism = task.readout.mechanism
    allowed = pose_tolerance(scene, NEWTON, mechanism)
    poses = one_by_one(mechanism, task.functions, task.start, scene.instants, allowed)
    return poses, allowed, float(mechanism.unit)


@by_car
@given(
    swing=st.floats(0.02, 0.25),
    speed=st.floats(0.5, 40.0),
    travel=st.floats(-25.0, 25.0),
    samples=st.integers(2, 60),
)
def test_poses_ahead_are_those_one_after_the_other(
    make_scene: Make, car: SampleCar, swing: float, speed: float, travel: float, samples: int
) -> None:
    # Up to a whole swing between two instants.
    offset = car.drawn_inputs["arm_angle"]
    arm = {"sine": {"amplitude": swing, "angular_frequency": speed, "offset": offset}}
    scene = make_scene(arm, (0.0, travel), car=car, samples=samples, stop=1.0, effects=())
    plain, allowed, unit = plainly(scene)
    motion = simulate(scene, "newton")
    assert len(plain) == samples
    found = motion.solved.states.coordinates(scene.instants, 0)[0]
    # Each is within what its tolerance left, and within the proof's rounding, of the one assembly there.
    off = unit * np.abs(found - plain).max()
    assert off <= 2.0 * (unit * allowed + float(motion.proof().bound.max()))


def past_a_fold(make_scene: Make) -> Scene:
    """Two instants between which no pose exists: the arm goes a way that a fold cuts off at this rack."""
    return make_scene([np.radians(40.0), np.radians(-7.0)], [-0.1, 0.1], stop=1.0, samples=2, effects=())


def test_no_pose_is_reached_across_poses_that_do_not_exist(
    make_scene: Make, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = past_a_fold(make_scene)
    plain, _, _ = plainly(scene)
    with pytest.raises(AssemblyError):
        simulate(scene, "newton")
    assert len(plain) == 1
    # There is an assembly at the second instant, which Newton's method finds: only the proof refuses it.
    task = prepare_task(scene, NEWTON)
    mechanism = task.readout.mechanism
    known = mechanism.known_series({n: f.series(scene.instants, 0) for n, f in task.functions.items()})[1, 0]
    guess = pointwise._guessed(mechanism.map, task.start.factors.preconditioner, task.start.y, known[None])
    assert pointwise.newton_refine(mechanism.map, guess).converged.all()


@by_car
def test_another_assembly_is_not_taken_for_the_next_pose(
    make_scene: Make, car: SampleCar, monkeypatch: pytest.MonkeyPatch
) -> None:
    offset = car.drawn_inputs["arm_angle"]
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
    monkeypatch.setattr(pointwise, "_guessed", lambda system, inverse, start, targets: at(others, targets, n))
    motion = simulate(scene, "newton")
    found = motion.solved.states.coordinates(scene.instants, 0)[0]
    assert unit * np.abs(found - plain).max() <= 2.0 * (unit * allowed + float(motion.proof().bound.max()))


def at(poses: list[Array], targets: Array, unknowns: int) -> Array:
    """Those of the poses that have these known coordinates."""
    return np.array([min(poses, key=lambda y: np.abs(y[unknowns:] - w).max()) for w in targets])


@pytest.mark.parametrize("name", ["steer", "off-axis-strut", "double-wishbone", "five-link"])
def test_eta_of_a_straight_way_is_at_least_what_is_left_all_along_it(name: str) -> None:
    """Also with the inverse of another pose, where C_u T does not take back all of C_w dw.

    There the end of the tangent lacks most. Without that, or without what the pose lacks, or the curvature,
    what is left is somewhere more than eta.
    """
    mechanism = prepare_task(Scene.load(name), NEWTON).readout.mechanism
    system, n, rng = mechanism.map, mechanism.map.unknowns, np.random.default_rng(5)
    drawing = close_drawing(mechanism)
    drawn = mechanism.input_values(drawing.y[n:])
    reach = {name: 30.0 if mechanism.topology.input_units[name] == "mm" else 1.0 for name in drawn}
    noticed = np.zeros(3, dtype=bool)
    # How far the pose is from that of the inverse, how long the way is, and how far the pose is off.
    for apart, length, off in ((0.1, 1e-4, 1e-12), (1e-9, 0.05, 1e-12), (1e-9, 1e-4, 1e-3)):
        inputs = {name: value + apart * reach[name] for name, value in drawn.items()}
        target = {name: (value + length * reach[name])[..., None] for name, value in inputs.items()}
        y = assemble(mechanism, inputs, None, drawing).y
        y[:n] += off * rng.uniform(-1.0, 1.0, n)
        inverse = drawing.factors.preconditioner
        way = straight_way(system, inverse, y, mechanism.known_series(target)[0])
        eta, _ = way.norms(np.ones(n))
        start, bend = system.residual(y), system.residual(way.tangent)
        rows = start, start + 2.0 * system.polar(y, way.tangent), bend
        first, end, last = (np.abs(inverse @ each).max() for each in rows)
        for s in (0.25, 0.5, 1.0):
            left = np.abs(inverse @ system.residual(y + s * way.tangent)).max()
            assert left <= eta * (1.0 + 1e-9) + 1e-15
            noticed |= left > np.array([end + last, first + last, max(first, end)])
    assert noticed.all()
