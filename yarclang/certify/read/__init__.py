"""Reads a controller text: header, lines, numbers, and the segments that they make.

`reader.py` finds the reader of a kind of controller, which gives a `ControllerText` (`text.py`). All kinds
share the header (`header.py`), the place in the text (`lines.py`) and move lines as numbers (`numbers.py`).
`layout.py` makes spline segments of the lines, each with its command.
"""
