"""All stages from program text to certified controller text. This is the only package that knows all of
them.
"""
