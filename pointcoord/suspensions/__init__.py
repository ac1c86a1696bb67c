"""The linkages that can be solved, by the name that a scene gives them."""

from pointcoord.suspensions.macpherson import MACPHERSON, MACPHERSON_PRINTED
from pointcoord.topology import Topology

TOPOLOGIES: dict[str, Topology] = {"macpherson": MACPHERSON}
"""Each linkage with slides that have coordinates of their own."""

PRINTED_TOPOLOGIES: dict[str, Topology] = {"macpherson": MACPHERSON_PRINTED}
"""Each linkage with its constraints as a paper prints them."""
