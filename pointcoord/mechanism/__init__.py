"""Mechanism files: read, checked, flattened and compiled to a topology.

The package's name keeps the shipped ones: `shipped()` lists them, `mechanism_file(name)` gives one.
"""

from pointcoord.mechanism.file import MechanismFile, mechanism_file, shipped

__all__ = ["MechanismFile", "mechanism_file", "shipped"]
