"""Show programs and recorded or live runs in three dimensions: the scene as plain data, and its display in a
browser.
"""
