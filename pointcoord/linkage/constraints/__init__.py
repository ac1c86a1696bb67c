"""The kinds of constraints, one per module."""
