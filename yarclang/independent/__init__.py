"""An independent reading of emitted texts: how far what is executed is from what a program says, and how much of each limit it uses.

It shares nothing with the compiler and its certificate: regular expressions read the text, tomllib the robot, Pinocchio the URDF, and scipy's
splines are what is executed. It samples densely, so it finds faults and proves nothing.
"""
