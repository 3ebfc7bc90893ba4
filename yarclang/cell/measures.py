"""Convert numbers of a cell.toml to SI: the units of an entry, and its pose as a transform."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from yarclang.cell.model import Array
from yarclang.cell.schema import Placed
from yarclang.subjects import MissingUnit, unknown
from yarclang.toml.draft import spoken, table_name, table_of
from yarclang.toml.file import TomlFile
from yarclang.toml.places import Path
from yarclang.transforms import QUATERNION_TOLERANCE, constant, quaternion_rotation, rpy_rotation
from yarclang.units import UNITS, Kind, Unit, units_of


@dataclass(slots=True)
class Measures:
    """The units of a cell.toml, and the findings about them."""

    file: TomlFile
    common: Mapping[Kind, Unit] = field(default_factory=dict)
    """The units at the top of the file."""
    doubtful: bool = False
    """True if the units at the top of the file couldn't be read. This mistake was reported already, so
    missing units aren't reported.
    """

    def read_common(self, text: str | None) -> None:
        """Read the `units` at the top of the file."""
        found = self._parsed(text, ("units",))
        self.common, self.doubtful = found or {}, found is None

    def of_entry(self, text: str | None, path: Path) -> Mapping[Kind, Unit] | None:
        """Return the units that apply to the TOML table at `path`. For kinds of units that the table doesn't
        state, these are the units of the file. If the table's units can't be read, report it and return None.
        """
        own = self._parsed(text, (*path, "units"))
        return None if own is None else {**self.common, **own}

    def factor(self, units: Mapping[Kind, Unit] | None, kind: Kind, path: Path) -> float | None:
        """Return the factor that converts the value at `path` to SI. If the file states no unit for this
        value, report it and return None.
        """
        if units is None:
            return None
        if kind in units:
            return units[kind].factor
        if not self.doubtful:
            names = " or ".join(units_of(kind)[:2])
            remedy = (
                f'Name one ({names}) in units at the top of the file, as in units = "mm,deg", or in this '
                "table."
            )
            subject = MissingUnit(kind, table_of(path))
            self.file.say("Y0304", path, f"{spoken(path)} needs a unit of {kind}.", remedy, subject)
        return None

    def transform(self, placed: Placed, path: Path, units: Mapping[Kind, Unit] | None) -> Array | None:
        """Return the pose of an entry in its frame, as a transform (4, 4) [m]. Report a wrong entry, and
        return None for it.
        """
        made, sound = np.eye(4), True
        if placed.rpy is not None and placed.quat is not None:
            message = f"{table_name(path)} has two orientations: rpy and quat."
            self.file.say("Y1370", (*path, "quat"), message, "Remove one of them.", at_key=True)
            return None
        for key, size in (("xyz", 3), ("rpy", 3), ("quat", 4)):
            sound &= self.sized(getattr(placed, key), size, (*path, key))
        if not sound:
            return None
        if placed.xyz is not None:
            factor = self.factor(units, "length", (*path, "xyz"))
            sound &= factor is not None
            made[:3, 3] = np.array(placed.xyz) * (factor or 1.0)
        if placed.rpy is not None:
            factor = self.factor(units, "angle", (*path, "rpy"))
            sound &= factor is not None
            made[:3, :3] = rpy_rotation(np.array(placed.rpy) * (factor or 1.0))
        if placed.quat is not None:
            quaternion = np.array(placed.quat)
            norm = float(np.linalg.norm(quaternion))
            if abs(norm - 1.0) > QUATERNION_TOLERANCE:
                message = f"{spoken((*path, 'quat'))} has the norm {norm:.6g}, not 1."
                self.file.say(
                    "Y0404", (*path, "quat"), message, "The order is x y z w, with the real part last."
                )
                return None
            made[:3, :3] = quaternion_rotation(quaternion)
        return constant(made) if sound else None

    def told(self, placed: Placed, units: Mapping[Kind, Unit] | None) -> Array:
        """Return the pose of a correct entry as numbers in SI units, in the form in which it is written: x y
        z and roll pitch yaw (6,), or x y z and qx qy qz qw (7,).
        """
        known = units or {}
        length, angle = (known[kind].factor if kind in known else 1.0 for kind in ("length", "angle"))
        origin = [value * length for value in placed.xyz or (0.0, 0.0, 0.0)]
        if placed.quat is not None:
            return constant(np.array([*origin, *placed.quat]))
        return constant(np.array([*origin, *(value * angle for value in placed.rpy or (0.0, 0.0, 0.0))]))

    def sized(self, values: Sequence[object] | None, size: int, path: Path) -> bool:
        """Return True if a list has `size` entries or is missing. Otherwise report the wrong number of
        entries.
        """
        if values is None or len(values) == size:
            return True
        message = f"{spoken(path)} must have {size} values, but has {len(values)}."
        self.file.say("Y1309", path, message, f"Write {_SHAPES[size]}.")
        return False

    def _parsed(self, text: str | None, path: Path) -> dict[Kind, Unit] | None:
        """Return the units in a text such as "mm,deg". Report a wrong text, and return None for it."""
        found: dict[Kind, Unit] = {}
        for name in (text or "").split(",") if text is not None else ():
            unit = UNITS.get(name.strip().lower())
            if unit is None:
                subject = unknown(name.strip(), UNITS)
                remedy = (
                    f'{subject.question.capitalize()} Write units as in units = "mm,deg"; there are '
                    f"{', '.join(UNITS)}."
                )
                self.file.say("Y0305", path, f'"{name.strip()[:40]}" is no unit.', remedy.strip(), subject)
                return None
            if unit.kind in found:
                message = f"{found[unit.kind].name} and {unit.name} are both units of {unit.kind}."
                self.file.say("Y0306", path, message, "Remove one of them.")
                return None
            found[unit.kind] = unit
        return found


_SHAPES = {2: "[least, largest]", 3: "three numbers, such as [100, 50, 20]", 4: "four numbers, [0, 0, 0, 1]"}
