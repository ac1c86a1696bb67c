"""A linkage as data: points, constraints and inputs, and the quadratic map made of them."""
