"""The ways that are raced, a file for each family."""
