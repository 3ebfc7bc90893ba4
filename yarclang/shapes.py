"""The shapes of bodies, each around its frame's origin: of links, tools and obstacles alike. Lengths are in m."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen

Array = NDArray[np.float64]


@frozen(eq=False)
class Box:
    """A box around its frame's origin: `size` (3,) are its whole edges along x, y, z [m]."""

    size: Array


@frozen
class Sphere:
    """A sphere around its frame's origin [m]."""

    radius: float


@frozen
class Cylinder:
    """A cylinder around its frame's z axis; `length` [m] is halved by the origin."""

    radius: float
    length: float


@frozen
class Capsule:
    """All points within `radius` [m] of a piece of the frame's z axis; its `length` [m], without the caps, is halved by the origin."""

    radius: float
    length: float


@frozen
class Mesh:
    """The triangles of a file, whose coordinates times `unit` are in m; `digest` is the SHA-256 of its bytes.

    `scale` are factors of x, y and z besides.
    """

    path: Path
    unit: float
    digest: str
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)


Shape = Box | Sphere | Cylinder | Capsule | Mesh
