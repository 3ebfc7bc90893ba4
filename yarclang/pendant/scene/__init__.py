"""The robot in three dimensions: the viewer's stage as messages and as binary meshes for browsers."""
