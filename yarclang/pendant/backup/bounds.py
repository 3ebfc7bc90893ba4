"""Limits on a backup's size. They are respected when a backup is made, so that every backup can be
restored.
"""

from __future__ import annotations

MOST_FILES = 20_000
"""Most files and folders."""

LARGEST_FILE = 1 << 30
"""Largest file [bytes]."""

MOST_BYTES = 2_000_000_000
"""Largest sum of the sizes of all files [bytes]."""

MOST_ZIP = MOST_BYTES + 64_000_000
"""Largest zip [bytes]. This is slightly more than `MOST_BYTES`, because a zip of files that can't be
compressed is larger than the files.
"""

RATIO, RATIO_FREE = 200, 200_000_000
"""Limit on compression: all unpacked files together may have at most `RATIO` times the size of the zip,
plus `RATIO_FREE` [bytes].
"""

DEEPEST = 50
"""Deepest nesting of folders."""

MANIFEST = ".yarc-backup.jsonl"
"""Name of the manifest in a backup, the list of its files. The name is that of a hidden file, so no file
of a project can have it.
"""

MOST_MANIFEST = 32_000_000
"""Longest manifest of a backup [bytes]."""
