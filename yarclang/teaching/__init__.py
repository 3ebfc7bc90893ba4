"""Small edits of a program's text that is shown as a list of commands: teaching of motions, touching up of
taught points, forms for new commands, templates for new programs.
"""
