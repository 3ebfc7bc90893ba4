"""Turn a checked program into a motion plan: paths, motion profiles along them, and the curve that the
controller executes.
"""
