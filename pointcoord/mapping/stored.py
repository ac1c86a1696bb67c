"""The npz file of a kinematic map.

The file holds plain arrays and texts, and no code that runs when it is read: `format` and `version`; `head`,
JSON with the scene, ranges, order, halvings, tolerance and gaps (corners and reason of each); the corners of
all patches (in units of the smallest box), their coefficients and error bounds; and `digest`, a SHA-256 of
`head` and the arrays.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pointcoord.errors import PointcoordError, WrongArgument
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

FORMAT, VERSION = "pointcoord kinematic map", 2
OFF = ("off", "off_first", "off_second")
ALLOWED = "a map as KinematicMap.save writes it"


def packed(content: Content) -> bytes:
    """The bytes of the file of a map."""
    scene, tolerance, patches, gaps = content
    arrays = {
        "low": patches.low,
        "high": patches.high,
        "coefficients": patches.coefficients,
        **dict(zip(OFF, patches.off.parts, strict=True)),
    }
    head = json.dumps(
        {
            "scene": scene.model_dump(mode="json", exclude_none=True),
            "tolerance": tolerance,
            "ranges": dict(patches.domain.ranges),
            "order": patches.order,
            "halvings": patches.domain.halvings,
            "gaps": gaps,
        }
    )
    words: dict[str, Any] = {"format": FORMAT, "version": VERSION, "head": head}
    stream = BytesIO()
    np.savez(stream, **(words | arrays), digest=_digest(head, arrays))
    return stream.getvalue()


def unpacked(data: bytes, what: str) -> Content:
    """A map from the bytes of its file.

    Args:
        what: name of the file for messages.
    Raises:
        WrongArgument: the bytes are not a map, are of another version, or are damaged.
    """
    try:
        with np.load(BytesIO(data), allow_pickle=False) as archive:
            found = dict(archive)
    except Exception as error:  # numpy and zipfile may raise anything when they read other bytes
        raise WrongArgument(what, "is not an npz file, or is damaged", ALLOWED) from error
    if str(found.pop("format", "")) != FORMAT:
        raise WrongArgument(what, "is not a kinematic map", ALLOWED)
    version = str(found.pop("version", "none"))
    if version != str(VERSION):
        raise WrongArgument(what, f"is of version {version}", f"version {VERSION}; make it again")
    try:
        text, digest = str(found.pop("head")), str(found.pop("digest"))
        if _digest(text, found) != digest:
            raise WrongArgument(what, "is damaged: its content differs from what was saved", ALLOWED)
        return _content(json.loads(text), found, what)
    except WrongArgument:
        raise
    except (PointcoordError, LookupError, TypeError, ValueError) as error:
        raise WrongArgument(what, f"does not hold a complete map: {error}", ALLOWED) from error


def _content(head: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]], what: str) -> Content:
    """A map from the head and the arrays of its file."""
    scene = Scene.from_mapping(head["scene"], what)
    ranges = {name: (float(low), float(high)) for name, (low, high) in head["ranges"].items()}
    domain, order = Domain(scene_mechanism(scene), ranges, int(head["halvings"])), int(head["order"])
    points = moving_points(domain.mechanism.topology)
    wanted = (len(arrays["low"]), powers(len(domain.free), order).count, 3 * len(points))
    if arrays["coefficients"].shape != wanted:
        raise WrongArgument(what, f"has coefficients of shape {arrays['coefficients'].shape}", f"{wanted}")
    corners = arrays["low"], arrays["high"]
    off = Jet(*(arrays[name] for name in OFF))
    patches = Patches(domain, order, *corners, arrays["coefficients"], off)
    gaps = (((tuple(low), tuple(high)), reason) for (low, high), reason in head["gaps"])
    return scene, float(head["tolerance"]), patches, tuple(gaps)


def _digest(text: str, arrays: Mapping[str, NDArray[Any]]) -> str:
    """SHA-256 of the head and the arrays, with their names, types and shapes."""
    total = hashlib.sha256(text.encode())
    for name in sorted(arrays):
        array = np.ascontiguousarray(arrays[name])
        total.update(f"{name} {array.dtype.str} {array.shape}".encode())
        total.update(array.tobytes())
    return total.hexdigest()
