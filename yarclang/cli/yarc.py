"""`yarc`: everything but compiling."""

from __future__ import annotations

import click

from yarclang import __version__
from yarclang.cli.lazy import LazyGroup

_COMMANDS = {
    "check": "Check programs without writing anything.",
    "completion": "Print the shell's completion script.",
    "diff": "Compare two programs by path and time.",
    "doc": "Print the reference of a module.",
    "doctor": "Look at a controller before a program is run.",
    "exec": "Run a program without a terminal, events as JSON.",
    "export": "Write what ROS needs: MoveIt's configuration, or trajectories.",
    "explain": "Explain a finding's code.",
    "fmt": "Write programs in their usual form.",
    "follow": "Let another process steer a robot.",
    "hold": "Hold a run on its path.",
    "import": "Make a program of a table, a trajectory, or named states.",
    "inspect": "Show all that is known of one command.",
    "jobs": "Prove the numbered programs of a project.",
    "lsp": "Check programs while they are typed, for editors.",
    "new": "Make the folder of a new project.",
    "override": "Change a run's speed.",
    "pendant": "Serve the pendant: watch, run and jog a robot from a browser or tablet.",
    "plot": "Draw a program's motion.",
    "reach": "Draw where a robot can hold its flange.",
    "registers": "Say what KEPT registers held last.",
    "repl": "Work with a robot live.",
    "replay": "Show a recorded run as it happened.",
    "resume": "Go on behind a hold.",
    "robot": "Make, check and list robots.",
    "ros": "Let MoveIt move a robot through the stock ROS-Industrial nodes.",
    "run": "Run a program on a controller, or simulated.",
    "serve": "Own a robot for others: one moves it, all watch.",
    "settings": "Print the controller's settings for a robot.",
    "sim": "Simulate a Turbo PMAC on a TCP port.",
    "status": "Say how a run is going, or a controller is.",
    "stop": "End a run, or whatever a controller does.",
    "verify": "Check a text by its proof, with a small checker.",
    "view": "Show a program or a run in three dimensions.",
}


@click.command(
    cls=LazyGroup, commands_by_name=_COMMANDS, context_settings={"help_option_names": ["-h", "--help"]}
)
@click.version_option(__version__, message="yarc %(version)s")
def main() -> None:
    """Check, look at and understand YARC programs. `yarcc` compiles them."""
