"""Messages about the pendant's computer, its process and its data."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message


class Watched(Message):
    """A monitored number of the system, in words."""

    group: str
    name: str
    value: str
    level: Literal["good", "warning", "bad", "unknown", "plain"]
    """`plain`: not rated; `unknown`: this operating system doesn't provide the number."""
    limits: str
    """The thresholds."""
    why: str
    """The reason for monitoring the number."""
    remedy: str
    history: tuple[float, ...]
    """Values of the last hour, one per minute, oldest first [bytes, s or a share]."""


class VersionShown(Message):
    """A name and its version."""

    name: str
    version: str


class SystemHealth(Message):
    """State of the pendant's computer, its process and its data."""

    level: Literal["good", "warning", "bad", "unknown", "plain"]
    """The worst level of the monitored numbers (`watched`)."""
    watched: tuple[Watched, ...]
    uptime_s: float
    sessions: int
    pages: int
    """Number of connected pages."""
    versions: tuple[VersionShown, ...]
    text: str
    """Versions and monitored numbers as a text for bug reports, without names of people, machines and
    folders.
    """
