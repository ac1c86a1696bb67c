"""What tests of other people's solvers are written with."""
