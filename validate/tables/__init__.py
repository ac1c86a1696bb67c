"""Reads tables of other programs as lines of cells, and the units in their titles."""
