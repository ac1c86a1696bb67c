"""Contradictory links, axes and inputs do contradict, a rod too long is too long, and both are found out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from pointcoord import MechanismError
from pointcoord.errors import AssemblyError
from pointcoord.linkage.hardpoints import build_mechanism
from pointcoord.solve.assembly import assemble
from validate.hard.cases import contradictions
from validate.hard.cases.contradictions import CASES, ROD, at_drawing, longest_rod, second_pivot, with_rod
from validate.hard.cases.links import axes, by_absolute, topology_of
from validate.hard.cases.near_points import assembled, drawn_angle

BY_NAME = {case.name: case for case in CASES}


@pytest.mark.parametrize("share", [1.0, 1e-3, 1e-6])
def test_a_third_link_of_a_moving_arm_would_have_to_change_its_length(share: float) -> None:
    points = second_pivot(share)
    mechanism = build_mechanism(topology_of("paper"), assembled(), axes("paper"))
    lengths = []
    for turn in (0.0, 0.1):
        pose = assemble(mechanism, {"arm_angle": np.array(drawn_angle() + turn), "rack": np.array(0.0)})
        place = list(mechanism.layout.vector("lower_ball_joint"))
        ball = pose.y[place] * mechanism.unit + mechanism.origin
        lengths.append([np.linalg.norm(ball - points[end]) for end in ("lower_arm_front", "second_pivot")])
    (first, third), (kept, other) = lengths
    # The first link keeps its length to the rounding of coordinates below 600 mm; the third is seen from
    # another place by a share of the arm, of which a turn by 0.1 rad makes about a tenth.
    assert abs(kept - first) < 1e-11
    assert abs(other - third) == pytest.approx(0.1 * share * first, rel=0.5)


def test_the_longest_rod_is_where_a_rod_stops_closing() -> None:
    length = longest_rod()
    p = assembled()
    assert length > 1.2 * float(np.linalg.norm(p[ROD[0]] - p[ROD[1]]))
    # Four lengths below 600 mm, of some roundings of 1e-13 mm each: known to 1e-14 of itself.
    at_drawing(with_rod(length * (1.0 - 1e-12)))
    with pytest.raises(AssemblyError):
        at_drawing(with_rod(length * (1.0 + 1e-12)))


def test_the_absolute_model_closes_a_rod_that_is_not_too_long() -> None:
    """So it refuses the long one for its length, and not for how it is described."""
    answer = by_absolute(lambda: contradictions.rod_of(0.9 * longest_rod()))
    assert answer.reason == "takes it for a mechanism"


def test_a_refusal_that_does_not_name_the_rod_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def vague(*_: Any) -> None:
        raise AssemblyError("no way on", reached={}, wanted={}, condition=1.0, reduce="", limits=("a link",))

    monkeypatch.setattr(contradictions, "assemble", vague)
    answer = contradictions.too_long(1e-3).answers[0]
    assert answer.outcome == "wrong"
    assert "is not among what limits it" in answer.reason


def test_a_refusal_that_does_not_name_the_third_link_is_wrong(monkeypatch: pytest.MonkeyPatch) -> None:
    def vague(*_: Any) -> None:
        raise MechanismError("over-determined", ["link lower_ball_joint - lower_arm_front"])

    monkeypatch.setattr("validate.hard.cases.links.build_mechanism", vague)
    answer = contradictions.contradictory(1e-3).answers[0]
    assert answer.outcome == "wrong"
    assert "does not name link lower_ball_joint - second_pivot" in answer.reason


def test_a_third_link_holds_the_ball_joint_where_it_is_drawn_and_a_copy_does_not() -> None:
    far, near, copy = (contradictions.held(share).answers[0] for share in (1.0, 1e-9, 0.0))
    assert (far.outcome, near.outcome, copy.outcome) == ("right", "right", "refused")
    # Links that are nearly one link hold the point only as well as their difference does.
    assert far.condition is not None
    assert near.condition is not None
    assert near.condition > 1e6 * far.condition
