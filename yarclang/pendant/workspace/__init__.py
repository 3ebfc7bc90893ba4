"""The workspace: the zones and obstacles of a cell and the limits of joints, shown and changed."""
