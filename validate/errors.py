"""What the one who runs the program can mend: its command line, or what that names."""

from __future__ import annotations


class UsageError(Exception):
    """The command line is wrong, or a name, a file or a cluster that it gives cannot be used.

    The message says which, what is wrong with it, and what is allowed.
    """
