"""Curves of a motion: which of its numbers are meant, and a picture of one over another."""
