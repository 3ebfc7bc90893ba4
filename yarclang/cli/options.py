"""Options that several commands share."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, TypeVar

import click

from yarclang.cli.parameter import ParamType
from yarclang.emitted.bounds import MOST_SEARCHES

F = TypeVar("F", bound=Callable[..., Any])


def complete_robots(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:  # noqa: ARG001  (click's signature)
    """Return the robots' names that begin with the typed text, for completion."""
    from yarclang.robot.library import list_robots

    return [robot.name for robot in list_robots() if robot.name.startswith(incomplete.upper())]


def _codes(ctx: click.Context, param: click.Parameter, incomplete: str) -> list[str]:  # noqa: ARG001
    """Return the findings' codes that begin with the typed text, for completion."""
    from yarclang.lint.registry import everything

    return [code for code in everything() if code.startswith(incomplete.upper())]


def file_argument(name: str, *, required: bool = True, **settings: Any) -> Callable[[F], F]:
    """Add an argument for the programs to read, with completion of paths. `-` is standard input."""
    return click.argument(name, required=required, type=click.Path(allow_dash=True), **settings)


def robot_argument(name: str, **settings: Any) -> Callable[[F], F]:
    """Add an argument for robots, with completion of their names."""
    return click.argument(name, shell_complete=complete_robots, **settings)


def code_argument(name: str, **settings: Any) -> Callable[[F], F]:
    """Add an argument for codes of findings, with completion."""
    return click.argument(name, shell_complete=_codes, **settings)


class Numbers(ParamType[tuple[float, ...]]):
    """Numbers separated by commas."""

    def __init__(self, name: str, most: int | None = None, positive: bool = False) -> None:
        self.name, self.most, self.positive = name, most, positive

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[float, ...]:
        """Parse numbers. Other text is a usage error."""
        if isinstance(value, tuple):
            return value
        try:
            numbers = tuple(float(part) for part in str(value).split(","))
        except ValueError:
            self.fail(f"{value!r} isn't a list of numbers separated by commas", param, ctx)
        if not all(math.isfinite(number) for number in numbers):
            self.fail(f"{value!r} has a value that isn't a finite number", param, ctx)
        if self.positive and min(numbers) <= 0:
            self.fail(f"{value!r}: all numbers must be positive", param, ctx)
        if self.most is not None and len(numbers) > self.most:
            self.fail(f"{value!r} has {len(numbers)} numbers; at most {self.most} are allowed", param, ctx)
        return numbers


class PositiveNumber(ParamType[float]):
    """A positive, finite number, optionally within bounds."""

    def __init__(self, name: str, least: float = 0.0, most: float = math.inf) -> None:
        self.name = name
        self._least, self._most = least, most

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> float:
        """Parse a number. Other text is a usage error."""
        try:
            number = float(value)
        except ValueError:
            self.fail(f"{value!r} isn't a number", param, ctx)
        if not (math.isfinite(number) and number > 0):
            self.fail(f"{value!r} isn't a positive number", param, ctx)
        if not self._least <= number <= self._most:
            self.fail(f"{value!r} isn't between {self._least:g} and {self._most:g}", param, ctx)
        return number


def robot_option(function: F) -> F:
    """Add --robot NAME|PATH."""
    return click.option(
        "--robot",
        metavar="NAME|PATH",
        shell_complete=complete_robots,
        help="A robot of the standard library, or the path of a robot.toml.",
    )(function)


def cell_option(function: F) -> F:
    """Add --cell FILE.toml."""
    return click.option(
        "--cell",
        type=click.Path(dir_okay=False),
        metavar="FILE.toml",
        help="The cell, for programs without a CELL line (default: the cell of yarc.toml).",
    )(function)


def planning_options(function: F) -> F:
    """Add --robot, --start, --tolerance and --cell, for every command that plans."""
    for option in (
        cell_option,
        click.option(
            "--tolerance",
            type=Numbers("MM[,DEG]", most=2, positive=True),
            help="Allowed distance of the executed path from the programmed one (default: the robot's).",
        ),
        click.option(
            "--start",
            type=Numbers("Q1,Q2,..."),
            help=(
                "Start position of the robot: deg, mm for prismatic joints (default: START, else the "
                "robot's home)."
            ),
        ),
        robot_option,
    ):
        function = option(function)
    return function


class Findings(ParamType[frozenset[str]]):
    """Parser of codes, beginnings of codes, or names of findings, separated by commas."""

    name = "CODES"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> frozenset[str]:
        """Parse codes. An unknown code is a usage error."""
        from yarclang.lint.registry import codes_of, everything
        from yarclang.subjects import suggest

        if isinstance(value, frozenset):
            return value
        found: set[str] = set()
        for word in str(value).split(","):
            codes = codes_of(word)
            if not codes:
                near = suggest(word, [*everything(), *(one.name for one in everything().values())])
                self.fail(
                    f"no finding is called {word!r}; {near or 'yarc explain lists all codes'}", param, ctx
                )
            found.update(codes)
        return frozenset(found)


def finding_words(name: str, **settings: Any) -> Callable[[F], F]:
    """Add an option whose values are codes of findings, with completion. Its value is None if the option
    isn't given.
    """
    return click.option(name, type=Findings(), shell_complete=_codes, **settings)


def format_option(function: F) -> F:
    """Add --format text|json."""
    return click.option(
        "--format",
        "format_",
        type=click.Choice(["text", "json"]),
        default="text",
        help="Output format of the findings.",
    )(function)


def jobs_option(function: F) -> F:
    """Add -j, --jobs N."""
    return click.option(
        "-j",
        "--jobs",
        type=click.IntRange(min=1),
        metavar="N",
        help=(
            "Largest number of processes for several files or long programs (default: one per core). The "
            "result doesn't depend on it."
        ),
    )(function)


def fleet_options(function: F) -> F:
    """Add --jobs N, --scheduler ADDRESS and --no-cache."""
    no_cache = click.option(
        "--no-cache",
        is_flag=True,
        envvar="YARCLANG_NO_CACHE",
        help="Don't reuse or store results in the cache. Use this for releases.",
    )
    return jobs_option(scheduler_option(no_cache(function)))


def scheduler_option(function: F) -> F:
    """Add --scheduler ADDRESS."""
    return click.option(
        "--scheduler",
        metavar="ADDRESS",
        default="",
        help=(
            "Address of a dask scheduler whose workers do the work, such as tcp://HOST:8786. The result "
            "doesn't depend on it."
        ),
    )(function)


def tm_option(function: F) -> F:
    """Add --tm MS."""
    return click.option(
        "--tm",
        type=PositiveNumber("MS"),
        help="The longest segment time to use, in ms (default: the robot's largest).",
    )(function)


def avoid_effort_option(function: F) -> F:
    """Add --avoid-effort N."""
    return click.option(
        "--avoid-effort",
        type=click.IntRange(min=1, max=MOST_SEARCHES),
        metavar="N",
        default=1,
        help=(
            "For motions with _AVOID: search N paths round obstacles and take the fastest (default: 1; "
            f"at most {MOST_SEARCHES})."
        ),
    )(function)
