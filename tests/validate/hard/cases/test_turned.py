"""Of each pair of printed rows one is lost where the strut lies flat; the slide's coordinates lose none."""

from dataclasses import replace

import numpy as np

from pointcoord import Scene
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.simulation import scene_mechanism
from validate.cars.car import rotation
from validate.hard.cars import UPRIGHT_CAR, Array, scene_content
from validate.hard.case import Case
from validate.hard.cases.turned import CASES, quarter_turn_less
from validate.hard.run import examine
from validate.paper.printed import PRINTED

BY_NAME = {case.name: case for case in CASES}


def at(case: str, *values: float) -> Case:
    """A case at some values of its parameter only."""
    return replace(BY_NAME[case], values=values)


def test_each_pair_of_printed_rows_loses_one_exactly_where_the_strut_is_flat() -> None:
    aside = rotation(2, np.cos(0.3), np.sin(0.3))  # about z, so that the flat strut lies along no axis
    upright = Scene.from_mapping(scene_content(UPRIGHT_CAR, 1.5))
    flat = quarter_turn_less(0, 0.0)
    nearly = quarter_turn_less(0, 1e-3)
    for turn, rank in ((np.eye(3), 15), (nearly, 15), (aside @ nearly, 15), (flat, 13), (aside @ flat, 13)):
        assert np.linalg.matrix_rank(turned_jacobian(scene_mechanism(upright, PRINTED), turn)) == rank
        ours = scene_mechanism(upright)
        assert np.linalg.matrix_rank(turned_jacobian(ours, turn)) == ours.map.unknowns


def turned_jacobian(mechanism: Mechanism, turn: Array) -> Array:
    """At the drawing, turned about the mechanism's own origin: no check stands between it and its rank."""
    y, layout = mechanism.drawn.copy(), mechanism.layout
    for name in (*layout.moving, *layout.chassis, *layout.directions):
        place = list(layout.vector(name))
        y[place] = turn @ y[place]
    return mechanism.map.jacobian(y)


def test_the_printed_condition_number_grows_as_one_over_the_rise_and_ours_does_not() -> None:
    result = examine(at("strut-nearly-flat", 1e-4, 1e-6, 1e-8))
    printed = [answer.condition for _, answer in result.answers("printed")]
    assert np.allclose(np.diff(np.log10(np.array(printed, dtype=float))), 2.0, rtol=0, atol=0.01)
    for name in ("pointcoord", "absolute"):
        assert all(
            answer.condition is not None and answer.condition < 1e3 for _, answer in result.answers(name)
        )
