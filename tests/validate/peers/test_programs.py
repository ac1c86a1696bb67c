"""Suspensions in other programs are where their closed forms say, and are never another assembly."""

from collections.abc import Iterator
from typing import Any

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mechanism_equations import Equations
from mechanism_files import SCENES, mechanism_file, plain, plain_scene
from mechanism_poses import placed
from numpy.typing import NDArray
from relative_cars import plain_car
from sample_cars import GENERAL_STRUT, SAMPLES, SampleCar
from suspensions_in_closed_form import FORMS, Suspension, rounded

from validate.peers import program
from validate.peers.errors import PeerError
from validate.peers.in_exudyn import InExudyn
from validate.peers.in_mujoco import InMujoco
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.linkage import Linkage, linkage_of
from validate.peers.motion import Poses, numbers

Array = NDArray[np.float64]
ProgramOf = type[InMujoco] | type[InExudyn] | type[InPinocchio]
# A car is put together in mpmath and in the program, and a search is short.
searched = settings(max_examples=min(settings.default.max_examples if settings.default else 100, 40))
by_program = pytest.mark.parametrize("program_of", [InMujoco, InExudyn, InPinocchio])


@pytest.fixture(autouse=True)
def digits() -> Iterator[None]:
    with mpmath.workdps(30):
        yield


def of_sample(car: SampleCar) -> Linkage:
    return linkage_of(plain_car(car))


def driven_to(linkage: Linkage, **laws: Array) -> Array:
    """Inputs of the drives, (N, drives), from their values, (N,)."""
    held = {name: np.stack([law, 0.0 * law, 0.0 * law], axis=-1) for name, law in laws.items()}
    return linkage.inputs(held).values


def solved(program_of: ProgramOf, linkage: Linkage, driven: Array, tolerance: float = 1e-12) -> Poses:
    engine = program_of(linkage)
    return engine.poses(driven, tolerance, engine.closed(tolerance))


@by_program
@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.type)
@searched
@given(data=st.data(), arm=st.floats(-0.25, 0.25), rack=st.floats(-25.0, 25.0))
def test_every_point_is_where_the_closed_form_says(
    program_of: ProgramOf, form: Suspension, data: st.DataObject, arm: float, rack: float
) -> None:
    car: Any = rounded(data.draw(form.cars))
    points = {name: [float(c) for c in place] for name, place in car.points.items()}
    axes = {"up": [float(c) for c in car.up], "right": [float(c) for c in car.right]}
    linkage = linkage_of(plain(mechanism_file(form.type), {"points": points, **axes}, ("arm_angle", "rack")))
    theta, travel = float(car.drawn[0]) + arm, float(car.drawn[1]) + rack
    exact = car.drawn_pose(mpmath.mpf(theta), mpmath.mpf(travel))
    assume(exact is not None and 0.0 <= theta <= np.pi)
    engine = program_of(linkage)
    try:
        home = engine.closed(1e-12)
        driven = driven_to(linkage, arm_angle=np.array([theta]), rack=np.array([travel]))
        poses = engine.poses(driven, 1e-12, home)
    except PeerError:
        # The straight way to the inputs may leave the car's reach. Most do not: see the count of the search.
        assume(False)
        raise
    # Nearer to where two assemblies meet rounding is raised by more than a thousand.
    assume(np.linalg.cond(engine.misses()[1][:, engine.unknown]) < 1e3)
    for name, place in numbers(linkage, None, poses)["position"].items():
        if name in exact:
            # 16 roundings of a car of 1024 mm, raised a thousand times: 2e-9; most are far from that.
            assert np.abs(place[0] - np.array([float(c) for c in exact[name]])).max() < 1e-9, name


@by_program
@pytest.mark.parametrize("name", SCENES)
def test_a_shipped_mechanism_moves_as_the_witness_says(program_of: ProgramOf, name: str) -> None:
    mechanism = plain_scene(name)
    linkage, witness = linkage_of(mechanism), Equations(mechanism)
    home = {
        driven.input: driven.drawn * (1.0 if driven.is_angle else linkage.unit) for driven in linkage.driven
    }
    size = {n: 0.2 if laws else 0.02 * linkage.unit for n, laws in _angles(linkage).items()}
    path = [{n: home[n] + part * size[n] for n in home} for part in (0.5, 1.0)]
    laws = {n: np.array([at[n] for at in path]) for n in home}
    found = numbers(linkage, None, solved(program_of, linkage, driven_to(linkage, **laws)))["position"]
    for i, points in enumerate(placed(witness, path)):
        for point, place in points.items():
            if point in found:
                # 16 roundings of the mechanism, raised a hundred times.
                error = np.abs((found[point][i] - place).astype(float)).max()
                assert error < 2e-13 * linkage.unit, point


def _angles(linkage: Linkage) -> dict[str, bool]:
    return {driven.input: driven.is_angle for driven in linkage.driven}


@by_program
@pytest.mark.parametrize("car", SAMPLES, ids=lambda car: car.name)
def test_an_assembly_on_another_side_than_the_drawings_is_refused(
    program_of: ProgramOf, car: SampleCar
) -> None:
    linkage = of_sample(car)
    driven = linkage.drawn_inputs[None]
    engine = program_of(linkage)
    home = engine.closed(1e-12)
    assert len(engine.poses(driven, 1e-12, home).coordinates) == 1
    # As if the drawing were on the other side.
    engine.drawn = -engine.drawn
    with pytest.raises(PeerError, match="cannot be reached"):
        engine.poses(driven, 1e-12, home)


@by_program
def test_a_long_way_is_gone_in_steps_that_keep_to_one_assembly(
    program_of: ProgramOf, monkeypatch: pytest.MonkeyPatch
) -> None:
    linkage, home = of_sample(GENERAL_STRUT), GENERAL_STRUT.drawn_inputs
    goal = {"arm_angle": home["arm_angle"] - 0.55, "rack": home["rack"] + 40.0}
    laws = {name: np.linspace(home[name], goal[name], 50) for name in home}
    near = solved(program_of, linkage, driven_to(linkage, **laws))
    last = driven_to(linkage, **{name: law[-1:] for name, law in laws.items()})
    far = solved(program_of, linkage, last)
    for name, place in far.places.items():
        assert np.abs(place[0] - near.places[name][-1]).max() < 1e-12
    monkeypatch.setattr(program, "LONGEST_STEP", 1e-3)
    monkeypatch.setattr(program, "HALVINGS", 3)
    with pytest.raises(PeerError, match="cannot be reached"):
        solved(program_of, linkage, last)
