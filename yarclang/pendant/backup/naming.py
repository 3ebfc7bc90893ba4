"""Check of the file names in a backup. Each name must be allowed for a new file of the project, and no two
names may look alike.
"""

from __future__ import annotations

import re

from yarclang.pendant.backup.bounds import DEEPEST
from yarclang.pendant.project.names import check_new, folded, parts_of, quoted
from yarclang.runtime.actions import Trouble

_DRIVE = re.compile("[A-Za-z]:")


class Names:
    """Set of the names that were added so far."""

    def __init__(self) -> None:
        self._spelled: dict[str, str] = {}
        self._folders: set[str] = set()
        self._listed: set[str] = set()

    def add(self, name: str, *, folder: bool) -> None:
        """Add the name of a file or folder, and check it.

        Args:
            name: path in the backup, without a slash at its end.
            folder: True for the name of a folder.

        Raises:
            Trouble: a project can't have a file of this name, or the name conflicts with one that was added
                before.
        """
        if _DRIVE.match(name):
            raise Trouble(f"{quoted(name)} begins with the letter of a drive", "", "")
        parts = parts_of(name)
        known_way = "/".join(parts[:-1]) in self._folders
        check_new(parts[-1:] if known_way else parts)
        if len(parts) > DEEPEST:
            raise Trouble(f"{quoted(name)} is more than {DEEPEST} folders deep", "", "")
        if name in self._listed:
            raise Trouble(f"{quoted(name)} exists twice", "", "")
        first = len(parts) - 1 if known_way else 0
        tops = {count: "/".join(parts[: count + 1]) for count in range(first, len(parts))}
        for count, top in tops.items():
            known = self._spelled.get(folded(top), top)
            if known != top:
                raise Trouble(f"{quoted(top)} looks like {quoted(known)}, which also exists", "", "")
            is_folder = folder or count < len(parts) - 1
            if top in self._spelled and is_folder != (top in self._folders):
                raise Trouble(f"{quoted(top)} is a file and a folder", "", "")
        for count, top in tops.items():
            self._spelled[folded(top)] = top
            if folder or count < len(parts) - 1:
                self._folders.add(top)
        self._listed.add(name)
