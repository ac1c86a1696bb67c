"""Users' solvers: called with plain data, and compared with tolerances from the accuracy that they state."""
