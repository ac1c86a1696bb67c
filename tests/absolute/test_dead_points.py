"""The ends of a motion: found where the closed form has them, and told by their links."""

from collections.abc import Callable

import jets
import numpy as np
import pytest
from dead_points import ENDS, End, low_mount
from flat import built_in
from numpy.typing import NDArray

import absolute

Array = NDArray[np.float64]
Held = Callable[[float, float], dict[str, Array]]
EPS = float(np.finfo(float).eps)


def test_the_ends_here_are_all_there_are() -> None:
    kinds = {id(end.kind): end.kind for end in ENDS}.values()
    assert len(kinds) == 2
    for kind in kinds:
        assert {end.links for end in ENDS if end.kind is kind} == set(kind.links)


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("beyond", [1e-12, 1e-9, 1e-6, 1e-3, 0.05])
def test_beyond_an_end_the_refusal_names_links_input_and_limit(end: End, held: Held, beyond: float) -> None:
    goal = end.inside[0] + beyond * end.out[0], end.inside[1] + beyond * end.out[1]
    with pytest.raises(absolute.PoseError) as caught:
        absolute.solve(end.kind.build(end.car), held(*goal))
    error = caught.value
    assert error.instant == 0
    assert end.links in error.limits
    assert error.limit == end.limit
    assert error.inputs == dict(zip(("arm_angle", "rack"), goal, strict=True))
    assert f"limited by {', '.join(error.limits)}" in str(error)
    if beyond >= 1e-6:
        assert isinstance(error, absolute.UnreachableError)
        # Followed until the fold is about sqrt(eps) away, and the input about eps times constants.
        asked = dict(zip(("arm_angle", "rack"), end.inside, strict=True))
        assert abs(error.reached[end.limit] - asked[end.limit]) < 1e-10 * max(1.0, abs(end.out[1]))


@pytest.mark.parametrize("end", ENDS)
@pytest.mark.parametrize("before", [1e-12, 1e-10, 1e-8, 1e-5, 1e-2])
def test_just_before_an_end_the_pose_is_the_exact_one(end: End, held: Held, before: float) -> None:
    goal = end.inside[0] - before * end.out[0], end.inside[1] - before * end.out[1]
    exact = end.kind.exact(end.car, *((x, 0, 0) for x in goal))
    assert exact is not None
    motion = absolute.solve(end.kind.build(end.car), held(*goal), rates=False, conditions=True)
    assert motion.condition is not None
    tolerance = 8 * EPS * 400 * motion.condition[0]
    for name, place in exact.points.items():
        assert jets.errors_of([x.x for x in place], motion.position[name][0]).max() <= tolerance, name


@pytest.mark.parametrize("lift", [0.0, 1e-13])
def test_a_ball_joint_drawn_abreast_of_the_top_mount_is_refused(held: Held, lift: float) -> None:
    car = low_mount()
    # The foot of its normal is the top mount itself; powers of two make it exact.
    car["strut_top"], car["strut_lower"] = np.array([512.0, -256.0, 256.0]), np.array([512.0, -256.0, 128.0])
    car["strut_rod_end"] = np.array([512.0, -256.0, 192.0])
    car["lower_ball_joint"] = np.array([512.0, -384.0, 256.0 + lift])
    with pytest.raises(absolute.SingularError, match="slide strut at strut_top") as caught:
        absolute.solve(built_in("macpherson", car), held(1.6, 0.0))
    assert caught.value.instant is None


def test_a_strut_without_length_is_refused(held: Held) -> None:
    car = low_mount()
    for name in ("strut_lower", "strut_rod_end"):
        with pytest.raises(absolute.DescriptionError, match=f"{name}.*strut_top.*coincide"):
            built_in("macpherson", {**car, name: car["strut_top"]})
        near = car["strut_top"] + np.array([0.0, 0.0, 1e-7])
        with pytest.raises(absolute.DescriptionError, match="apart"):
            absolute.solve(built_in("macpherson", {**car, name: near}), held(1.6, 0.0))


@pytest.mark.parametrize("end", [ENDS[0], ENDS[4]])
def test_a_drawing_that_locks_before_it_closes_names_its_links(end: End, held: Held) -> None:
    # The rack's line further away than the tie rod is long.
    car = {**end.car, "rack_centre": end.car["rack_centre"] + np.array([0.0, 0.0, 1500.0])}
    with pytest.raises(absolute.AssemblyError, match=r"limited by .*rod tie_rod") as caught:
        absolute.solve(end.kind.build(car), held(1.6, 0.0))
    assert caught.value.instant is None
    assert caught.value.partial is None
    assert caught.value.residual > 0
