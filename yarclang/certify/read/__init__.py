"""Reading of a controller text: header, lines, numbers, and the segments that they define.

`reader.py` finds the reader for a kind of controller, which returns a `ControllerText` (`text.py`). All kinds
of controllers share the readers of the header (`header.py`), of lines (`lines.py`) and of the numbers in move
lines (`numbers.py`). `layout.py` converts the lines to spline segments, each with its command.
"""
