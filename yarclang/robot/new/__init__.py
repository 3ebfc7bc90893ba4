"""A robot folder from a URDF: the chain, what the URDF says, and rules for what it doesn't, each marked as a guess."""
