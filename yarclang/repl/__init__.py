"""`yarc repl`: a person with a terminal at the robot.

Typed texts go to a coordinator; this package knows nothing of the language or the robot. `interpreter.py`
takes typed texts, `session.py` holds the state of a person's session, `dots/` contains the dot commands
(`dot.py`), and `jogging.py` interprets keys. `console.py` is the terminal, with `completion.py` and
`toolbar.py`.
"""
