"""A linkage as data: points, constraints, inputs and the map that they make."""
