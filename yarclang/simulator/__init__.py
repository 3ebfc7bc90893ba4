"""A Turbo PMAC without hardware: its commands, programs and motions in virtual time.

`machine.py` is the controller, of parts that see what they need of it: `language/` reads its language,
`online/` executes on-line commands, `programs/` motion programs and PLCs, `motion/` moves the motors,
`state/` has variables, registers and status words. `network/` serves it. `commissioning.py` makes it a
robot's controller, `faults.py` spoils things on purpose, `beside.py` is what the machines around the robot
see.
"""
