"""An independent check of emitted texts: the distance between the executed motion and the motion that the
program asks for, and the used fraction of each limit.

It shares no code with the compiler and its certificate: regular expressions read the text, tomllib reads the
robot description, Pinocchio reads the URDF, and splines of scipy are the executed motion. The motion is
densely sampled, so this check finds faults but proves nothing.
"""
