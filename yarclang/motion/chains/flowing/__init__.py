"""Make chains of motions of one moving frame as one path with one law: sampled, smoothed in time, and
examined as a whole.
"""
