"""Hardpoints from other programs' files, as scenes.

from validate.hardpoint_files.importing import import_hardpoints
imported = import_hardpoints("report.txt")
imported.scene        # a checked scene with wheel travel
imported.text         # the same as a scene file, with the source of each point in a comment

A format is a table in `formats/`: what its points are called, its axes and its unit. A program here reads a
form of text and knows no point by name.
"""
