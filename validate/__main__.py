"""`python -m validate` is the program `pointcoord`."""

import sys

from validate.cli import main

if __name__ == "__main__":
    sys.exit(main())
