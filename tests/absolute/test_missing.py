"""Without Pinocchio the package ends in one line that says what to install."""

import subprocess
import sys

import pytest


@pytest.mark.parametrize("wanted", ["absolute", "absolute.errors", "absolute.newton"])
def test_importing_without_pinocchio_names_the_extra(wanted: str) -> None:
    program = (
        "import sys; sys.modules['pinocchio'] = None\n"
        "try:\n"
        f"    import {wanted}\n"
        "except ImportError as error:\n"
        "    print(type(error).__name__, error, sep='|')\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=60)
    name, message = done.stdout.rstrip("\n").split("|")
    assert name == "MissingPinocchioError"
    assert message.endswith("pip install 'pointcoord[validate]'")
    assert "pinocchio" in message
    assert "\n" not in message
