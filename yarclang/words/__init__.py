"""Words of the language that begin a line and are neither motions nor actions, one file each in `builtin`."""
