"""Find faults in mesh files of any format."""

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
    """Return the end of a sentence that names the fault that makes a mesh useless as a body; empty if there
    is none.

    Args:
        suffix: suffix of the file's name, in any case, with its dot. Formats other than STL, OBJ, DAE and PLY
            aren't checked.
        content: the file. Content for pictures only isn't checked.
    """
    if not content.strip():
        return "is empty"
    look = _FAULTS.get(suffix.lower())
    return look(content) if look is not None else ""
