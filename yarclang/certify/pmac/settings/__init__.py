"""The judge of the controller's settings: reads their text back and proves that they are what certificates rest on.

`judge.py` is the door; `read.py` reads, `text.py` is what was read. `system.py` judges the I-variables of
coordinate system and controller, `motors.py` and `rates.py` those of the motors, `positions.py` the axis
definitions and PLC 0, whose expressions are in `expression.py`; `coupling.py` has the robot's matrices in
exact numbers.
"""

from yarclang.certify.pmac.settings.judge import ProvedSettings, certify_settings
from yarclang.certify.pmac.settings.text import Definition, Listing, Pointer, Setting, SettingsText

__all__ = [
    "Definition",
    "Listing",
    "Pointer",
    "ProvedSettings",
    "Setting",
    "SettingsText",
    "certify_settings",
]
