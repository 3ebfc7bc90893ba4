"""Changes of controller texts as a careful forger makes them: the map's line numbers are moved along, the
seal is made anew.
"""

import hashlib
import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Forger:
    """A controller text that is changed, line by line."""

    lines: tuple[str, ...]

    @classmethod
    def of(cls, text):
        assert text.endswith("\n")
        return cls(tuple(text[:-1].split("\n")))

    @property
    def text(self):
        """The whole, with a seal that fits."""
        plain = re.sub(r"(?m)^; sha256 .*$", "; sha256 -", "\n".join(self.lines) + "\n", count=1)
        seal = hashlib.sha256(plain.encode("utf-8", "surrogatepass")).hexdigest()
        return plain.replace("\n; sha256 -\n", f"\n; sha256 {seal}\n", 1)

    def find(self, form, number=0):
        """The place of a line, by an expression that matches all of it."""
        places = [k for k, line in enumerate(self.lines) if re.fullmatch(form, line)]
        assert places, f"no line is {form}"
        return places[number]

    def has(self, form):
        return any(re.fullmatch(form, line) for line in self.lines)

    def put(self, place, *lines):
        """Lines more in front of a place; the map is moved along."""
        return self._moved(place, len(lines), (*self.lines[:place], *lines, *self.lines[place:]))

    def drop(self, place, count=1):
        """Lines less; the map is moved along."""
        return self._moved(place, -count, (*self.lines[:place], *self.lines[place + count :]))

    def change(self, form, becomes, number=0):
        """One line is another; `becomes` may name groups."""
        place = self.find(form, number)
        line = re.sub(form, becomes, self.lines[place])
        assert line != self.lines[place]
        return Forger((*self.lines[:place], line, *self.lines[place + 1 :]))

    def all(self, form, becomes):
        """Every such line is another."""
        return Forger(tuple(re.sub(f"^(?:{form})$", becomes, line) for line in self.lines))

    def moves(self):
        """The places of the move lines of motions, by their order."""
        begin = self.find("SPLINE1") + 1
        return [k for k, line in enumerate(self.lines) if k >= begin and re.match(r"[XU]-?[0-9]", line)]

    def scaled(self, factor):
        """All numbers of all move lines, the start among them, by a factor; also in the header."""

        def larger(found):
            return f"{found[1]}{float(found[2]) * factor:.6f}"

        number = r"([XYZABCUVW])(-?[0-9.]+)"
        lines = [
            re.sub(number, larger, line) if re.match(r"(; start )?[XU]-?[0-9]", line) else line
            for line in self.lines
        ]
        return Forger(tuple(lines))

    def _moved(self, place, by, lines):
        """Line numbers (from 1) of what stood behind a place, in the map."""

        def shifted(number):
            return str(int(number) + by if int(number) > place else int(number))

        def one(line):
            if found := re.fullmatch(r"(; command \S+ \S+ \S+ \S+) (\d+) (\d+)(.*)", line):
                return f"{found[1]} {shifted(found[2])} {shifted(found[3])}{found[4]}"
            if found := re.fullmatch(r"(; barrier) (\d+) (.*)", line):
                return f"{found[1]} {shifted(found[2])} {found[3]}"
            return line

        return Forger(tuple(map(one, lines)))
