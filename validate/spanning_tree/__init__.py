"""A mechanism cut into a tree of joints with loop closures, as data; what a model makes of it is its own."""
