"""The workflow that is shipped for GitHub Actions calls the program with options that it has."""

import re
import shlex
from importlib import resources

from validate import cli

TEXT = (resources.files("validate.ci") / "github.yml").read_text(encoding="utf-8")


def test_every_option_of_the_workflow_is_one_of_the_command() -> None:
    (command,) = re.findall(r"run: >-\n((?: {10}\S.*\n)+)", TEXT)
    program, name, *words = shlex.split(command)
    assert (program, name) == ("pointcoord", "validate")
    # Which solver it is stands in its place among the options.
    solver = words.index("--solver")
    del words[solver : solver + 4]
    options = cli.parser(["validate"]).parse_args([name, *words])
    assert (options.scenes_dir, options.junit) == ("scenes", "pointcoord.xml")
    assert options.summary == "$GITHUB_STEP_SUMMARY"
    assert f"path: {options.junit}\n" in TEXT
