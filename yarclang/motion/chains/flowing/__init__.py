"""Chains of motions of one moving frame as one path with one law: sampled, smoothed in time, and looked at as a whole."""
