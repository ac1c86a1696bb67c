"""The commands of the program. A page in `help/` describes a command, and its parser is made from this page.

`COMMANDS` of a module has its commands by name. `validate.cli` checks the files that the options name. Then
it calls `run` of the command, which reads the options, calls the package that does the work, and prints.
"""
