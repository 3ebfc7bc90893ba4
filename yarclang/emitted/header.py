"""The comments at the top of a controller text: what it was made of, where it starts, how long it takes."""

from __future__ import annotations

from yarclang.frozen import frozen
from yarclang.lasting import Lasting

COLUMNS = "commands: step, index, name, line in the source, first and last line of the moves in this file"

UNSEALED = "-"
"""Stands in place of a certificate or a seal that isn't made yet."""


@frozen
class Header:
    """Facts about a controller text, for people and for whoever judges the text. Nothing in it is trusted: the judge compares or ignores it.

    Attributes:
        version: of yarcc.
        source: the program's file name.
        target: what the text is for, by a name that its kind of controller has.
        loading: what a person who loads the text by hand must know.
        robot: the robot's name.
        robot_fingerprint: SHA-256 of the robot's description, in hexadecimal.
        program_fingerprint: SHA-256 of what the program does, in hexadecimal.
        made_with: the packages that took part, with their versions.
        start: the joint positions at which the motion begins, printed as a move line.
        units: the axis units, such as `deg, mm`.
        lasting: the time that all motions and dwells take, and the number of waits.
        segments: the segment times in use as printed [ms]: none, one, or the least and the largest.
        longest: the longest segment time that was asked for (--tm) as printed [ms]; empty for the robot's own.
        searches: how many ways round obstacles were looked for (--avoid-effort), of which the quickest was taken; 1 for the first that was found.
        certificate: one line that sums up what was proved.
        seal: SHA-256 of the whole text with `UNSEALED` in its place, in hexadecimal. It shows that a text was damaged or edited; it is no
            signature, since anybody can compute it.
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
        """Return the header's lines without the leading `; `."""
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
