"""Words of the language that begin a line and are neither a motion nor an action: one file each in `builtin`."""
