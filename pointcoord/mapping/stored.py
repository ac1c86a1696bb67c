"""The numbers of a kinematic map, and the npz file that keeps them.

The file holds plain arrays and texts, nothing that runs when it is read: `format` and `version`; the scene as
JSON; ranges, order, halvings and tolerance; of each patch its corners (in parts of the smallest box), its
coefficients and its bounds; of each gap its corners and its reason; and `digest`, a SHA-256 of all of these.
"""

from __future__ import annotations

import hashlib
import json
import zipfile
import zlib
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MapError, PointcoordError
from pointcoord.linkage.mechanism import Mechanism
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.domain import Domain
from pointcoord.patches.flood import Cover
from pointcoord.patches.jet import Jet
from pointcoord.patches.reported_points import moving_points
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import scene_mechanism

Array = NDArray[np.float64]
Whole = NDArray[np.int64]

FORMAT, VERSION = "pointcoord kinematic map", 1
DAMAGED = (
    ValueError,
    EOFError,
    AttributeError,
    KeyError,
    TypeError,
    MemoryError,  # a size that was never written
    RuntimeError,  # a way of packing that there is not, or a password
    zipfile.BadZipFile,
    zlib.error,
)
"""What reading other bytes than those of a map's file ends with."""


@dataclass(frozen=True)
class Stored:
    """Patches and gaps of a map, read-only.

    Attributes:
        ranges: of every driving input.
        order: total degree of the series. halvings: of a range, down to the smallest box.
        low, high: corners of the patches, in smallest boxes, (P, p).
        coefficients: of the reported points, (P, powers, 3 points), mm from the mechanism's origin.
        off: errors of their sums and of the derivatives of these by parts of the half widths, (P, 3
        points), mm. condition, contraction: of each patch, (P,). gap_low, gap_high: corners of what is not
        covered, (G, p). gap_reason: place among the reasons, (G,). reasons: in words.
    """

    ranges: Mapping[str, tuple[float, float]]
    order: int
    halvings: int
    low: Whole
    high: Whole
    coefficients: Array
    off: Jet
    condition: Array
    contraction: Array
    gap_low: Whole
    gap_high: Whole
    gap_reason: Whole
    reasons: tuple[str, ...]

    def __post_init__(self) -> None:
        for array in self.arrays.values():
            array.setflags(write=False)

    @classmethod
    def of(cls, domain: Domain, order: int, cover: Cover, reasons: tuple[str, ...]) -> Stored:
        """What a cover leaves to be kept."""
        assert cover.patches is not None  # a map without patches is refused
        patches = cover.patches
        corners = [np.array([key[end] for key, _ in cover.given_up], dtype=np.int64) for end in (0, 1)]
        gap_low, gap_high = (corner.reshape(-1, len(domain.free)) for corner in corners)
        reason = np.array([reasons.index(reason) for _, reason in cover.given_up], dtype=np.int64)
        return cls(
            dict(domain.ranges),
            order,
            domain.halvings,
            patches.low,
            patches.high,
            patches.coefficients,
            patches.off,
            patches.condition,
            patches.contraction,
            gap_low,
            gap_high,
            reason,
            reasons,
        )

    @property
    def arrays(self) -> dict[str, NDArray[Any]]:
        """The arrays by their names in the file."""
        return {
            "low": self.low,
            "high": self.high,
            "coefficients": self.coefficients,
            "off": self.off.value,
            "off_first": self.off.first,
            "off_second": self.off.second,
            "condition": self.condition,
            "contraction": self.contraction,
            "gap_low": self.gap_low,
            "gap_high": self.gap_high,
            "gap_reason": self.gap_reason,
        }


def write(path: str | PathLike[str], scene: Scene, tolerance: float, stored: Stored) -> None:
    """Write a map; see `KinematicMap.save`."""
    what = _named(path)
    head = {
        "scene": scene.model_dump(mode="json", exclude_none=True),
        "tolerance": tolerance,
        "ranges": {name: list(ends) for name, ends in stored.ranges.items()},
        "order": stored.order,
        "halvings": stored.halvings,
        "reasons": list(stored.reasons),
    }
    text = json.dumps(head)
    words = {
        "format": np.array(FORMAT),
        "version": np.array(VERSION),
        "head": np.array(text),
        "digest": np.array(_digest(text, stored.arrays)),
    }
    try:
        with open(path, "wb") as stream:
            _save(stream, words | stored.arrays)
    except OSError as error:
        raise MapError(what, f"cannot be written: {error.strerror}", "a path to write to") from error


def _named(path: object) -> str:
    """A file in words.

    Raises:
        MapError: what is given is no path.
    """
    if not isinstance(path, str | PathLike):
        raise MapError(f"path {path!r}", f"is a {type(path).__name__}", "the path of a file")
    return f"file {fspath(path)!r}"


def _save(stream: BinaryIO, arrays: Mapping[str, NDArray[Any]]) -> None:
    """An npz file: a zip archive of one npy file for each array."""
    with zipfile.ZipFile(stream, "w") as archive:
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w", force_zip64=True) as part:
                np.lib.format.write_array(part, np.asarray(array, order="C"), allow_pickle=False)


def read(path: str | PathLike[str]) -> tuple[Scene, float, Stored]:
    """Read a map; see `KinematicMap.load`."""
    what = _named(path)
    allowed = "a map as KinematicMap.save writes it"
    try:
        with open(path, "rb") as stream, np.load(stream, allow_pickle=False) as file:
            found = {name: file[name] for name in file.files}
    except FileNotFoundError as error:
        raise MapError(what, "does not exist", allowed) from error
    except OSError as error:
        raise MapError(what, f"cannot be read: {error.strerror or error}", allowed) from error
    except DAMAGED as error:
        raise MapError(what, "is no npz file, or a damaged one", allowed) from error
    if str(found.get("format", "")) != FORMAT:
        raise MapError(what, "is no kinematic map", allowed)
    if str(found.get("version", "")) != str(VERSION):
        raise MapError(
            what, f"is of version {found.get('version', 'none')}", f"version {VERSION}; make it again"
        )
    try:
        text, digest = str(found.pop("head")), str(found.pop("digest"))
        arrays = {name: found[name] for name in found if name not in ("format", "version")}
        if _digest(text, arrays) != digest:
            raise MapError(what, "is damaged: its numbers are not those that were saved", allowed)
        head = json.loads(text)
        scene = Scene.from_mapping(head["scene"], what)
        stored = Stored(
            {name: (float(low), float(high)) for name, (low, high) in head["ranges"].items()},
            int(head["order"]),
            int(head["halvings"]),
            arrays["low"],
            arrays["high"],
            arrays["coefficients"],
            Jet(arrays["off"], arrays["off_first"], arrays["off_second"]),
            arrays["condition"],
            arrays["contraction"],
            arrays["gap_low"],
            arrays["gap_high"],
            arrays["gap_reason"],
            tuple(head["reasons"]),
        )
        _require_shapes(what, scene_mechanism(scene), stored)
        return scene, float(head["tolerance"]), stored
    except MapError:
        raise
    except (KeyError, ValueError, TypeError, PointcoordError) as error:
        raise MapError(what, f"does not hold a whole map: {error}", allowed) from error


def _require_shapes(what: str, mechanism: Mechanism, stored: Stored) -> None:
    """Find arrays that do not fit the scene's points."""
    free = sum(low < high for low, high in stored.ranges.values())
    wanted = (len(stored.low), powers(free, stored.order).count, 3 * len(moving_points(mechanism.topology)))
    if stored.coefficients.shape != wanted:
        raise MapError(what, f"has coefficients of shape {stored.coefficients.shape}", f"{wanted}")


def _digest(text: str, arrays: Mapping[str, NDArray[Any]]) -> str:
    """SHA-256 of everything that a map is made of."""
    total = hashlib.sha256(text.encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        total.update(f"{name} {array.dtype.str} {array.shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()
