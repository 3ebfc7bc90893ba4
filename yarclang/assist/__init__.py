"""Help for people who write programs: completion, navigation, hover texts, repairs and more.

All functions are pure: they compute values of this package from a program's text, a place in it and the
results of compiling it. Editors and the interpreter show these values, each in its own way.
"""
