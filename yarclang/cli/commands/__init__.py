"""One file a command of `yarc`."""
