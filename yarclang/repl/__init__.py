"""`yarc repl`: work with a robot in a terminal.

Typed texts are sent to a coordinator (the process that owns the robot); this package knows neither the
language nor the robot. `interpreter.py` reads typed texts, `session.py` holds the state of a user's session,
`dots/` contains the dot commands (`dot.py`), and `jogging.py` interprets keys. `console.py` is the terminal,
with `completion.py` and `toolbar.py`.
"""
