"""Mechanism files: read, checked, flattened and compiled to a topology.

`shipped()` lists the mechanisms of the package; `mechanism_file(name)` reads one.
"""

from pointcoord.mechanism.file import MechanismFile, mechanism_file, shipped

__all__ = ["MechanismFile", "mechanism_file", "shipped"]
