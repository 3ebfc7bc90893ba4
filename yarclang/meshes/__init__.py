"""Files of meshes, as their bytes show them: what makes one useless as a body.

The library that reads meshes drops a face that it can't read, or ends the whole process, so that a file is looked through before.
"""
