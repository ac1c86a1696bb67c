"""Suspensions in other programs are never another assembly than the drawing's."""

import numpy as np
import pytest
from numpy.typing import NDArray
from relative_cars import plain_car
from sample_cars import GENERAL_STRUT

from validate.peers import program
from validate.peers.errors import PeerError
from validate.peers.in_exudyn import InExudyn
from validate.peers.in_mujoco import InMujoco
from validate.peers.in_pinocchio import InPinocchio
from validate.peers.linkage import Linkage, linkage_of
from validate.peers.motion import Poses

Array = NDArray[np.float64]
ProgramOf = type[InMujoco] | type[InExudyn] | type[InPinocchio]
by_program = pytest.mark.parametrize("program_of", [InMujoco, InExudyn, InPinocchio])


def driven_to(linkage: Linkage, **laws: Array) -> Array:
    """Inputs of the drives, (N, drives), from their values, (N,)."""
    held = {name: np.stack([law, 0.0 * law, 0.0 * law], axis=-1) for name, law in laws.items()}
    return linkage.inputs(held).values


def solved(program_of: ProgramOf, linkage: Linkage, driven: Array, tolerance: float = 1e-12) -> Poses:
    engine = program_of(linkage)
    return engine.poses(driven, tolerance, engine.closed(tolerance))


@by_program
def test_an_assembly_on_another_side_than_the_drawings_is_refused(program_of: ProgramOf) -> None:
    linkage = linkage_of(plain_car(GENERAL_STRUT))
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
    linkage, home = linkage_of(plain_car(GENERAL_STRUT)), GENERAL_STRUT.drawn_inputs
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
