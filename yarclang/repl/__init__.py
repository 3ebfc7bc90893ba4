"""`yarc repl`: a person at the robot with a terminal. What is typed goes to a coordinator; nothing of the language or the robot is known here.

`interpreter.py` takes what is typed, `session.py` is what the person's session knows and asks; `dots/` are
the dot commands (`dot.py`), `jogging.py` is what keys mean. `console.py` is the terminal, with
`completion.py` and `toolbar.py`.
"""
