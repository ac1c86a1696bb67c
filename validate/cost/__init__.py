"""Run time against accuracy: every method to solve a scene, timed and compared with the reference.

A method is called a way here, in the option --ways and in the columns of the table.
"""
