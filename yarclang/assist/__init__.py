"""What helps people who write programs: names and where they are used, what may stand here, what something means.

All of it is pure: a text, a place in it and what the pipeline has made of it lead to values of this package. Editors and the
interpreter show them, each in its way.
"""
