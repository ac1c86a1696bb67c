"""From the reference to a Solution: what a formulation should have answered."""
