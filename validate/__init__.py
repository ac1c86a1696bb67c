"""Runs the formulations on the same scenes and says how far they agree."""
