"""Turn a checked program into a motion plan: paths, laws of motion, and the curve that the controller
executes.
"""
