"""`python -m validate` is the program `pointcoord`."""

import sys

from pointcoord.__main__ import main

if __name__ == "__main__":
    sys.exit(main())
