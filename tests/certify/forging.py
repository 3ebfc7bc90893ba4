"""Changes of controller texts like those of a careful forger, who updates the map's line numbers and renews
the seal.
"""

import hashlib
import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Forger:
    """A controller text that is changed line by line."""

    lines: tuple[str, ...]

    @classmethod
    def of(cls, text):
        assert text.endswith("\n")
        return cls(tuple(text[:-1].split("\n")))

    @property
    def text(self):
        """Return the whole text, with a valid seal."""
        plain = re.sub(r"(?m)^; sha256 .*$", "; sha256 -", "\n".join(self.lines) + "\n", count=1)
        seal = hashlib.sha256(plain.encode("utf-8", "surrogatepass")).hexdigest()
        return plain.replace("\n; sha256 -\n", f"\n; sha256 {seal}\n", 1)

    def find(self, form, number=0):
        """Return the place of a line that an expression matches completely."""
        places = [k for k, line in enumerate(self.lines) if re.fullmatch(form, line)]
        assert places, f"no line is {form}"
        return places[number]

    def has(self, form):
        return any(re.fullmatch(form, line) for line in self.lines)

    def put(self, place, *lines):
        """Insert lines before a place, and update the map."""
        return self._moved(place, len(lines), (*self.lines[:place], *lines, *self.lines[place:]))

    def drop(self, place, count=1):
        """Delete lines, and update the map."""
        return self._moved(place, -count, (*self.lines[:place], *self.lines[place + count :]))

    def change(self, form, becomes, number=0):
        """Replace one line. `becomes` may refer to groups."""
        place = self.find(form, number)
        line = re.sub(form, becomes, self.lines[place])
        assert line != self.lines[place]
        return Forger((*self.lines[:place], line, *self.lines[place + 1 :]))

    def all(self, form, becomes):
        """Replace every line that matches `form`."""
        return Forger(tuple(re.sub(f"^(?:{form})$", becomes, line) for line in self.lines))

    def moves(self):
        """Return the places of the motions' move lines, in order."""
        begin = self.find("SPLINE1") + 1
        return [k for k, line in enumerate(self.lines) if k >= begin and re.match(r"[XU]-?[0-9]", line)]

    def scaled(self, factor):
        """Multiply all numbers of all move lines by a factor, including the start and the header."""

        def larger(found):
            return f"{found[1]}{float(found[2]) * factor:.6f}"

        number = r"([XYZABCUVW])(-?[0-9.]+)"
        lines = [
            re.sub(number, larger, line) if re.match(r"(; start )?[XU]-?[0-9]", line) else line
            for line in self.lines
        ]
        return Forger(tuple(lines))

    def _moved(self, place, by, lines):
        """Shift the line numbers (from 1) in the map that are after a place."""

        def shifted(number):
            return str(int(number) + by if int(number) > place else int(number))

        def one(line):
            if found := re.fullmatch(r"(; command \S+ \S+ \S+ \S+) (\d+) (\d+)(.*)", line):
                return f"{found[1]} {shifted(found[2])} {shifted(found[3])}{found[4]}"
            if found := re.fullmatch(r"(; barrier) (\d+) (.*)", line):
                return f"{found[1]} {shifted(found[2])} {found[3]}"
            return line

        return Forger(tuple(map(one, lines)))
