"""Find ways around obstacles in joint space."""
