"""Solved scenes: how their numbers are computed from states, read and proven."""
