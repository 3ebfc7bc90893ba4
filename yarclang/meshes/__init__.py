"""Checks of mesh files for faults that make the mesh useless as a body.

The library that reads meshes ignores faces that it can't read, or even ends the whole process. Files are
therefore checked first.
"""
