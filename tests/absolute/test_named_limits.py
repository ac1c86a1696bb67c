"""Which links and which input a refusal names, by what stands at zero."""

import numpy as np
import pytest

import absolute
from absolute.initial_assembly import assemble
from absolute.limits import limited_by, limiting_input, limits_at
from absolute.mechanism import Mechanism

ARM, AXIS = ("arm in front", "arm behind"), ("axis",)


@pytest.mark.parametrize(("strength", "named"), [(1e-2, False), (1e-6, True), (1e-12, True)])
def test_the_joint_whose_force_meets_no_other_is_named(
    model: absolute.Model, strength: float, named: bool
) -> None:
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    for owner in ("rod tie_rod", "slide rack", "hinge of lower_arm on chassis"):
        row = mechanism.stack.owners.index(owner)
        jacobian = pose.jacobian[0].copy()
        # A force in this row, which nothing feels.
        jacobian[row] *= strength
        limits = limits_at(mechanism, jacobian)
        assert limits == (() if not named else (owner,)) or (strength > 1e-4 and not limits)


@pytest.mark.parametrize("number", [0, 1])
def test_the_input_whose_row_is_lost_is_the_one_that_meets_its_end(
    model: absolute.Model, number: int
) -> None:
    mechanism = Mechanism(model)
    pose = assemble(mechanism)
    jacobian = pose.jacobian[0].copy()
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
