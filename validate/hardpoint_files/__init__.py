"""Imports hardpoints from other programs' files as scenes.

from validate.hardpoint_files.importing import import_hardpoints
imported = import_hardpoints("report.txt")
imported.scene        # a checked scene with wheel travel
imported.text         # the scene as a file, with the source of each point in a comment

A format is a table in `formats/` with the names of its points, its axes and its unit. The modules here read
the text, and contain no names of points.
"""
