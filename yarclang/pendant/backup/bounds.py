"""Limits on a backup's size. Backups are made within these limits, so that they can be restored."""

from __future__ import annotations

MOST_FILES = 20_000
"""Most files and folders."""

LARGEST_FILE = 1 << 30
"""Largest file [bytes]."""

MOST_BYTES = 2_000_000_000
"""Largest sum of the sizes of all files [bytes]."""

MOST_ZIP = MOST_BYTES + 64_000_000
"""Largest zip [bytes]. It is slightly larger than a zip of files that can't be compressed."""

RATIO, RATIO_FREE = 200, 200_000_000
"""All files together may have `RATIO` times the size of the zip plus `RATIO_FREE` [bytes]."""

DEEPEST = 50
"""Deepest nesting of folders."""

MANIFEST = ".yarc-backup.jsonl"
"""Name of the list in a backup. It is a hidden file, so no file of a project can have this name."""

MOST_MANIFEST = 32_000_000
"""Longest list [bytes]."""
