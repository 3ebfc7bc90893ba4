"""Checks of mesh files for faults that make them useless as a body.

The library that reads meshes drops faces that it can't read, or ends the whole process. Therefore files are
checked before.
"""
