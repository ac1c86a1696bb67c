"""Numerics without reference to linkages: quadratic maps, their solution, series and bounds."""
