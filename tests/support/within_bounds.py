"""Numbers by quantity and name held to others, within what is proven of both."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from pointcoord import Samples
from pointcoord.numerics.arrays import Array
from pointcoord.results.proof import Proof

Numbers = Mapping[str, Mapping[str, Array]]


def bounds_of(proof: Proof) -> Numbers:
    """What is proven and what is claimed before: neither may be passed."""
    return {
        quantity: {name: np.minimum(bound, proof.expected[quantity][name]) for name, bound in bounds.items()}
        for quantity, bounds in proof.proven.items()
    }


def outside(found: Numbers, right: Numbers, *bounds: Numbers) -> list[tuple[str, str]]:
    """The numbers that are further from what is right than all the bounds of them together.

    So is one that has no finite bound, and one where there is none.
    """
    wrong = []
    for quantity, arrays in found.items():
        for name, numbers in arrays.items():
            meant = right[quantity][name]
            allowed = sum(of[quantity][name] for of in bounds)
            held = np.isfinite(allowed) & (np.abs(numbers - meant) <= allowed)
            if not np.where(np.isfinite(meant), held, ~np.isfinite(numbers)).all():
                wrong.append((quantity, name))
    return wrong


def beyond_claims(proof: Proof) -> list[tuple[str, str]]:
    """The numbers that are proven to be off by no less than their method claims, if it is right.

    A proof looks at numbers and equations and not at how they were solved: where a number is wrong, or is
    another car's, its proof is as wide as that. What is claimed to be off by nothing must be.
    """
    return [
        (quantity, name)
        for quantity, arrays in proof.proven.items()
        for name, proven in arrays.items()
        if not (proven <= proof.expected[quantity][name]).all()
    ]


def differing(one: Numbers, other: Numbers) -> list[tuple[str, str]]:
    """The numbers that are not the same to the last bit; both have all of them."""
    return [
        (quantity, name)
        for quantity in {**one, **other}
        for name in {**one[quantity], **other[quantity]}
        if not np.array_equal(one[quantity][name], other[quantity][name])
    ]


def among(samples: Samples, which: Array) -> Samples:
    """Samples at some of their instants."""
    numbers = {
        quantity: channel.with_arrays({name: array[which] for name, array in channel.items()})
        for quantity, channel in samples.numbers.items()
    }
    return Samples(samples.times[which], numbers)
