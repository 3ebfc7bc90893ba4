"""Export of a robot as a MoveIt configuration package."""
