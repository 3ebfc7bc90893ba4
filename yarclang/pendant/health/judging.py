"""Rating of measured numbers of the pendant's computer as good, warning or bad. Each rating contains the
thresholds, the reason for them, and a remedy. No I/O.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal

from yarclang.coordinator.messages.replies import Health
from yarclang.pendant.health.measuring import Disk, Machine

Level = Literal["good", "warning", "bad", "unknown", "plain"]

_GIGA, _MEGA = 1e9, 1e6
FREE_WARNING, FREE_BAD = 2e9, 0.5e9
"""Limits of a disk's free space [bytes]: a warning below the first, bad below the second."""
DAYS_WARNING, DAYS_BAD = 14.0, 2.0
"""Limits of the time until a disk is full, at the present growth of the run logs [days]: a warning below the
first, bad below the second.
"""
MEMORY_WARNING, MEMORY_BAD = 0.15, 0.05
"""Limits of the computer's available memory, as a share of all its memory: a warning below the first, bad
below the second.
"""
OWN_WARNING, OWN_BAD = 1.5e9, 3e9
"""Limits of the memory of the pendant's process [bytes]: a warning above the first, bad above the second."""
LOAD_WARNING, LOAD_BAD = 0.8, 1.5
"""Limits of the computer's load per processor: a warning above the first, bad above the second."""
LAG_WARNING, LAG_BAD = 0.05, 0.2
"""Limits of the delay of the process's event loop [s]: a warning above the first, bad above the second."""
SILENCE_WARNING, SILENCE_BAD = 0.25, 0.6
"""Limits of the longest time that the controller took for a reply: a warning above the first, bad above the
second. Both are shares of the silence after which the controller stops the robot.
"""
LOGS_WARNING, LOGS_BAD = 10e9, 50e9
"""Limits of the size of all run logs [bytes]: a warning above the first, bad above the second."""
TRAIL_WARNING, TRAIL_BAD = 0.5e9, 2e9
"""Limits of the size of the database with users, audit trail and alarms [bytes]: a warning above the first,
bad above the second.
"""


@dataclass(frozen=True, slots=True)
class Judgement:
    """Rating of one measured number.

    Attributes:
        key: name of the number in the history of the last hour.
        group: heading under which pages show the number.
        name: name of the number, in words.
        value: measured value with its unit, as text.
        level: the rating; `plain` if the number isn't rated, `unknown` if the operating system doesn't
            provide it.
        limits: the thresholds, in words.
        why: reason for the thresholds.
        remedy: what to do if the rating isn't good.
    """

    key: str
    group: str
    name: str
    value: str
    level: Level
    limits: str = ""
    why: str = ""
    remedy: str = ""


def sized(count: float) -> str:
    """Return a number of bytes in words, with its unit."""
    for bound, unit in ((_GIGA, "GB"), (_MEGA, "MB"), (1e3, "kB")):
        if count >= bound:
            return f"{count / bound:.1f} {unit}"
    return f"{count:.0f} B"


def lasting(seconds: float) -> str:
    """Return a duration in words."""
    for bound, unit in ((86400.0, "days"), (3600.0, "h"), (60.0, "min")):
        if seconds >= 2 * bound:
            return f"{seconds / bound:.0f} {unit}"
    return f"{seconds:.0f} s"


def low_of(disks: Iterable[Disk]) -> str:
    """Return a warning about the disk with the least free space; empty if every disk has at
    least `FREE_BAD`.
    """
    worst = min(disks, key=lambda one: one.free, default=None)
    if worst is None or worst.free >= FREE_BAD:
        return ""
    return f"{sized(worst.free)} are free on the disk of {worst.holds}, but {sized(FREE_BAD)} are needed"


def of_disks(disks: Iterable[Disk], growth: float) -> tuple[Judgement, ...]:
    """Rate the free space of the disks, and the time until they are full.

    Args:
        disks: disks that hold files of the pendant.
        growth: growth of the run logs [bytes/day].
    """
    judgements = []
    for disk in disks:
        value = f"{sized(disk.free)} of {sized(disk.total)} free"
        level = _below(disk.free, FREE_WARNING, FREE_BAD)
        if growth > 0.0 and ("logs" in disk.holds or "project" in disk.holds):
            days = disk.free / growth
            value += f"; full in {days:.0f} days at {sized(growth)} of run logs a day" if days < 3650 else ""
            level = max(level, _below(days, DAYS_WARNING, DAYS_BAD), key=_LEVELS.index)
        judgements.append(
            Judgement(
                "disk", "Disk", f"Disk of {disk.holds}", value, level,
                f"warning below {sized(FREE_WARNING)} or {DAYS_WARNING:.0f} days, bad below "
                    f"{sized(FREE_BAD)} or {DAYS_BAD:.0f} days",
                "Without free space runs can't be logged and the audit trail can't be written, so all "
                "orders that need them are refused.",
                "Delete old run logs (see Files, or History > Runs), or enlarge the disk.",
            )
        )  # fmt: skip
    return tuple(judgements) or (Judgement("disk", "Disk", "Disk", "not known", "unknown"),)


def of_memory(machine: Machine, first: int | None) -> tuple[Judgement, ...]:
    """Rate the memory of this process and of the computer.

    Args:
        machine: newest measurement of the computer and the process.
        first: memory of this process at the first measurement [bytes]; None if unknown.
    """
    own_level: Level = "unknown" if machine.own is None else _above(machine.own, OWN_WARNING, OWN_BAD)
    value = "not known"
    if machine.own is not None:
        value = (
            f"{sized(machine.own)} now, {sized(first or machine.own)} at the start, "
            f"{sized(machine.peak or machine.own)} at most"
        )
    whole: Level = "unknown"
    free = "not known"
    if machine.available is not None and machine.memory:
        whole = _below(machine.available / machine.memory, MEMORY_WARNING, MEMORY_BAD)
        free = f"{sized(machine.available)} of {sized(machine.memory)} available"
    return (
        Judgement(
            "own", "Memory", "This process", value, own_level,
            f"warning above {sized(OWN_WARNING)}, bad above {sized(OWN_BAD)}",
            "If the process keeps growing, the system will end it, and the robot will hold.",
            "Restart the pendant while the robot is at rest (System > Controller), and report the "
            "problem to its maintainer.",
        ),
        Judgement(
            "memory", "Memory", "This computer", free, whole,
            f"warning below {MEMORY_WARNING:.0%}, bad below {MEMORY_BAD:.0%} of all",
            "Without free memory the system swaps or ends processes, so replies are late and the "
            "controller holds.",
            "End other programs on this computer, or add memory.",
        ),
    )  # fmt: skip


def of_speed(machine: Machine, share: float, lag: float) -> tuple[Judgement, ...]:
    """Rate the response times of this computer.

    Args:
        machine: newest measurement of the computer and the process.
        share: processor time of this process as a share of one processor.
        lag: longest delay of the event loop in the last minute [s].
    """
    load: Level = "unknown" if machine.load is None else _above(machine.load, LOAD_WARNING, LOAD_BAD)
    value = "not known" if machine.load is None else f"{machine.load:.0%} of each processor"
    return (
        Judgement(
            "load", "Computer", "Processors", f"{value}; this process {share:.0%} of one", load,
            f"warning above {LOAD_WARNING:.0%}, bad above {LOAD_BAD:.0%}",
            "A high load delays pages, plans, and the lines that a motion needs.",
            "End other programs on this computer.",
        ),
        Judgement(
            "lag", "Computer", "Event loop, worst of the last minute", f"{lag * 1e3:.0f} ms late",
                _above(lag, LAG_WARNING, LAG_BAD),
            f"warning above {LAG_WARNING * 1e3:.0f} ms, bad above {LAG_BAD * 1e3:.0f} ms",
            "If this computer is late, a jog stops by itself, and a pressed stop is delayed by this time.",
            "Check the load above; a virtual machine may get too little processor time.",
        ),
    )  # fmt: skip


def of_link(health: Health | None, *, connected: bool) -> tuple[Judgement, ...]:
    """Rate the response time of the connection to the controller."""
    if health is None or not connected:
        return (Judgement("reply", "Link", "Link to the controller", "not connected", "unknown"),)
    share = health.slowest_s / health.silence_s if health.silence_s > 0.0 else 0.0
    return (
        Judgement(
            "reply", "Link", "Replies of the controller",
            f"{health.reply_s * 1e3:.1f} ms now, {health.slowest_s * 1e3:.1f} ms at most since it was "
                f"connected",
            _above(share, SILENCE_WARNING, SILENCE_BAD),
            f"warning above {SILENCE_WARNING:.0%}, bad above {SILENCE_BAD:.0%} of the "
                f"{health.silence_s:.2f} s after which the controller holds",
            "If the link is silent for longer, the controller holds the motion.",
            "Check cables and switches; use a separate network for the controller.",
        ),
    )  # fmt: skip


def of_stored(
    logs: int, size: int, growth: float, project: int | None, data: int | None, database: int, deeds: int
) -> tuple[Judgement, ...]:
    """Rate the sizes of the pendant's data on the disk.

    Args:
        logs: number of run logs.
        size: size of the run logs [bytes].
        growth: growth of the run logs [bytes/day].
        project: size of the project [bytes]; None if unknown.
        data: size of the pendant's own folder, which contains the database [bytes]; None if unknown.
        database: size of the database [bytes].
        deeds: number of entries of the audit trail.
    """
    return (
        Judgement(
            "logs", "Records", "Run logs", f"{logs:,} with {sized(size)}; {sized(growth)} a day",
                _above(size, LOGS_WARNING, LOGS_BAD),
            f"warning above {sized(LOGS_WARNING)}, bad above {sized(LOGS_BAD)}",
            "Logs are never deleted automatically.",
                "Download the needed logs, and delete old ones on the page Files.",
        ),
        Judgement(
            "trail", "Records", "Audit trail and alarms", f"{deeds:,} entries; {sized(database)}",
                _above(database, TRAIL_WARNING, TRAIL_BAD),
            f"warning above {sized(TRAIL_WARNING)}, bad above {sized(TRAIL_BAD)}",
            "The audit trail is never deleted.",
                "Keep a copy of the pendant's data folder, and start a new one with --data.",
        ),
        Judgement("project", "Records", "Project",
            "more files than are counted" if project is None else sized(project), "plain"),
        Judgement("data", "Records", "The pendant's data, including deleted files",
            "more files than are counted" if data is None else sized(data), "plain"),
    )  # fmt: skip


_LEVELS: tuple[Level, ...] = ("plain", "unknown", "good", "warning", "bad")


def worst_of(judgements: Iterable[Judgement]) -> Level:
    """Return the worst of the levels."""
    return max((one.level for one in judgements), key=_LEVELS.index, default="unknown")


def _above(value: float, warning: float, bad: float) -> Level:
    return "bad" if value > bad else "warning" if value > warning else "good"


def _below(value: float, warning: float, bad: float) -> Level:
    return "bad" if value < bad else "warning" if value < warning else "good"
