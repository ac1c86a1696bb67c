"""A relative-coordinate model of mechanisms in Pinocchio: a tree of joints with loop closures."""
