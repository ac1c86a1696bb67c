"""Motions are read by name, cannot be written, and come back whole from a pickle."""

import pickle
from collections.abc import Callable
from dataclasses import fields

import numpy as np
import pytest

from pointcoord import Motion, Samples, Scene, UnknownName, simulate
from pointcoord.effects.point_states import NAMED, STATES
from pointcoord.method import METHODS, Method
from validate.paper.printed import PRINTED


def assert_same(one: Motion, other: Motion) -> None:
    """Numbers and proofs, to the last bit, and what is said of them."""
    assert (one.method, one.notes, one.unit, one.work) == (other.method, other.notes, other.unit, other.work)
    assert one.closing == other.closing
    assert_same_numbers(one, other)
    for field in fields(one.proof()):
        first, second = (getattr(motion.proof(), field.name) for motion in (one, other))
        assert np.array_equal(first, second), field.name


def assert_same_numbers(one: Samples, other: Samples) -> None:
    assert np.array_equal(one.times, other.times)
    assert list(one.numbers) == list(other.numbers)
    for channel, again in zip(one.numbers.values(), other.numbers.values(), strict=True):
        assert (channel.quantity, channel.topology) == (again.quantity, again.topology)
        assert channel.keys() == again.keys()
        assert all(np.array_equal(channel[name], again[name]) for name in channel)


@pytest.mark.parametrize("method", [*METHODS.values(), PRINTED], ids=str)
def test_a_motion_is_pickled_with_all_that_it_can_be_asked_for_and_stays_read_only(method: Method) -> None:
    motion = simulate("bounce" if method is PRINTED else "bounce-on-a-heaving-chassis", method)
    again = pickle.loads(pickle.dumps(motion))
    assert_same(motion, again)
    if method.dense:
        assert_same_numbers(motion.at([0.3, 0.1]), again.at([0.3, 0.1]))
        assert_same_numbers(motion.at(0.3), pickle.loads(pickle.dumps(motion.at(0.3))))
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
    with pytest.raises(AttributeError, match="its quantities: position"):
        str(motion.places)
