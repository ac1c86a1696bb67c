r"""Errors and condition numbers at many instants: computed at some of these, interpolated between them.

The coefficients c that take the doubts of the rows to a number (see `estimate`) depend on an instant only by
the targets of the inputs' rows and their rates, z = (u, u', u''), and so do the doubts r by rounding.
Between two instants A and B whose z are joined by a nearly straight line, an instant at the share s of that
line takes

    (1 - s) R(A) + s R(B),    R = sqrt(sum (c r)^2),

and likewise the sums of |c| with what is left of its own equations as computed, which is rounding itself and
is not interpolated. Both are norms, and a norm at a point of the line between two c is at most that
interpolation: it can only be too small by how c bends. So the instant M in the middle is computed too.
Where no R there is off by more than BENT of it, and none changes by more than CHANGED of it from A to B, M
joins the two, and what is left between is off by a quarter of BENT. A bend that changes its sign in the
middle is not seen there: it is a third order, and with orders that fall like a geometric series from CHANGED,
some CHANGED^3. MARGIN is added for both. Where the middle does not fit, the halves are tried in their turn,
down to single instants: what cannot be interpolated is computed, and unrelated instants all are.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from absolute.estimate import BodyMotion, by_row, further, totals
from absolute.mechanism import Mechanism
from absolute.solution import Array

# Instants from one that is computed to the next, at first.
APART = 128
# A motion of so many instants or fewer is computed: its instants are seldom near enough, and trying costs.
SHORT = 2 * APART
# An interval of so many or fewer is computed: another middle and its halves would cost as much.
FEWEST = 8
# Instants computed at once: what stays in fast memory.
BATCH = 32

BENT = 0.01
CHANGED = 0.1
MARGIN = 0.01
# A number so much smaller than the largest of its kind is made of the roundings of coefficients.
DUST = 1e-6
# How far beside the line a target may be, in parts of its way; and how far a rate, in parts of the largest.
# Along the way R changes by CHANGED at most, and with a rate as its square at most.
BESIDE = 0.02
RATE_BESIDE = 0.002

Places = NDArray[np.intp]


class Computed(NamedTuple):
    """An instant whose coefficients are computed.

    Attributes:
        magnitudes: of the coefficients, (4, rows, 3 * of these). rounded: (3, 3 * of these), R.
        grown: (3,) see `estimate.Sensitivity`. condition: number of the Jacobian.
    """

    magnitudes: Array
    rounded: Array
    grown: Array
    condition: float


def sampled(
    mechanism: Mechanism, motion: BodyMotion, series: Array, left: Array, conditions: bool
) -> tuple[Array, Array]:
    """Totals (3, N, 3 * of these) as of `estimate.totals`, and condition numbers (N,).

    Neither is smaller than computed at each instant, nor larger by more than about MARGIN and BENT.

    Args:
        motion, series, left: as of `totals`.
        conditions: False leaves the condition numbers 1.
    """
    count = len(left)
    z = mechanism.target_series(series)[..., mechanism.joint_rows :]
    known: Array = np.abs(left)
    found, numbers = np.empty((0, 0, 0)), np.ones(count)
    held: dict[int, Computed] = {}

    def compute(places: Places, hold: bool = True) -> None:
        nonlocal found
        for start in range(0, len(places), BATCH):
            these = places[start : start + BATCH]
            part = BodyMotion(*(array[these] for array in motion))
            total, made = totals(mechanism, part, series[these], left[these])
            if not found.size:
                found = np.empty((3, count, total.shape[-1]))
            found[:, these] = total
            if conditions:
                stack = mechanism.stack
                numbers[these] = np.linalg.cond(stack.jacobian(stack.place(part.rotation, part.origin)))
            magnitudes = np.abs(made.lengths)
            for row, place in enumerate(these.tolist() if hold else ()):
                held[place] = Computed(
                    magnitudes[:, row],
                    made.rounded[:, row],
                    made.grown[:, row],
                    float(numbers[place]),
                )

    if count <= SHORT:
        compute(np.arange(count), hold=False)
        return found, numbers
    ends = np.unique(np.append(np.arange(0, count, APART), count - 1))
    compute(ends)
    starts, stops = ends[:-1], ends[1:]
    while len(starts):
        few = stops - starts <= FEWEST
        compute(_inside(starts[few], stops[few])[1], hold=False)
        starts, stops = starts[~few], stops[~few]
        share, straight = along(z, starts, stops)
        middles = (starts + stops) // 2
        compute(middles)
        fits = np.zeros(len(starts), dtype=np.bool_)
        for number in np.flatnonzero(straight).tolist():
            a, m, b = int(starts[number]), int(middles[number]), int(stops[number])
            s = float(share[m])
            fits[number] = fit(held[a], held[m], held[b], s)
        halves = np.concatenate((starts, middles)), np.concatenate((middles, stops))
        joined = np.tile(fits, 2)
        share, straight = along(z, *halves)
        joined &= straight
        for a, b in zip(*(half[joined].tolist() for half in halves), strict=True):
            inner = slice(a + 1, b)
            found[:, inner], numbers[inner] = interpolated(held[a], held[b], share[inner, None], known[inner])
        starts, stops = (half[~joined] for half in halves)
    return found, numbers


def along(z: Array, starts: Places, stops: Places) -> tuple[Array, NDArray[np.bool_]]:
    """(N,) shares of the way of all instants inside some intervals that do not overlap, and of each interval
    whether these are close to the straight line between its ends.

    Args:
        z: (3, N, inputs) targets and their rates.
    """
    owner, inner = _inside(starts, stops)
    first, way = z[:, starts], z[:, stops] - z[:, starts]
    sizes = np.sqrt(np.maximum(*(np.vecdot(z[:, end], z[:, end]) for end in (starts, stops))))
    sizes[0] = np.sqrt(np.vecdot(way[0], way[0]))
    sizes[2] += sizes[1] * sizes[1]
    scaled = np.divide(way, sizes[..., None], out=np.zeros_like(way), where=sizes[..., None] > 0.0)
    length = np.vecdot(scaled, scaled).sum(axis=0)
    scaled = np.divide(
        scaled, (sizes * length)[..., None], out=np.zeros_like(way), where=(sizes * length)[..., None] > 0.0
    )
    off = z[:, inner] - first[:, owner]
    share = np.vecdot(off, scaled[:, owner]).sum(axis=0)
    off -= share[:, None] * way[:, owner]
    allowed = np.array([BESIDE, RATE_BESIDE, RATE_BESIDE])[:, None] * sizes
    good = (np.sqrt(np.vecdot(off, off)) <= allowed[:, owner]).all(axis=0) & (share >= 0.0) & (share <= 1.0)
    shares = np.zeros(z.shape[1])
    shares[inner] = share
    return shares, np.bincount(owner, ~good, len(starts)) == 0


def _inside(starts: Places, stops: Places) -> tuple[Places, Places]:
    """Of all instants inside some intervals, the number of the interval and their places."""
    counts = stops - starts - 1
    owner = np.repeat(np.arange(len(starts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts) + starts[owner] + 1


def fit(first: Computed, middle: Computed, last: Computed, share: float) -> bool:
    """Whether what is interpolated at the middle is what is computed there."""
    for a, m, b in (
        (first.rounded, middle.rounded, last.rounded),
        (first.grown, middle.grown, last.grown),
        (np.array([first.condition]), np.array([middle.condition]), np.array([last.condition])),
    ):
        dust = DUST * m.max(axis=-1, keepdims=True)
        bent = np.abs((1.0 - share) * a + share * b - m) <= BENT * m + dust
        changed = np.abs(b - a) <= CHANGED * m + dust
        # What is not finite fits nowhere.
        if not (bent & changed & np.isfinite(m)).all():
            return False
    return True


def interpolated(first: Computed, last: Computed, share: Array, known: Array) -> tuple[Array, Array]:
    """Totals and condition numbers of instants at shares (n, 1) of the way; `known` is (n, 3, rows)."""
    width = first.rounded.shape[-1]
    total, grown, condition = (
        np.zeros((3, len(share), width)),
        np.zeros((3, len(share))),
        np.zeros(len(share)),
    )
    for of, end in ((1.0 - share, first), (share, last)):
        total += by_row(np.asarray, known * of[..., None], end.magnitudes) + of * end.rounded[:, None]
        grown += of[:, 0] * end.grown[:, None]
        condition += of[:, 0] * end.condition
    whole = further(total, grown)
    dust = DUST * whole.max(axis=-1, keepdims=True) * (whole > 0.0)
    return (1.0 + MARGIN) * whole + dust, (1.0 + MARGIN) * condition
