"""Reading of a controller text: header, lines, numbers, and the segments that they define.

`reader.py` finds the reader for a kind of controller, which returns a `ControllerText` (`text.py`). All kinds
share the header (`header.py`), the position in the text (`lines.py`) and move lines as numbers
(`numbers.py`). `layout.py` converts the lines to spline segments, each with its command.
"""
