"""A robot as a package of MoveIt's configuration."""
