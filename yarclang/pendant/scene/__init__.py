"""The robot and its surroundings in three dimensions. A stage (all that the 3D viewer draws) is converted to
messages and binary meshes for browsers.
"""
