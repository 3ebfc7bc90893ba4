"""The workspace of a robot, that is, the cell's zones and obstacles and the joint limits: how pages show
and change it.
"""
