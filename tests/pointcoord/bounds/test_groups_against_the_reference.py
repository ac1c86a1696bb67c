"""Bounds of neighbours that are proven together hold of the error against the reference's digits."""

import mpmath
import numpy as np
import pytest

from pointcoord import Scene, simulate
from pointcoord.effects.registry import EFFECTS
from validate.adjudication.reference_solution import inputs_at, reference_instant


@pytest.mark.parametrize("name", ["bounce-on-a-heaving-chassis", "off-axis-strut", "double-wishbone"])
def test_no_number_is_off_by_more_than_its_bound(name: str) -> None:
    scene = Scene.load(name).model_copy(update={"effects": tuple(EFFECTS)})
    motion = simulate(scene)
    instants = np.linspace(motion.times[0], motion.times[-1], 3000)
    samples = motion.at(instants)
    proof = motion.proof_of(samples, rates=True)
    closest: dict[str, float] = {}
    for k in np.linspace(1, len(instants) - 2, 24).astype(int).tolist():
        exact = reference_instant(scene, inputs_at(scene, float(instants[k])))
        angles = {name: [angle] for name, angle in exact.effects.items()}
        with mpmath.workdps(60):
            for quantity, channel in samples.numbers.items():
                own = angles if quantity == "wheel" else getattr(exact, quantity)
                for part, numbers in channel.items():
                    reported = np.atleast_1d(numbers[k]).tolist()
                    bounds = np.atleast_1d(proof.proven[quantity][part][k]).tolist()
                    for value, bound, x in zip(reported, bounds, own[part], strict=True):
                        off = abs(value - x)
                        # The reference itself is proven to some 60 digits.
                        assert off <= bound + 1e-50 * (1.0 + abs(x)), (quantity, part, k)
                        if off > 1e-20:
                            closest[quantity] = max(closest.get(quantity, 0.0), float(off / bound))
    # Of every quantity some number is off by most of its bound.
    assert min(closest.values()) > 0.5, closest
