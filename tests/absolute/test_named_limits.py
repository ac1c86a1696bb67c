"""Which links and which input a refusal names, by what stands at zero."""

import numpy as np
import pytest

import absolute
from absolute.initial_assembly import assemble
from absolute.limits import limited_by, limiting_input, limits_at
from absolute.mechanism import Mechanism

ARM, AXIS, ROD = ("arm in front", "arm behind"), ("axis",), ("rod", "arm behind")


@pytest.mark.parametrize(
    ("shares", "named"),
    [
        ([0.5, -0.9, 1.0], ()),
        # Nearer to zero than a ten-thousandth, on either side.
        ([0.5, -1.1e-4, 1.0], ()),
        ([0.5, -0.9e-4, 1.0], AXIS),
        ([1e-9, -0.9, 1.0], ARM),
        # Within a factor of ten of the nearest they have come there together; no link is named twice.
        ([1e-9, -0.9, 9.9e-9], (*ARM, "rod")),
        ([1e-9, -0.9, 10.1e-9], ARM),
        # At the dead point itself, to the last digit.
        ([0.5, 0.0, 1e-300], AXIS),
        ([0.0, 0.5, 0.0], (*ARM, "rod")),
    ],
)
def test_the_links_nearest_to_their_dead_points_are_named(
    model: absolute.Model, monkeypatch: pytest.MonkeyPatch, shares: list[float], named: tuple[str, ...]
) -> None:
    mechanism = Mechanism(model)
    monkeypatch.setattr(mechanism.branch_signs, "shares", lambda world: np.array(shares))
    monkeypatch.setattr(mechanism.branch_signs, "limits", (ARM, AXIS, ROD))
    assert limits_at(mechanism, np.empty((0, 3))) == named


def test_a_linkage_without_signs_names_no_link(
    model: absolute.Model, monkeypatch: pytest.MonkeyPatch
) -> None:
    mechanism = Mechanism(model)
    monkeypatch.setattr(mechanism.branch_signs, "shares", lambda world: np.empty(0))
    assert limits_at(mechanism, np.empty((0, 3))) == ()


@pytest.mark.parametrize("number", [0, 1])
def test_the_input_whose_row_is_lost_is_the_one_that_meets_its_end(
    model: absolute.Model, number: int
) -> None:
    mechanism = Mechanism(model)
    pose, _ = assemble(mechanism)
    jacobian = mechanism.stack.jacobian(pose.placed)
    # No velocity changes the row of this input any more: it is what the bodies cannot follow.
    jacobian[mechanism.joint_rows + number] *= 1e-9
    change = np.ones(2)
    assert limiting_input(mechanism, jacobian, change) == tuple(model.inputs)[number]
    # What does not change meets no end.
    jacobian[mechanism.joint_rows + 1 - number] *= 1e-9
    change[1 - number] = 0.0
    assert limiting_input(mechanism, jacobian, change) == tuple(model.inputs)[number]


def test_links_become_words_where_there_are_any() -> None:
    assert limited_by(AXIS) == "limited by axis; "
    assert limited_by(ARM) == "limited by arm in front, arm behind; "
    assert limited_by(()) == ""
