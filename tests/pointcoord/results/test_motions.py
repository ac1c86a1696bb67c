"""Motions are read by name, cannot be written, and come back whole from a pickle.

One that stops before its scene ends is a motion with a status, and its error says the same.
"""

import pickle
from collections.abc import Callable

import numpy as np
import pytest
from within_bounds import beyond_claims, differing

from pointcoord import AssemblyError, Motion, PointcoordError, Samples, Scene, UnknownName, simulate
from pointcoord.effects.point_states import NAMED, STATES
from pointcoord.method import METHODS, SERIES, Method
from pointcoord.solve.status import COMPLETE
from validate.paper.printed import PRINTED


@pytest.mark.parametrize("method", [*METHODS.values(), PRINTED], ids=str)
def test_a_motion_is_pickled_with_all_that_it_can_be_asked_for_and_stays_read_only(method: Method) -> None:
    motion = simulate("bounce" if method is PRINTED else "bounce-on-a-heaving-chassis", method)
    again = pickle.loads(pickle.dumps(motion))
    for name in ("method", "notes", "unit", "work", "closing"):
        assert getattr(motion, name) == getattr(again, name)
    same: list[tuple[Samples, Samples]] = [(motion, again)]
    if method.dense:
        same.append((motion.at([0.3, 0.1]), again.at([0.3, 0.1])))
        same.append((motion.at(0.3), pickle.loads(pickle.dumps(motion.at(0.3)))))
    for one, other in same:
        assert np.array_equal(one.times, other.times)
        assert differing(one.numbers, other.numbers) == []
    proof, its = (each.proof(rates=True) for each in (motion, again))
    assert np.array_equal(proof.pose_bound, its.pose_bound)
    assert differing(proof.proven, its.proven) == []
    for one in (motion, again):
        for array in (one.times, *(a for channel in one.numbers.values() for a in channel.values())):
            with pytest.raises(ValueError, match="read-only"):
                array[0] = 0.0
        with pytest.raises(TypeError):
            one.closing.movements["strut_top"] = 1.0


def test_what_a_motion_is_fits_on_a_line(make_scene: Callable[..., Scene]) -> None:
    motion = simulate(make_scene(samples=2000, effects=("velocity", "acceleration", "wheel_angles", "toe")))
    for text, words in (
        (repr(motion), ("Motion by series", "2000 instants from 0 to 2 s", "position, velocity", "wheel")),
        (repr(motion.at([[0.5, 1.0]])), ("Samples", "2 instants from 0.5 to 1 s")),
        (repr(motion.at(0.5)), ("Samples", "at 0.5 s")),
        (repr(motion.at([])), ("no instants",)),
        (
            repr(motion.proof()),
            ("of 2000 instants", f"solved points within {motion.proof().bound.max():.2g} mm"),
        ),
        (
            repr(simulate(make_scene(effects=()), "newton")),
            ("Motion by newton", "9 instants", "; position; 1 note>"),
        ),
    ):
        assert len(text) <= 160
        assert "\n" not in text
        assert [word for word in words if word not in text] == []


def test_names_are_those_of_the_car_and_unknown_ones_are_refused_with_them(
    make_scene: Callable[..., Scene], table: dict[str, tuple[float, ...]]
) -> None:
    motion = simulate(make_scene())
    asked = {name: one for name, one in motion.numbers.items() if name not in STATES[len(NAMED) :]}
    for quantity, channel in asked.items():
        names = {"point": set(table), "body": {"knuckle"}}.get(channel.quantity.of, set(channel))
        assert set(channel) == names
        assert len(channel) == len(names)
        assert getattr(motion, quantity) is channel
        with pytest.raises(UnknownName) as caught:
            channel["wheel_center"]
        assert set(caught.value.valid) >= set(channel)
    # A number of another quantity is there, under that one's name.
    with pytest.raises(UnknownName, match=r"'travel' \(it stands under 'dimension'\)"):
        motion.wheel["travel"]
    with pytest.raises(UnknownName, match=r"'toe_by_travel' \(it stands under 'angle_gradient'\)"):
        motion.wheel["toe_by_travel"]
    with pytest.raises(UnknownName, match=r"'left\.toe'; there are"):
        motion.wheel["left.toe"]
    with pytest.raises(AttributeError, match="its quantities: position"):
        str(motion.places)


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
    if method is not PRINTED:
        assert {*error.limits} == {f"link lower_ball_joint - lower_arm_{end}" for end in ("front", "rear")}
        assert beyond_claims(part.proof(rates=True)) == []
    again = pickle.loads(pickle.dumps(part))
    assert str(again.status.error()) == str(error)


def test_nothing_is_kept_where_no_instant_was_solved(
    make_scene: Callable[..., Scene], monkeypatch: pytest.MonkeyPatch
) -> None:
    # No trial step is good enough: the chain cannot leave its start.
    monkeypatch.setattr("pointcoord.solve.taylor.confirmed", lambda *_: np.array(False))
    error = stopped_by(PointcoordError, make_scene(ARM, samples=2, stop=LAST), SERIES)
    assert error.partial is None
