"""What keeps a path and a series on their branch, on the parabola u^2 = w, whose branches meet at w = 0."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from parabola import AT_ONE, PARABOLA

from pointcoord.numerics.branch import NEAR, on_branch, regular_on
from pointcoord.numerics.counters import Work
from pointcoord.numerics.linear import factorise
from pointcoord.numerics.newton import Converged
from pointcoord.solve.follower import SMALLEST_STEP, follow

S = 0.5


def ends_on_branch(first_step: float, last_but_one: float, last: float, u: float = 1.0) -> bool:
    """A series of order 4 that ends at (u, u^2): Newton's first step and its last terms at the end."""
    y = np.array([u, u * u, 0.0, 1.0])
    series = np.zeros((5, 4))
    series[3, 0], series[4, 0] = last_but_one / S**3, last / S**4
    factors = factorise(PARABOLA.jacobian(y))
    reached = Converged(
        y=y,
        factors=factors,
        converged=np.array(True),
        iterations=np.array(2),
        first_step=np.array(first_step),
        left=np.array(0.0),
        last_step=np.array(first_step),
        work=Work(),
    )
    return bool(on_branch(PARABOLA, series, S, reached, factors))


# The other branch is 2 u = 2 / omega away; of that distance NEAR may lie between the series and its end.
LIMIT = 2.0 * NEAR


@pytest.mark.parametrize(
    "shares",
    [(1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0.5, 0), (0.5, 0, 0.5), (0, -0.5, 0.5), (0.25, 0.25, -0.5)],
    ids=str,
)
@pytest.mark.parametrize("u", [1.0, 1e-3])
def test_what_a_series_left_out_and_newtons_step_count_together(
    shares: tuple[float, float, float], u: float
) -> None:
    # Just below and just above by far more than the ten roundings of the sum.
    below, above = (LIMIT * u * factor for factor in (1.0 - 1e-12, 1.0 + 1e-12))
    assert ends_on_branch(*(share * below for share in shares), u=u)
    assert not ends_on_branch(*(share * above for share in shares), u=u)


@given(u=st.floats(1e-3, 1e3), shares=st.tuples(*[st.floats(-1.0, 1.0)] * 3))
def test_a_series_is_proven_regular_up_to_where_the_next_singular_pose_lies(
    u: float, shares: tuple[float, float, float]
) -> None:
    """C_u = 2 u is singular at u = 0 only, so that the estimate loses nothing, in whatever variables."""
    series = np.zeros((4, 4))
    series[:, 0], series[0, 3] = u * np.array([1.0, *shares]), 1.0
    least = 1.0 - float(np.abs(shares).sum())
    assume(abs(least) > 1e-6)
    found = regular_on(PARABOLA, series[None, 0], series[1:, None], range(series.shape[-1]))
    assert found.tolist() == [least > 0.0]


def path_to(w: float) -> tuple[float, float]:
    """The share done of the path from w = 1, and u at its end."""
    path = follow(PARABOLA, AT_ONE, np.array([w, 0.0, 1.0]))
    return float(path.done), float(path.y[0])


@pytest.mark.parametrize("beyond", [1.0, 1e-3, 1e-9])
def test_a_path_into_a_fold_stops_where_its_steps_are_the_smallest(beyond: float) -> None:
    done, u = path_to(-beyond)
    # Left of the way to the fold, as a share of the path. A step is at most the way to the fold and at
    # least a tenth of it, so the last one that is taken leaves at most ten smallest steps and at least a
    # tenth of one. u^2 says the same as long as the path's own rounding, 1e-16 of it, is far smaller.
    left = 1.0 / (1.0 + beyond) - done
    assert 0.1 * SMALLEST_STEP <= left <= 10.0 * SMALLEST_STEP
    assert abs(u * u / (1.0 + beyond) - left) <= 1e-15
