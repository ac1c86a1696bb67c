"""Assertions and scenes for tests of a user's solver."""
