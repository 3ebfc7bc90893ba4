"""The judge of the controller's settings: it reads a settings text and proves what certificates rely on.

`judge.py` is the entry point; `read.py` reads the text, `text.py` defines its content. `system.py` judges the
I-variables of the coordinate system and the controller, `motors.py` and `rates.py` those of the motors,
`positions.py` the axis definitions and PLC 0, whose expressions `expression.py` evaluates. `coupling.py` has
the matrices between joints and motors in exact numbers.
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
