"""Plan a chain of motions of one moving frame as one path with one motion profile: poses along the path are
sampled, smoothed in time, and checked as a whole.
"""
