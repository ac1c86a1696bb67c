"""From a linkage and its inputs to states: one pose, a path, a series, single instants."""
