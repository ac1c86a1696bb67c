"""A motion that stops before its scene ends is a motion with a status, and its error says the same."""

import pickle
from collections.abc import Callable

import numpy as np
import pytest

from pointcoord import AssemblyError, Motion, MotionTooLong, PointcoordError, Scene, simulate
from pointcoord.method import METHODS, NEWTON, SERIES, Method
from pointcoord.solve.status import COMPLETE
from validate.paper.printed import PRINTED

ARM = (1.5, 1.0)  # rad: past the last angle, 152.013 degrees, at t = 1.153 s
LAST = 1.15  # s


def stopped_by(kind: type[PointcoordError], scene: Scene, method: Method) -> PointcoordError:
    with pytest.raises(kind) as caught:
        simulate(scene, method)
    return caught.value


@pytest.mark.parametrize("method", [*METHODS.values(), PRINTED], ids=str)
def test_a_whole_motion_is_complete_and_a_part_of_one_says_what_stopped_it(
    make_scene: Callable[..., Scene], method: Method
) -> None:
    whole = simulate(make_scene(ARM, samples=24, stop=LAST), method)
    assert whole.status is COMPLETE
    assert whole.status.complete
    assert whole.status.error(whole) is None
    error = stopped_by(AssemblyError, make_scene(ARM, samples=31, stop=1.5), method)
    part = error.partial
    assert isinstance(part, Motion)
    assert not part.status.complete
    assert str(part.status.error(part)) == str(error)
    assert repr(part).startswith(f"<part of a Motion by {'series' if method.name == 'auto' else method}")
    # Both scenes have an instant every 0.05 s, and up to the end they ask for the same.
    assert np.array_equal(part.times, whole.times)
    assert error.reduce == "arm_angle"
    assert error.wanted["arm_angle"] > error.reached["arm_angle"]
    # A map ends with a box, and the printed formulas at an instant.
    short = {"map": 1e-3, "printed": 0.05}.get(method.name, np.deg2rad(1e-3))
    assert np.deg2rad(152.013) - short <= error.reached["arm_angle"] <= np.deg2rad(152.014)
    again = pickle.loads(pickle.dumps(part))
    assert str(again.status.error()) == str(error)


def test_a_part_of_a_motion_has_the_numbers_and_the_proof_of_the_whole(
    make_scene: Callable[..., Scene],
) -> None:
    # At an instant that is solved for by itself nothing tells that a later one fails.
    whole = simulate(make_scene(ARM, samples=24, stop=LAST), NEWTON)
    part = stopped_by(AssemblyError, make_scene(ARM, samples=31, stop=1.5), NEWTON).partial
    one, other = whole.proof(rates=True), part.proof(rates=True)
    for quantity, channel in whole.numbers.items():
        for name, array in channel.items():
            assert np.array_equal(array, part.numbers[quantity][name])
            assert np.array_equal(one.proven[quantity][name], other.proven[quantity][name])


def test_a_motion_of_too_many_series_keeps_those_it_has(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("pointcoord.solve.taylor.MOST_SEGMENTS", 1)
    error = stopped_by(MotionTooLong, make_scene(ARM, samples=116, stop=LAST), SERIES)
    part = error.partial
    assert 1 < len(part.times) < 116
    assert np.isfinite(part.at(part.times[-1]).position["wheel_centre"]).all()
    assert part.work.segments == 1


def test_nothing_is_kept_where_no_instant_was_solved(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    # No trial step is good enough: the chain cannot leave its start.
    monkeypatch.setattr("pointcoord.solve.taylor.on_branch", lambda *_: np.array(False))
    error = stopped_by(PointcoordError, make_scene(ARM, samples=2, stop=LAST), SERIES)
    assert error.partial is None
