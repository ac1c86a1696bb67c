"""The commands of the program, one file for each command or for a few similar commands.

The description and the options of a command are on its page in `help/`; its parser is made from this page.
`COMMANDS` of a file has its commands by name. `validate.cli` checks where the results of a command are to be
written, and calls its `run` function, which reads the options, calls the package that does the work, and
prints the results. If it raises an error, `validate.cli` prints one line and sets the exit status.
"""
