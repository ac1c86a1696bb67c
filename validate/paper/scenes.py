"""The built-in scenes that `validate` takes without a name."""

from pointcoord import built_in_scenes

# The paper's examples, and the chassis motion, which is its third degree of freedom. Only these scenes are
# solved with the paper's formulas as printed.
PAPER_SCENES = ("bounce", "steer", "bounce-and-steer", "bounce-on-a-heaving-chassis")
DEFAULT_SCENES = (*PAPER_SCENES, *(name for name in built_in_scenes() if name not in PAPER_SCENES))
