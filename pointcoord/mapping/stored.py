"""The npz file that keeps a kinematic map.

It holds plain arrays and texts, nothing that runs when it is read: `format` and `version`; the scene as JSON;
ranges, order, halvings and tolerance; of each patch its corners (in parts of the smallest box), its
coefficients and its bounds; of each gap its corners and its reason; and `digest`, a SHA-256 of all of these.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import MapError, PointcoordError
from pointcoord.numerics.multi_index import powers
from pointcoord.patches.domain import Domain
from pointcoord.patches.flood import Key
from pointcoord.patches.jet import Jet
from pointcoord.patches.patches import Patches
from pointcoord.patches.reported_points import moving_points
from pointcoord.scene.scene_file import Scene
from pointcoord.simulation import scene_mechanism

Gaps = Sequence[tuple[Key, str]]
Content = tuple[Scene, float, Patches, Gaps]
"""A map: its scene, its tolerance, and its patches and gaps."""

FORMAT, VERSION = "pointcoord kinematic map", 1
ALLOWED = "a map as KinematicMap.save writes it"


def packed(content: Content) -> bytes:
    """A map as the bytes of its file."""
    scene, tolerance, patches, gaps = content
    reasons = list(dict.fromkeys(reason for _, reason in gaps))
    inputs = len(patches.domain.free)
    gap_low, gap_high = (
        np.array([key[end] for key, _ in gaps], dtype=np.int64).reshape(-1, inputs) for end in (0, 1)
    )
    arrays: dict[str, NDArray[Any]] = {
        "low": patches.low,
        "high": patches.high,
        "coefficients": patches.coefficients,
        "off": patches.off.value,
        "off_first": patches.off.first,
        "off_second": patches.off.second,
        "condition": patches.condition,
        "contraction": patches.contraction,
        "gap_low": gap_low,
        "gap_high": gap_high,
        "gap_reason": np.array([reasons.index(reason) for _, reason in gaps], dtype=np.int64),
    }
    head = json.dumps(
        {
            "scene": scene.model_dump(mode="json", exclude_none=True),
            "tolerance": tolerance,
            "ranges": {name: list(ends) for name, ends in patches.domain.ranges.items()},
            "order": patches.order,
            "halvings": patches.domain.halvings,
            "reasons": reasons,
        }
    )
    stream = BytesIO()
    words: dict[str, Any] = {"format": FORMAT, "version": VERSION, "head": head}
    np.savez(stream, **(words | arrays), digest=_digest(head, arrays))
    return stream.getvalue()


def unpacked(data: bytes, what: str) -> Content:
    """A map from the bytes of its file.

    Args:
        what: the file, in words.
    Raises:
        MapError: they are another file's, of another version, or damaged.
    """
    try:
        with np.load(BytesIO(data), allow_pickle=False) as archive:
            found = dict(archive)
    except Exception as error:  # what reading other bytes ends with is numpy's affair, and zipfile's
        raise MapError(what, "is no npz file, or a damaged one", ALLOWED) from error
    if str(found.pop("format", "")) != FORMAT:
        raise MapError(what, "is no kinematic map", ALLOWED)
    version = str(found.pop("version", "none"))
    if version != str(VERSION):
        raise MapError(what, f"is of version {version}", f"version {VERSION}; make it again")
    try:
        text, digest = str(found.pop("head")), str(found.pop("digest"))
        if _digest(text, found) != digest:
            raise MapError(what, "is damaged: its numbers are not those that were saved", ALLOWED)
        return _content(json.loads(text), found, what)
    except MapError:
        raise
    except (PointcoordError, LookupError, TypeError, ValueError) as error:
        raise MapError(what, f"does not hold a whole map: {error}", ALLOWED) from error


def _content(head: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]], what: str) -> Content:
    """A map from what its file holds."""
    scene = Scene.from_mapping(head["scene"], what)
    ranges = {name: (float(low), float(high)) for name, (low, high) in head["ranges"].items()}
    domain, order = Domain(scene_mechanism(scene), ranges, int(head["halvings"])), int(head["order"])
    points = moving_points(domain.mechanism.topology)
    wanted = (len(arrays["low"]), powers(len(domain.free), order).count, 3 * len(points))
    if arrays["coefficients"].shape != wanted:
        raise MapError(what, f"has coefficients of shape {arrays['coefficients'].shape}", f"{wanted}")
    patches = Patches(
        domain,
        order,
        arrays["low"],
        arrays["high"],
        arrays["coefficients"],
        Jet(arrays["off"], arrays["off_first"], arrays["off_second"]),
        arrays["condition"],
        arrays["contraction"],
    )
    corners = zip(arrays["gap_low"].tolist(), arrays["gap_high"].tolist(), strict=True)
    reasons = (head["reasons"][place] for place in arrays["gap_reason"])
    keys = ((tuple(low), tuple(high)) for low, high in corners)
    return scene, float(head["tolerance"]), patches, tuple(zip(keys, reasons, strict=True))


def _digest(text: str, arrays: Mapping[str, NDArray[Any]]) -> str:
    """SHA-256 of everything that a map is made of."""
    total = hashlib.sha256(text.encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        total.update(f"{name} {array.dtype.str} {array.shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()
