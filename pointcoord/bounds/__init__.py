"""Certified poses, and enclosures of the exact positions and rates of their points."""
