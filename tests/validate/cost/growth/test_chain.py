"""The chain of linkages: its closed form closes it, and every solver finds that and nothing else."""

from itertools import pairwise

import numpy as np
import pytest

from pointcoord.linkage.constraints.link import Link
from validate.cost.growth.chain import LANE, RISE, ROCKERS, SWING, FourBarChain
from validate.cost.growth.task import WrongNumber
from validate.cost.growth.unknowns import INSTANTS, METHODS, TOLERANCE, LongChain

TIMES = np.linspace(0.0, 1.0, 41)
# A tip is rounded by half a unit in the last place of 256 mm at most, 2^-46 mm, along each axis; a length
# between two of them by six of these, and the root and the difference add less than another.
LENGTH = 8.0 * 2.0**-46


@pytest.mark.parametrize("rockers", [1, 2, 5, 6])
def test_closed_form_keeps_every_link_at_its_drawn_length(rockers: int) -> None:
    chain = FourBarChain(rockers)
    tips, points = chain.closed_form(TIMES), chain.points
    places = {name: np.broadcast_to(place, (len(TIMES), 3)) for name, place in points.items()}
    places |= {name: tips[:, j] for j, name in enumerate(chain.tips)}
    links = [c for c in chain.topology.constraints if isinstance(c, Link)]
    assert len(links) == 3 * rockers - 1
    for link in links:
        length = np.linalg.norm(places[link.start] - places[link.end], axis=-1)
        drawn = np.linalg.norm(points[link.start] - points[link.end])
        assert np.abs(length - drawn).max() <= LENGTH, link.name


def test_closed_form_follows_the_drive_and_stays_on_the_drawn_branch() -> None:
    chain = FourBarChain(4)
    tips = chain.closed_form(TIMES)
    angle = SWING.series(TIMES, 0)[:, 0]
    # The angle is rounded by 2^-52 rad, on an arm of 100 mm, and the sine and the product once each.
    assert np.abs(tips[:, 0, 2] - ROCKERS[0] * np.cos(angle)).max() <= 4.0 * ROCKERS[0] * 2.0**-52
    # The double nearest to a quarter turn is 2^-53 rad off at most.
    drawn = np.array([chain.points[name] for name in chain.tips])
    assert np.abs(tips[0] - drawn).max() <= 2.0**-53 * ROCKERS[0]
    assert (np.abs(np.diff(tips, axis=0)) < 0.1 * ROCKERS[0]).all()
    # The follower stays on the far side of the line from the even tip to the odd pivot.
    y, z = tips[:, 0, 1], tips[:, 0, 2]
    across = -y * (tips[:, 1, 2] - z) - (RISE - z) * (tips[:, 1, 1] - y)
    assert (across < 0.0).all() or (across > 0.0).all()


def test_rockers_of_a_long_chain_turn_as_those_of_the_single_linkage() -> None:
    single, long = (FourBarChain(n).closed_form(TIMES) for n in (2, 501))
    assert np.array_equal(long[:, :2], single)
    assert np.array_equal(long[:, 500, 1:], single[:, 0, 1:])
    assert np.array_equal(long[:, 499, 1:], single[:, 1, 1:])
    assert (np.ptp(long[:, :, 2], axis=0) > 30.0).all()
    assert long[0, 500, 0] == 500 * LANE


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("unknowns", [6, 15, 48])
def test_every_method_finds_the_closed_form_and_the_single_linkage(method: str, unknowns: int) -> None:
    found = {}
    for size in (6, unknowns):
        task = LongChain(method, size)
        run = task.prepare()
        found[size] = run.output(run.solve())
        error = task.check(found[size])["position"]
        # Series and Newton keep to the tolerance; a step of scipy that ends at 1e-12 of the coordinates
        # leaves less, because its error falls faster than its steps.
        assert error.largest <= TOLERANCE
        assert error.numbers == len(INSTANTS) * size
    assert np.abs(found[unknowns][:, :2] - found[6]).max() <= 2.0 * TOLERANCE


def test_another_assembly_is_no_answer_and_a_small_error_is_told_with_its_size() -> None:
    task = LongChain("series", 12)
    right = task.chain.closed_form(INSTANTS)
    off = right.copy()
    off[3, 2, 1] += 1e-6
    assert task.check(off)["position"].largest == pytest.approx(1e-6, rel=1e-6)
    other = right.copy()
    # The last rocker on the other side of the line from the tip before it to its own pivot.
    pivot, before = np.array([0.0, RISE]), right[:, 2, 1:]
    along = (pivot - before) / np.linalg.norm(pivot - before, axis=-1)[:, None]
    foot = before + along * np.sum((right[:, 3, 1:] - before) * along, axis=-1)[:, None]
    other[:, 3, 1:] = 2.0 * foot - right[:, 3, 1:]
    rods = [np.linalg.norm(tips[:, 3] - tips[:, 2], axis=-1) for tips in (right, other)]
    assert np.allclose(*rods, rtol=1e-12)
    with pytest.raises(WrongNumber, match="tip_3"):
        task.check(other)
    with pytest.raises(WrongNumber, match="tip_0 is nan"):
        task.check(np.full_like(right, np.nan))


def test_a_chain_has_three_unknowns_a_rocker() -> None:
    for rockers, chain in ((5, FourBarChain.with_unknowns(15)), (500, FourBarChain.with_unknowns(1500))):
        assert chain.rockers == rockers
        assert chain.topology.layout.unknowns == 3 * rockers
        assert all(one != other for one, other in pairwise(chain.tips))
    with pytest.raises(ValueError, match="allowed: 3, 6, 9"):
        FourBarChain.with_unknowns(16)
