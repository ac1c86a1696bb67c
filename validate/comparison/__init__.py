"""Compares two solutions of one scene; the tolerances follow from the error bounds of both."""
