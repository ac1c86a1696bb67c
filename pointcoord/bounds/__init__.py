"""Proven bounds on what was solved."""
