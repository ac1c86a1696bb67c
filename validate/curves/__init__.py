"""Curves of a motion: finds the numbers that are named, and draws one against another."""
