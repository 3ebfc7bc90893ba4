"""The judge of the controller's settings: reads their text back and proves that they are what certificates rest on."""

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
