"""The simulator on a network, or beside the code that uses it."""
