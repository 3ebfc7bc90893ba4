"""Plan a chain of motions of one moving frame as one path with one law: the path is sampled, smoothed in
time, and checked as a whole.
"""
