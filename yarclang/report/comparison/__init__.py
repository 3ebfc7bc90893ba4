"""Two programs by path and time: `yarc diff`."""
