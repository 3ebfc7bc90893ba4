"""The catalogue of findings (errors, warnings and notes) by code. Each file y*.py of this folder is a family
of codes. Of the rest of yarclang, this package imports only `named` and `frozen`.
"""

from importlib import import_module
from pkgutil import iter_modules

from yarclang.findings.finding import Finding, Follows, Need, Severity, family_of, number_of
from yarclang.named import by_name

FAMILIES = {
    "01": "syntax",
    "02": "names",
    "03": "frames and units",
    "04": "values",
    "05": "reach",
    "06": "limits and time",
    "07": "singularity",
    "08": "configuration",
    "09": "collision and workspace",
    "10": "flow",
    "11": "controller and certificate",
    "12": "style",
    "13": "robot, cell and settings files",
    "14": "logs of runs",
    "15": "imported and exported files, new projects",
    "16": "runs on a controller",
    "17": "suppressed findings",
    "18": "dynamics",
    "19": "calibration",
    "20": "yarclang itself",
}
"""Titles of the families, by their two digits."""

SYNTAX = "01"
"""Family of syntax errors."""

YARCLANG = "20"
"""Family of findings that aren't the user's fault."""


def _catalogue() -> dict[str, Finding]:
    names = sorted(module.name for module in iter_modules(__path__) if module.name.startswith("y"))
    families: dict[str, tuple[Finding, ...]] = {
        name: import_module(f"{__name__}.{name}").FINDINGS for name in names
    }
    return by_name(
        "finding",
        ((finding.code, f"{__name__}.{name}", finding) for name in names for finding in families[name]),
    )


CATALOGUE = _catalogue()
"""Every finding by its code."""

__all__ = [
    "CATALOGUE",
    "FAMILIES",
    "SYNTAX",
    "YARCLANG",
    "Finding",
    "Follows",
    "Need",
    "Severity",
    "family_of",
    "number_of",
]
