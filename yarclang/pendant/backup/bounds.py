"""Limits on a backup's size. They are respected when a backup is made, so that every backup can be
restored.
"""

from __future__ import annotations

MOST_FILES = 20_000
"""Largest number of files and folders."""

LARGEST_FILE = 1 << 30
"""Largest file [bytes]."""

MOST_BYTES = 2_000_000_000
"""Largest sum of the sizes of all files [bytes]."""

MOST_ZIP = MOST_BYTES + 64_000_000
"""Largest zip [bytes]. This is slightly more than `MOST_BYTES`, because a zip of files that can't be
compressed is larger than the files.
"""

RATIO, RATIO_FREE = 200, 200_000_000
"""Limit on compression, against zips that unpack to an enormous size: all unpacked files together may have at
most `RATIO` times the size of the zip, plus `RATIO_FREE` [bytes].
"""

DEEPEST = 50
"""Deepest nesting of folders."""

MANIFEST = ".yarc-backup.jsonl"
"""Name of the manifest (list of files) in a backup. It begins with a dot, so no file of a project can have
this name: hidden files don't belong to the project.
"""

MOST_MANIFEST = 32_000_000
"""Longest manifest of a backup [bytes]."""
