"""Shapes of bodies around the origins of their frames, for robot links, tools and obstacles. Lengths are
in m.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from yarclang.frozen import frozen

Array = NDArray[np.float64]


@frozen(eq=False)
class Box:
    """A box around its frame's origin.

    Attributes:
        size: (3,) full edge lengths along x, y, z [m].
    """

    size: Array


@frozen
class Sphere:
    """A sphere around its frame's origin.

    Attributes:
        radius: [m].
    """

    radius: float


@frozen
class Cylinder:
    """A cylinder around its frame's z axis, with its middle at the origin.

    Attributes:
        radius: [m].
        length: [m].
    """

    radius: float
    length: float


@frozen
class Capsule:
    """All points within a distance of a segment on the frame's z axis. The segment's middle is the origin.

    Attributes:
        radius: the distance [m].
        length: length of the segment, without the caps [m].
    """

    radius: float
    length: float


@frozen
class Mesh:
    """The triangles of a file.

    Attributes:
        path: the file.
        unit: length of the file's unit [m].
        digest: SHA-256 of the file's bytes.
        scale: further factors of x, y and z.
        pieces: largest number of convex pieces that replace the mesh; 0 to use the hull for links and tools,
            and the triangles for everything else.
    """

    path: Path
    unit: float
    digest: str
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    pieces: int = 0


Shape = Box | Sphere | Cylinder | Capsule | Mesh
