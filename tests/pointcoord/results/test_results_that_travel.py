"""Motions come back from other processes whole, and say in a line what they are."""

import pickle
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import fields
from multiprocessing import get_context

import numpy as np
import pytest

from pointcoord import AssemblyError, Motion, Samples, Scene, built_in_scenes, simulate
from pointcoord.method import METHODS, NEWTON, SERIES, Method
from validate.paper.printed import PRINTED

HEAVE = {"sine": {"amplitude": 5.0, "angular_frequency": 2.0}}
TABLE = {"table": {"times": [0.0, 0.5, 1.0, 2.0], "values": [0.0, 5.0, 3.0, -4.0]}}
SINE = {"sine": {"amplitude": 0.3, "angular_frequency": 2.3, "phase": 0.4, "offset": 1.5}}


def assert_same(one: Samples, other: Samples) -> None:
    assert np.array_equal(one.times, other.times)
    assert list(one.numbers) == list(other.numbers)
    for channel, again in zip(one.numbers.values(), other.numbers.values(), strict=True):
        assert (channel.quantity, channel.left_out) == (again.quantity, again.left_out)
        assert channel.keys() == again.keys()
        assert all(np.array_equal(channel[name], again[name]) for name in channel)


def assert_same_proof(one: Motion, other: Motion) -> None:
    first, second = one.proof(), other.proof()
    for field in fields(first):
        assert np.array_equal(getattr(first, field.name), getattr(second, field.name)), field.name


@pytest.mark.parametrize("method", [SERIES, NEWTON, PRINTED], ids=str)
@pytest.mark.parametrize("law", [SINE, [0.8, 0.25]], ids=["sine", "polynomial"])
def test_a_motion_is_pickled_with_all_that_it_can_be_asked_for(
    make_scene: Callable[..., Scene], method: Method, law: object
) -> None:
    motion = simulate(make_scene(law, TABLE, heave=HEAVE), method)
    again = pickle.loads(pickle.dumps(motion))
    assert_same(motion, again)
    assert_same_proof(motion, again)
    assert (again.method, again.notes, again.unit) == (motion.method, motion.notes, motion.unit)
    assert again.work == motion.work
    if method.by_series:
        assert_same(motion.at([0.3, 1.7]), again.at([0.3, 1.7]))
        assert_same(motion.at(0.3), pickle.loads(pickle.dumps(motion.at(0.3))))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", built_in_scenes())
def test_motions_of_the_built_in_scenes_are_pickled_with_their_closing(name: str, method: Method) -> None:
    motion = simulate(Scene.load(name), method)
    again = pickle.loads(pickle.dumps(motion))
    assert_same(motion, again)
    assert_same_proof(motion, again)
    assert again.closing == motion.closing
    with pytest.raises(TypeError):
        again.closing.movements["strut_top"] = 1.0


def test_arrays_of_a_pickled_motion_cannot_be_written(make_scene: Callable[..., Scene]) -> None:
    again = pickle.loads(pickle.dumps(simulate(make_scene())))
    with pytest.raises(ValueError, match="read-only"):
        again.times[0] = 1.0
    with pytest.raises(ValueError, match="read-only"):
        again.position["wheel_centre"][0] = 1.0


def test_motions_and_errors_come_back_from_a_process_pool(make_scene: Callable[..., Scene]) -> None:
    good, locked = make_scene(SINE, heave=HEAVE), make_scene([1.6], [0.0, 100.0])
    # A new interpreter, that shares nothing with this one.
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        motion = pool.submit(simulate, good).result()
        with pytest.raises(AssemblyError, match="bring 'rack' back") as caught:
            pool.submit(simulate, locked).result()
    here = simulate(good)
    assert_same(motion, here)
    assert_same(motion.at([0.1, 1.9]), here.at([0.1, 1.9]))
    assert_same_proof(motion, here)
    with pytest.raises(AssemblyError) as alone:
        simulate(locked)
    assert caught.value.reached == alone.value.reached
    partial, own = caught.value.partial, alone.value.partial
    assert isinstance(partial, Motion)
    assert isinstance(own, Motion)
    assert_same(partial, own)
    assert_same_proof(partial, own)


def test_what_a_motion_is_fits_on_a_line_or_two(make_scene: Callable[..., Scene]) -> None:
    motion = simulate(make_scene(samples=2000))
    for text, words in (
        (repr(motion), ("Motion by series", "2000 instants from 0 to 2 s", "position, velocity", "wheel")),
        (repr(motion.at([[0.5, 1.0]])), ("Samples", "2 instants from 0.5 to 1 s")),
        (repr(motion.at(0.5)), ("Samples", "at 0.5 s")),
        (repr(motion.at([])), ("no instants",)),
        (
            repr(simulate(make_scene(effects=()), "newton")),
            ("Motion by newton", "9 instants", "; position; 1 note>"),
        ),
    ):
        assert len(text) <= 160
        assert "\n" not in text
        assert [word for word in words if word not in text] == []
