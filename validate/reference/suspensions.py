"""The suspensions that the reference knows: by type and closure, one line each."""

from __future__ import annotations

from collections.abc import Mapping

from validate.reference.double_wishbone import CLOSURES as DOUBLE_WISHBONE
from validate.reference.errors import BadInputError
from validate.reference.linkage import Linkage
from validate.reference.macpherson import CLOSURES as MACPHERSON

SUSPENSIONS: dict[str, Mapping[str, Linkage]] = {
    "macpherson": MACPHERSON,
    "double_wishbone": DOUBLE_WISHBONE,
}
SUSPENSION = "macpherson"
CLOSURE = "drawn"


def linkage_for(suspension: str = SUSPENSION, closure: str = CLOSURE) -> Linkage:
    """The linkage of a suspension under a closure.

    Raises:
        BadInputError: there is no such suspension, or it has no such closure.
    """
    if suspension not in SUSPENSIONS:
        raise BadInputError("suspension", suspension, " or ".join(repr(name) for name in SUSPENSIONS))
    closures = SUSPENSIONS[suspension]
    if closure not in closures:
        raise BadInputError("closure", closure, " or ".join(repr(name) for name in closures))
    return closures[closure]
