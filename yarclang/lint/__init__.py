"""What else is worth saying of a program that can be carried out: rules, one file each."""
