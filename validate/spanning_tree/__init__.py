"""A mechanism cut into a tree of joints with loop closures, as data for several models."""
