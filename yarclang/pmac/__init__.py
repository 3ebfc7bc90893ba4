"""Facts about the Turbo PMAC, without behaviour, and the type of a program for it."""
