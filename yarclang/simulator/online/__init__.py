"""On-line commands, by what they are about.

`interpreter.py` executes a line (`line.py`) by the table of `commands.py`, `questions.py` one that only asks,
`controls.py` control characters; `background.py` executes what programs send. The commands: `motors.py`,
`systems.py`, `variables.py`, `buffers.py`, `controller.py`. `surroundings.py` says what they reach.
"""
