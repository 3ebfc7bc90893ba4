"""The commands of `yarc`, one in each file."""
