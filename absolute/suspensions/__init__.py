"""The types of suspension that the model knows, by the name that a scene gives."""

from collections.abc import Mapping

from absolute.errors import DescriptionError
from absolute.mapping import ReadOnly
from absolute.suspensions.double_wishbone import double_wishbone
from absolute.suspensions.macpherson import macpherson
from absolute.suspensions.suspension import Suspension

SUSPENSIONS: Mapping[str, Suspension] = ReadOnly(
    {
        "macpherson": macpherson,
        "double_wishbone": double_wishbone,
    }
)


def suspension_of(name: str) -> Suspension:
    """The type of a name.

    Raises:
        DescriptionError: there is none; it names those there are.
    """
    if name not in SUSPENSIONS:
        raise DescriptionError(
            f"there is no suspension {name!r}; it must be one of {list(SUSPENSIONS)}", "suspension", name
        )
    return SUSPENSIONS[name]
