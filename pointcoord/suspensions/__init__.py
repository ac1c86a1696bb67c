"""The linkages that can be solved, by the name that a scene gives them and by how it closes its drawing."""

from pointcoord.linkage.topology import Topology
from pointcoord.suspensions.macpherson import COLLINEAR, DRAWN

TOPOLOGIES: dict[str, dict[str, Topology]] = {"macpherson": {"drawn": DRAWN, "collinear": COLLINEAR}}
"""Each linkage by its closures: `drawn` takes the drawing as it stands, others put its points in place."""
