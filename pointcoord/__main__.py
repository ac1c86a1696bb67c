"""`python -m pointcoord` is the program `pointcoord`.

The solver does not depend on what validates it, so nothing is imported here: the program is looked up by its
name and run, as a shell would, and this module is as happy without it.
"""

import runpy

if __name__ == "__main__":
    runpy.run_module("pointcoord_program", run_name="__main__", alter_sys=True)
