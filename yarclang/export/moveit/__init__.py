"""Export of a robot as a package of MoveIt's configuration."""
