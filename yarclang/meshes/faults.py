"""What makes a file useless as a body, whatever its format."""

from __future__ import annotations

from collections.abc import Callable

from yarclang.meshes.dae import dae_fault
from yarclang.meshes.obj import obj_fault
from yarclang.meshes.ply import ply_fault
from yarclang.meshes.stl import stl_fault

_FAULTS: dict[str, Callable[[bytes], str]] = {
    ".stl": stl_fault,
    ".obj": obj_fault,
    ".dae": dae_fault,
    ".ply": ply_fault,
}


def mesh_fault(suffix: str, content: bytes) -> str:
    """Return the end of a sentence that names what makes a mesh useless as a body; empty if nothing does.

    Args:
        suffix: of the file's name, in any case, with its dot. Of other formats than STL, OBJ, DAE and PLY nothing is known.
        content: of the file. What only matters for pictures may be anything.
    """
    if not content.strip():
        return "is empty"
    look = _FAULTS.get(suffix.lower())
    return look(content) if look is not None else ""
