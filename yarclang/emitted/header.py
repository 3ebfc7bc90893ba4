"""The comments at the top of a controller text (the compiler's output): its origin, start position and
duration.
"""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.lasting import Lasting

COLUMNS = "commands: step, index, name, line in the source, first and last line of the moves in this file"

UNSEALED = "-"
"""Placeholder for a certificate or a seal that does not exist yet."""


@frozen
class Header:
    """Facts about a controller text, for people and for the judge (the independent checker of the text).

    The judge trusts none of these facts: it compares or ignores them.

    Attributes:
        version: version of the compiler yarcc.
        source: file name of the program.
        target: name of the target within its kind of controller.
        loading: advice for a person who loads the text by hand.
        robot: name of the robot.
        robot_fingerprint: SHA-256 of the robot's description, in hexadecimal.
        program_fingerprint: SHA-256 of the program's behaviour, in hexadecimal.
        made_with: the packages that were used, with their versions.
        start: joint positions at the start of the motion, printed as a move line.
        units: axis units, such as `deg, mm`.
        lasting: known time of all motions and dwells, and the number of waits.
        segments: segment times in use as printed [ms]: none, one, or the least and the largest.
        longest: longest segment time that --tm allowed, as printed [ms]; empty if the robot's own limit
            applied.
        searches: number of searches for a path around obstacles (--avoid-effort), of whose paths the quickest
            was used; 1 if the first path found was used.
        certificate: one line that summarises the proofs.
        seal: SHA-256 of the whole text with `UNSEALED` in its place, in hexadecimal. It reveals damage and
            edits. It is no signature, since anybody can compute it.
    """

    version: str
    source: str
    target: str
    loading: str
    robot: str
    robot_fingerprint: str
    program_fingerprint: str
    made_with: str
    start: str
    units: str
    lasting: Lasting
    segments: tuple[str, ...]
    longest: str = ""
    searches: int = 1
    certificate: str = UNSEALED
    seal: str = UNSEALED

    def lines(self) -> tuple[str, ...]:
        """Return the lines of the header without the leading `; `."""
        segments = f", segments of {' to '.join(self.segments)} ms" if self.segments else ""
        longest = (f"longest segment asked for {self.longest} ms",) if self.longest else ()
        searches = (f"ways round: the quickest of {self.searches} searches",) if self.searches > 1 else ()
        return (
            f"yarcc {self.version}: {self.source}",
            f"target {self.target}",
            f"robot {self.robot} {self.robot_fingerprint}",
            f"program {self.program_fingerprint}",
            f"made with {self.made_with}",
            f"start {self.start} ({self.units})",
            f"duration {self.lasting.text()}{segments}",
            *longest,
            *searches,
            self.loading,
            COLUMNS,
            f"certificate {self.certificate}",
            f"sha256 {self.seal}",
        )
