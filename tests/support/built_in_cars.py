"""Built-in scenes of steered cars with every wheel angle: each closure of a strut once, and a wishbone."""

from validate.paper.scenes import PAPER_SCENES

STEERED_CARS = (*PAPER_SCENES, "off-axis-strut", "double-wishbone")
