"""A relative-coordinate model of suspensions in Pinocchio: a tree of joints with loop closures."""
