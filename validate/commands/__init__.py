"""The commands of the program: a file each, or one for those that do nearly the same.

What a command says of itself and which options it takes stands on its page in `help/`, of which its parser
is made. `COMMANDS` has those of a file by name: what runs each, which reads the options, calls the room that
does the work and says what came of it. What it raises is for the one who runs the program: `validate.cli`
makes a line and a status of it.
"""
