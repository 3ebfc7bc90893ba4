"""Ends of sentences that name a fault; a sentence begins with the mesh's name."""

from __future__ import annotations

ODD_CORNER = "has a corner that is no finite number"
NO_TRIANGLE = "has no triangle"


def lost_corner(corner: int, corners: int) -> str:
    """Return what is said of a face with a corner that isn't there."""
    return f"has a face with the corner {corner}, but {corners:,} corners"


def cut_off(found: str, needed: str) -> str:
    """Return what is said of a file that ends too early, of what it has and of what it should have."""
    return f"is cut off: it has {found}, and should have {needed}"
