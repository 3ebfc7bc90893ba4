"""Compare two programs by path and time, for `yarc diff`."""
