"""Ways round obstacles in joint space."""
