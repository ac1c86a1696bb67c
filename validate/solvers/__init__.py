"""Other people's solvers: called with plain data, and held to the accuracy that they state."""
