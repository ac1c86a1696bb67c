"""The parts of the study: each gives the races that it consists of."""
