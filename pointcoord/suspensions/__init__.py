"""The types of suspension that can be solved, by the name that a scene gives them."""

from collections.abc import Mapping

from pointcoord.suspensions.double_wishbone import DOUBLE_WISHBONE
from pointcoord.suspensions.macpherson import MACPHERSON
from pointcoord.suspensions.suspension import Suspension

SUSPENSIONS: Mapping[str, Suspension] = {
    suspension.type: suspension for suspension in (MACPHERSON, DOUBLE_WISHBONE)
}
"""Everything that is said about types, closures, points and inputs is read off these."""
