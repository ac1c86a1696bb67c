"""The paper's scenes: `validate` takes them without a name, and tries the printed formulas on them alone.

The last is the chassis motion that is the paper's third degree of freedom.
"""

DEFAULT_SCENES = ("bounce", "steer", "bounce-and-steer", "bounce-on-a-heaving-chassis")
