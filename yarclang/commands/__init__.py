"""The commands of the language, one file each in `builtin`."""
