"""u^2 = w, the smallest system that has two branches, which meet at w = 0; y = (u, w, 0, 1).

There C_u = 2 u, X = 1 / (2 u) and the Lipschitz constant of X C_u is 1 / u, so everything is known by hand.
"""

import numpy as np

from pointcoord.numerics.quadratic import Product, quadratic_map

PARABOLA = quadratic_map([(Product(1.0, (0, 2), (0, 2)), Product(-1.0, (1, 2), (3, 2)))], unknowns=1, size=4)
AT_ONE = np.array([1.0, 1.0, 0.0, 1.0])
