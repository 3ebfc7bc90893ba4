"""`yarc`: all commands except the compiler."""

from __future__ import annotations

import click

from yarclang import __version__
from yarclang.cli.lazy import LazyGroup

_COMMANDS = {
    "Programs": {
        "new": "Make the folder of a new project.",
        "check": "Check programs without writing anything.",
        "fmt": "Write programs in their usual form.",
        "explain": "Explain a finding's code.",
        "doc": "Print the reference of a module.",
        "jobs": "Prove the numbered programs of a project.",
        "verify": "Check a text by its proof, with a small checker.",
    },
    "Looking at programs": {
        "inspect": "Show all that is known of one command.",
        "diff": "Compare two programs by path and time.",
        "plot": "Draw a program's motion.",
        "view": "Show a program or a run in three dimensions.",
        "place": "Find where a fixture or a part could stand.",
    },
    "Running": {
        "run": "Run a program on a controller, or simulated.",
        "exec": "Run a program without a terminal, events as JSON.",
        "status": "Say how a run is going, or a controller is.",
        "hold": "Hold a run on its path.",
        "resume": "Go on after a hold.",
        "override": "Change a run's speed.",
        "stop": "End a run, or whatever a controller does.",
        "replay": "Show a recorded run as it happened.",
        "registers": "Say what KEPT registers held last.",
    },
    "Robots and controllers": {
        "robot": "Make, check and list robots.",
        "reach": "Draw where a robot can hold its flange.",
        "settings": "Print the controller's settings for a robot.",
        "doctor": "Look at a controller before a program is run.",
        "sim": "Simulate a Turbo PMAC on a TCP port.",
    },
    "Teaching and serving": {
        "repl": "Work with a robot live.",
        "pendant": "Serve the pendant: watch, run and jog a robot from a browser or tablet.",
        "serve": "Own a robot for others: one moves it, all watch.",
        "follow": "Let another process steer a robot.",
        "ros": "Let MoveIt move a robot through the stock ROS-Industrial nodes.",
    },
    "Import and export": {
        "import": "Make a program of a table, a trajectory, or named states.",
        "export": "Write what ROS needs: MoveIt's configuration, or trajectories.",
    },
    "Editors and shells": {
        "lsp": "Check programs while they are typed, for editors.",
        "completion": "Print the shell's completion script.",
        "man": "Write the manual pages into a folder.",
    },
    "Proving the compiler": {
        "campaign": "Compile random programs, and judge them by an independent reading.",
    },
}
"""Summaries of the commands, in the sections of --help."""


_ON_UNIX = (
    *("run", "exec", "status", "hold", "resume", "override", "stop", "doctor", "sim"),
    *("repl", "pendant", "serve", "follow", "ros"),
)
"""Commands that work with a robot or simulate one."""


@click.command(
    cls=LazyGroup,
    commands_by_section=_COMMANDS,
    on_unix=_ON_UNIX,
    context_settings={"help_option_names": ["-h", "--help"]},
)
@click.version_option(__version__, message="yarc %(version)s")
def main() -> None:
    """Check, run and understand YARC programs, and set up robots. `yarcc` compiles programs."""
