"""What a double can hold."""

import numpy as np

# From 1 to the next number.
EPS = float(np.finfo(float).eps)
