"""The commands `yarcc` and `yarc`. Importing this brings in no planner."""
