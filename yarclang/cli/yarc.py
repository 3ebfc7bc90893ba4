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
        "verify": "Check a controller text and its proof with a small checker.",
    },
    "Looking at programs": {
        "inspect": "Show everything about one command.",
        "diff": "Compare two programs by path and time.",
        "plot": "Draw a program's motion.",
        "view": "Show a program or a run in three dimensions.",
        "place": "Find the best place of a fixture or a part.",
    },
    "Running": {
        "run": "Run a program on a controller, or simulated.",
        "exec": "Run a program without a terminal, events as JSON.",
        "status": "Print the state of a run or of a controller.",
        "hold": "Hold a run on its path.",
        "resume": "Continue after a hold.",
        "override": "Change a run's speed.",
        "stop": "End a run, or stop the controller itself.",
        "replay": "Show a recorded run as it happened.",
        "registers": "Print the last values of KEPT registers.",
    },
    "Robots and controllers": {
        "robot": "Make, check and list robots.",
        "reach": "Draw where a robot can hold its flange.",
        "settings": "Print the controller's settings for a robot.",
        "doctor": "Check a controller before running a program.",
        "sim": "Simulate a Turbo PMAC on a TCP port.",
    },
    "Teaching and serving": {
        "repl": "Work with a robot live.",
        "pendant": "Serve the pendant: watch, run and jog a robot from a browser or tablet.",
        "serve": "Serve a robot: one client moves it, all may watch.",
        "follow": "Let another process steer a robot.",
        "ros": "Let MoveIt move a robot through the stock ROS-Industrial nodes.",
    },
    "Import and export": {
        "import": "Make a program from a table, a trajectory, or named states.",
        "export": "Write MoveIt's configuration, ROS nodes, or trajectories.",
    },
    "Editors and shells": {
        "lsp": "Start the language server for editors.",
        "completion": "Print the shell's completion script.",
        "man": "Write the manual pages into a folder.",
    },
    "Proving the compiler": {
        "campaign": "Compile random programs, and check the results independently.",
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
