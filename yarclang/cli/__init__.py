"""The commands `yarcc` and `yarc`. Importing this package imports no planner."""
