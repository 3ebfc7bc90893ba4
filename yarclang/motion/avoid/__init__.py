"""Find collision-free paths around obstacles, in joint space and for straight lines of the tool."""
