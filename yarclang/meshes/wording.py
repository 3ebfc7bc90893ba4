"""Ends of sentences about faults in mesh files. Each sentence begins with the name of the mesh."""

from __future__ import annotations

ODD_CORNER = "has a corner that isn't a finite number"
NO_TRIANGLE = "has no triangle"


def lost_corner(corner: int, corners: int) -> str:
    """Return the end of the sentence about a face with a corner that doesn't exist."""
    return f"has a face with the corner {corner}, but {corners:,} corners"


def cut_off(found: str, needed: str) -> str:
    """Return the end of the sentence about a file that ends too early: it states how much the file contains,
    and how much it should contain.
    """
    return f"is cut off: it has {found}, and should have {needed}"
