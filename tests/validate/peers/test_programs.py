"""Suspensions in other programs are where their closed forms say, and are never another assembly."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from sample_cars import GENERAL_STRUT, SAMPLES, SampleCar
from suspensions_in_closed_form import FORMS, ClosedForm, rounded

from validate.peers import program
from validate.peers.in_exudyn import InExudyn
from validate.peers.in_mujoco import InMujoco
from validate.peers.linkage import Linkage, PeerError, linkage_of
from validate.peers.motion import Poses

Array = NDArray[np.float64]
ProgramOf = type[InMujoco] | type[InExudyn]
# A car is put together in mpmath and in the program, and a search is short.
searched = settings(max_examples=min(settings.default.max_examples if settings.default else 100, 40))
by_program = pytest.mark.parametrize("program_of", [InMujoco, InExudyn])


@pytest.fixture(autouse=True)
def digits() -> Iterator[None]:
    with mpmath.workdps(30):
        yield


def of_sample(car: SampleCar) -> Linkage:
    return linkage_of(car.type, car.points, (0, 0, 1), (0, 1, 0), car.closure)


def solved(program_of: ProgramOf, linkage: Linkage, driven: Array, tolerance: float = 1e-12) -> Poses:
    engine = program_of(linkage)
    return engine.poses(driven, tolerance, engine.closed(tolerance))


@by_program
@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
@searched
@given(data=st.data(), arm=st.floats(-0.25, 0.25), rack=st.floats(-25.0, 25.0))
def test_every_point_is_where_the_closed_form_says(
    program_of: ProgramOf, form: ClosedForm, data: st.DataObject, arm: float, rack: float
) -> None:
    car: Any = rounded(data.draw(form.cars), form)
    points = {name: [float(c) for c in place] for name, place in car.points.items()}
    linkage = linkage_of(form.type, points, [float(c) for c in car.up], [float(c) for c in car.right])
    theta, travel = float(car.drawn[0]) + arm, float(car.drawn[1]) + rack
    exact = car.drawn_pose(mpmath.mpf(theta), mpmath.mpf(travel))
    assume(exact is not None)
    places = {
        n: np.array([float(c) for c in exact.points[n]])
        if n in exact.points
        else linkage.drawn[n] * linkage.unit + linkage.origin
        for n in linkage.drawn
    }
    near = {n: (place - linkage.origin) / linkage.unit for n, place in places.items()}
    # Nearer to where two assemblies meet rounding is raised by more than a thousand.
    assume(np.abs(linkage.sides(near)).min() > 1e-3)
    try:
        turn, off = linkage.turns(np.array([[theta, 0.0, 0.0]]))
    except PeerError:
        assume(False)
        raise
    assume(off[0, 0] < 1e-14)
    poses = solved(program_of, linkage, np.array([[turn[0, 0], travel / linkage.unit]]))
    for name, place in poses.places.items():
        # 16 roundings of a car of 1024 mm, raised a thousand times: 2e-9; most are far from that.
        assert np.abs(place[0] * linkage.unit + linkage.origin - places[name]).max() < 1e-9, name


@by_program
def test_a_motion_through_a_fold_is_refused_where_it_ends(program_of: ProgramOf) -> None:
    linkage = of_sample(GENERAL_STRUT)
    travel = np.linspace(0.0, 300.0, 31) / linkage.unit  # no tie rod reaches as far
    driven = np.stack([np.zeros(31), travel + linkage.drawn_inputs[1]], axis=-1)
    with pytest.raises(PeerError, match="no pose is reached") as caught:
        solved(program_of, linkage, driven)
    assert caught.value.instant is not None
    assert 2 < caught.value.instant < 30
    # Up to there it is solved.
    assert len(solved(program_of, linkage, driven[: caught.value.instant]).coordinates)


@by_program
@pytest.mark.parametrize("car", SAMPLES, ids=lambda car: car.name)
def test_an_assembly_on_another_side_than_the_drawings_is_refused(
    program_of: ProgramOf, car: SampleCar
) -> None:
    linkage = of_sample(car)
    driven = linkage.drawn_inputs[None]
    assert len(solved(program_of, linkage, driven).coordinates) == 1
    # The tie rod's inner end as if it were drawn on the other side of the steering axis.
    k = linkage.drawn[linkage.kingpin[1]]
    normal = np.cross(k, linkage.drawn["tie_rod_outer"])
    inner = linkage.drawn["tie_rod_inner"]
    there = inner - 2.0 * (inner @ normal) / (normal @ normal) * normal
    planted = replace(linkage, drawn={**linkage.drawn, "tie_rod_inner": there})
    with pytest.raises(PeerError, match="another assembly"):
        solved(program_of, planted, driven)


@by_program
def test_a_long_way_is_gone_in_steps_that_keep_to_one_assembly(
    program_of: ProgramOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    linkage = of_sample(GENERAL_STRUT)
    goal = linkage.drawn_inputs + np.array([-0.55, 0.06])
    near = solved(program_of, linkage, np.linspace(linkage.drawn_inputs, goal, 50))
    far = solved(program_of, linkage, goal[None])
    for name, place in far.places.items():
        assert np.abs(place[0] - near.places[name][-1]).max() < 1e-12
    monkeypatch.setattr(program, "LONGEST_STEP", 1e-3)
    monkeypatch.setattr(program, "HALVINGS", 3)
    with pytest.raises(PeerError, match="no pose is reached"):
        solved(program_of, linkage, goal[None])


@by_program
def test_a_coarse_tolerance_leaves_an_error_and_saves_steps(program_of: ProgramOf) -> None:
    linkage = of_sample(GENERAL_STRUT)
    driven = np.linspace(linkage.drawn_inputs, linkage.drawn_inputs + np.array([0.3, 0.03]), 20)
    fine, coarse = (solved(program_of, linkage, driven, tolerance) for tolerance in (1e-13, 1e-2))
    assert coarse.counts["newton_steps"] < 0.6 * fine.counts["newton_steps"]
    error = max(np.abs(fine.places[n] - coarse.places[n]).max() for n in fine.places)
    assert 1e-12 < error < 1e-2
    assert coarse.last_step.max() > 1e-6
    assert fine.last_step.max() < 1e-8
