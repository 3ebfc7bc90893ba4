"""How much a backup may have: a backup that is made keeps to these bounds, so that it can be restored."""

from __future__ import annotations

MOST_FILES = 20_000
"""Files and folders."""

LARGEST_FILE = 1 << 30
"""Largest file [bytes]."""

MOST_BYTES = 2_000_000_000
"""Size of all files [bytes]."""

MOST_ZIP = MOST_BYTES + 64_000_000
"""Size of the zip [bytes]: little beyond that of files that can't be compressed."""

RATIO, RATIO_FREE = 200, 200_000_000
"""All files may have so many times the size of the zip, and so many bytes more."""

DEEPEST = 50
"""Folders within folders."""

MANIFEST = ".yarc-backup.jsonl"
"""Name of the list in a backup: hidden, so that no file of a project can have it."""

MOST_MANIFEST = 32_000_000
"""Longest list [bytes]."""
