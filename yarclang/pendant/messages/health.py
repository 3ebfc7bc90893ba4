"""Messages about the pendant's computer, its process and its data."""

from __future__ import annotations

from typing import Literal

from yarclang.coordinator.messages.message import Message


class Watched(Message):
    """One thing that is watched, in words."""

    group: str
    name: str
    value: str
    level: Literal["good", "warning", "bad", "unknown", "plain"]
    """`plain`: not judged; `unknown`: this operating system doesn't provide the value."""
    limits: str
    """The thresholds."""
    why: str
    """The reason for watching it."""
    remedy: str
    history: tuple[float, ...]
    """A number for each minute of the last hour, the oldest first; in bytes, s or shares."""


class VersionShown(Message):
    """A name and its version."""

    name: str
    version: str


class SystemHealth(Message):
    """State of the pendant's computer, its process and its data."""

    level: Literal["good", "warning", "bad", "unknown", "plain"]
    """The worst of all."""
    watched: tuple[Watched, ...]
    uptime_s: float
    sessions: int
    pages: int
    """Pages that are connected."""
    versions: tuple[VersionShown, ...]
    text: str
    """Versions and what is watched as a text for a report of a bug: without names of people, machines and
    folders.
    """
