"""Divide meshes into convex pieces, for the computation of distances."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from yarclang.collision.geometry import Geometry, UnreadableError, content_key, geometry_of, hull_of
from yarclang.collision.tiles import modelled
from yarclang.meshes.kept import kept_pieces
from yarclang.meshes.pieces import Piece, pieces_of
from yarclang.shapes import Mesh


class OpenMeshError(UnreadableError):
    """A mesh that is to be divided into convex pieces doesn't enclose a volume."""


def pieces_of_mesh(shape: Mesh) -> tuple[Geometry, ...]:
    """Divide a mesh into convex pieces, at most as many as its description requests.

    Raises:
        UnreadableError: the mesh can't be read.
        OpenMeshError: the mesh doesn't enclose a volume.
    """
    whole = replace(shape, pieces=0)
    if shape.pieces == 1:
        return (geometry_of(whole, hull=True),)
    key = f"pieces 1 {shape.pieces} {content_key(shape)}"
    found = kept_pieces(key, lambda: _divided(whole, shape.pieces)) if shape.digest else None
    return tuple(map(_piece, found or _divided(whole, shape.pieces)))


def _divided(shape: Mesh, most: int) -> tuple[Piece, ...]:
    skin = geometry_of(shape).skin
    if skin is None:
        raise OpenMeshError
    return pieces_of(skin, most)


def _piece(piece: Piece) -> Geometry:
    model = modelled(piece.corners, np.arange(len(piece.corners) // 3 * 3).reshape(-1, 3))
    return replace(hull_of(model, piece.corners), cell=(piece.low, piece.high))
