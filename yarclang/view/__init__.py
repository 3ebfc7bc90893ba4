"""Show programs, recorded runs and running robots in three dimensions: the scene as plain data, and its
display in a browser.
"""
