"""Bounds of a backup's size. Backups are made within these bounds, so that they can be restored."""

from __future__ import annotations

MOST_FILES = 20_000
"""Most files and folders."""

LARGEST_FILE = 1 << 30
"""Largest file [bytes]."""

MOST_BYTES = 2_000_000_000
"""Most bytes of all files."""

MOST_ZIP = MOST_BYTES + 64_000_000
"""Largest zip [bytes]: slightly more than files that can't be compressed."""

RATIO, RATIO_FREE = 200, 200_000_000
"""All files together may have this many times the size of the zip, and this many bytes more."""

DEEPEST = 50
"""Deepest nesting of folders."""

MANIFEST = ".yarc-backup.jsonl"
"""Name of the list in a backup. It is hidden, so that no file of a project can have the name."""

MOST_MANIFEST = 32_000_000
"""Longest list [bytes]."""
