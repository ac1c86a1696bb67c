"""Compares files of results, measured or printed by another program, with the car of a scene."""
