"""What a study of bounds found, as text for people and as plain data for machines."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from validate.cars.closed_form import Closure
from validate.output.report import table
from validate.studies.bound_checks import BoundStudy, Check

Array = NDArray[np.float64]

LEVELS = (0.0, 0.01, 0.1, 0.5, 0.9, 0.99, 1.0)
STRUTS: tuple[Closure, ...] = ("drawn", "collinear")
FOLD = 1e-3  # nearer to the end than this part of the range, its fold is all that matters


@dataclass(frozen=True)
class Fit:
    """log10 y = slope log10 x + constant by least squares.

    Attributes:
        slope: its value.
        scatter: root mean square of what is left, in decades.
        poses: how many were fitted; errors of zero have no logarithm and are left out.
    """

    slope: float
    scatter: float
    poses: int


def fitted(x: Sequence[float], y: Sequence[float]) -> Fit:
    """Fit a power law; NaN with fewer than three different x."""
    pairs = [(math.log10(a), math.log10(b)) for a, b in zip(x, y, strict=True) if 0.0 < b < math.inf]
    if len({a for a, _ in pairs}) < 3:
        return Fit(math.nan, math.nan, len(pairs))
    u, v = np.array(pairs).T
    slope, constant = np.polyfit(u, v, 1)
    return Fit(float(slope), float(np.sqrt(np.mean((v - slope * u - constant) ** 2))), len(pairs))


def error_over_rounding(checks: Sequence[Check]) -> Fit:
    """Error over eps (condition size + far): slope 1 where rounding alone makes it."""
    return fitted([c.rounding / c.size for c in checks], [c.error / c.size for c in checks])


def error_over_distance(checks: Sequence[Check]) -> Fit:
    """The same over the distance from the end, near it, of cars near their origin: slope -1/2 at a fold."""
    near = [c for c in checks if c.distance < FOLD and c.far < 10.0 * c.size]
    return fitted([c.distance for c in near], [c.error / c.size for c in near])


def looseness(checks: Sequence[Check]) -> dict[str, Array]:
    """Bound over error, which is infinite where the error is zero, for both kinds of points."""
    with np.errstate(divide="ignore"):
        return {
            "solved points": np.array([c.bound for c in checks]) / [c.error for c in checks],
            "carried points": np.array([c.carried_bound for c in checks]) / [c.carried_error for c in checks],
        }


def of_strut(checks: Sequence[Check], strut: Closure) -> tuple[Check, ...]:
    """The checks of one kind of strut."""
    return tuple(check for check in checks if check.strut == strut)


def decades(checks: Sequence[Check]) -> list[tuple[int, list[Check]]]:
    """Checks by the decade of their distance from the end, nearest first."""
    found: dict[int, list[Check]] = {}
    for check in checks:
        found.setdefault(math.floor(math.log10(check.distance)), []).append(check)
    return sorted(found.items())


def bounds_text(study: BoundStudy) -> str:
    """The whole study."""
    parts = [
        *(
            _set_text(
                f"poses of struts {strut} held close to the end of an input", of_strut(study.held, strut)
            )
            for strut in STRUTS
        ),
        *(
            _set_text(
                f"instants of motions of struts {strut} that run towards one", of_strut(study.moving, strut)
            )
            for strut in STRUTS
        ),
        f"refused: {len(study.refusals)}",
        *(f"  {count}  {reason}" for reason, count in _reasons(study)),
        f"bounds below the error: {len(study.broken)}",
        *(f"  {_case(check)}" for check in study.broken),
    ]
    return "\n".join(parts)


def _set_text(name: str, checks: Sequence[Check]) -> str:
    if not checks:
        return f"{name}: none"
    by_rounding, by_distance = error_over_rounding(checks), error_over_distance(checks)
    rows = [
        (
            f"1e{decade} to 1e{decade + 1}",
            str(len(part)),
            f"{np.median([c.condition for c in part]):.1e}",
            f"{np.median([c.error / c.size for c in part]):.1e}",
            f"{np.median([c.loss for c in part]):.2g}",
            f"{max(c.loss for c in part):.2g}",
            f"{np.median(looseness(part)['solved points']):.3g}",
            f"{max(c.share for c in part):.2g}",
        )
        for decade, part in decades(checks)
    ]
    head = (
        *("distance / range", "poses", "condition", "error / size", "loss", "largest loss"),
        *("bound / error", "largest error / bound"),
    )
    quantiles = [
        (points, *(f"{np.quantile(ratio, level, method='nearest'):.3g}" for level in LEVELS))
        for points, ratio in looseness(checks).items()
    ]
    worst, most = max(checks, key=lambda c: c.share), max(checks, key=lambda c: c.loss)
    return "\n".join(
        [
            f"{len(checks)} {name}; medians, unless it says largest",
            "loss = error / (eps (condition size + far)), far the distance from the scene's origin",
            table(head, rows),
            table(("bound / error at", *(f"{100 * level:g}%" for level in LEVELS)), quantiles),
            f"error over eps (condition size + far): slope {by_rounding.slope:.3f} (rounding alone: 1), "
            f"scatter {by_rounding.scatter:.2f} decades",
            f"error over distance below {FOLD:g}: slope {by_distance.slope:.3f} (fold: -1/2), "
            f"scatter {by_distance.scatter:.2f} decades",
            f"nearest to its bound: {_case(worst)}",
            f"largest loss: {_case(most)}",
            "",
        ]
    )


def _case(check: Check) -> str:
    return (
        f"number {check.number}, {check.strut}, "
        f"{check.driven} {check.distance:.2e} from the end ({check.lock}), "
        f"t = {check.instant!r} s: error / bound {check.share:.3g}, error {check.error:.2e} mm, "
        f"carried points {check.carried_error:.2e} mm, condition {check.condition:.2e}, loss {check.loss:.2g}"
    )


def _reasons(study: BoundStudy) -> list[tuple[str, int]]:
    return Counter(refusal.reason for refusal in study.refusals).most_common()


def bounds_data(study: BoundStudy) -> dict[str, Any]:
    """The study as numbers, words, lists and mappings; None where a number is not finite."""
    return {
        "seed": study.seed,
        "refusals": [{"reason": reason, "poses": count} for reason, count in _reasons(study)],
        "broken": [_plain(asdict(check)) for check in study.broken],
        "held": {strut: _set_data(of_strut(study.held, strut)) for strut in STRUTS},
        "moving": {strut: _set_data(of_strut(study.moving, strut)) for strut in STRUTS},
    }


def _set_data(checks: Sequence[Check]) -> dict[str, Any]:
    ratios = looseness(checks)
    return {
        "count": len(checks),
        "bound_over_error": {
            points.replace(" ", "_"): {
                f"{level:g}": _finite(float(np.quantile(ratio, level, method="nearest"))) for level in LEVELS
            }
            for points, ratio in ratios.items()
            if len(ratio)
        },
        "error_over_rounding": _plain(asdict(error_over_rounding(checks))),
        "error_over_distance": _plain(asdict(error_over_distance(checks))),
        "largest_loss": max((c.loss for c in checks), default=None),
        "largest_error_over_bound": max((c.share for c in checks), default=None),
        "checks": [_plain(asdict(check)) for check in checks],
    }


def _plain(fields: dict[str, Any]) -> dict[str, Any]:
    return {key: _finite(value) if isinstance(value, float) else value for key, value in fields.items()}


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
