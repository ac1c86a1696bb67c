"""The commands of the program: a file each, or one for those that do nearly the same.

`COMMANDS` has those of a file by name: what each says of itself, its options, and what runs it, which reads
them, calls the room that does the work and says what came of it. What it raises is for the one who runs the
program: `validate.cli` makes a line and a status of it.
"""
