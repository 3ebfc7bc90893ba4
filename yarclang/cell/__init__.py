"""The robot's surroundings: cell.toml, read, checked and in SI."""
