"""Parts that grippers take and put down: where each one is at every instant of a program."""
