"""How long a series may be, and of which order, is told from its terms as it is said."""

import pytest

from pointcoord.linkage.mechanism import Mechanism
from pointcoord.solve.assembly import assemble
from pointcoord.solve.taylor import (
    Chain,
    Settings,
    build_chain,
)
from pointcoord.time_functions import Sine, TimeFunction


def chain_of(mechanism: Mechanism, functions: dict[str, TimeFunction], start: float, stop: float) -> Chain:
    pose = assemble(mechanism, {name: f.series(start, 0)[..., 0] for name, f in functions.items()})
    return build_chain(mechanism, functions, pose, start, stop, Settings(1e-10, derivative=2))


def swing(since: float) -> dict[str, TimeFunction]:
    return {"arm_angle": Sine(0.3, 2.0, -2.0 * since, 1.4), "rack": Sine(20.0, 3.0, -3.0 * since)}


def test_a_motion_is_cut_the_same_way_whenever_it_begins(strut: Mechanism) -> None:
    at_once, later = (chain_of(strut, swing(since), since, since + 3.0) for since in (0.0, 1024.0))
    assert [s.order for s in later.segments] == [s.order for s in at_once.segments]
    for one, other in zip(at_once.segments, later.segments, strict=True):
        # The phases are rounded, by some 1e-13.
        assert other.stop - 1024.0 == pytest.approx(one.stop, abs=1e-6)
