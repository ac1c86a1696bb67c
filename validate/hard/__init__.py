"""The catalogue of hard cases: poses, sizes, laws and links at which solvers are known to fail."""
