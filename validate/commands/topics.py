"""`pointcoord help`: prints the README page of a topic."""

from __future__ import annotations

import argparse
from pathlib import Path

import pointcoord
from validate.commands.pages import Command
from validate.errors import UsageError
from validate.exit_status import ExitStatus
from validate.output.console import Console

PAGE = "README.md"
TOPICS = {
    "scenes": "pointcoord/scenes",
    "mechanisms": "pointcoord/mechanisms",
    "effects": "pointcoord/effects",
    "python": "pointcoord",
    "models": "validate/formulations",
    "solvers": "validate/solvers",
    "results": "validate/measured",
    "tables": "validate/published",
    "fit": "validate/fitting",
    "tests": "validate/testing",
    "ci": "validate/ci",
    "report": "validate/html",
    "hard": "validate/hard",
    "study": "validate/studies",
    "cost": "validate/cost",
    "program": "validate/commands",
}
"""Every topic, with the folder of its page."""


def run(options: argparse.Namespace, console: Console) -> ExitStatus:
    """Print a page, or the list of topics."""
    if options.topic is None:
        console.say("\n".join(f"{n.ljust(12)}{page(n).splitlines()[0].lstrip('# ')}" for n in TOPICS))
    elif options.topic in TOPICS:
        console.say(page(options.topic).rstrip())
    else:
        raise UsageError(f"help: no topic is called {options.topic!r}; there are: {', '.join(TOPICS)}")
    return ExitStatus.AGREE


def page(topic: str) -> str:
    """The page of a topic, as Markdown."""
    root = Path(str(pointcoord.__file__)).parents[1]
    return (root / TOPICS[topic] / PAGE).read_text(encoding="utf-8")


COMMANDS = {"help": Command(run, {"topics": ", ".join(TOPICS)})}
