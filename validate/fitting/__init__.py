"""Hardpoints that explain measured curves, and what the curves cannot tell of them."""
