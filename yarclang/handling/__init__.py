"""Follow parts that grippers take and put down: their places at every instant of a program."""
