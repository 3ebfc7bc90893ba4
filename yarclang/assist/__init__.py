"""Help for people who write programs: completion, navigation, hover texts, repairs and more.

All functions are pure: they compute values of this package from a text, a place in the text and the results
of the pipeline. Editors and the interpreter show these values, each in its own way.
"""
