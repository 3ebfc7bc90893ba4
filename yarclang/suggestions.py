"""Find the known name that is most similar to a mistyped word."""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

_LONGEST_NAME = 200
"""Largest number of characters of a word that is compared with names. A longer word isn't a mistyped name."""


_NEAR = 0.6
"""Smallest similarity of a mistyped word and a name: difflib's ratio."""

_SHORTEST_SLIP = 3
"""Smallest number of letters of the shorter word at which a missing or additional letter counts as a typing
mistake. Shorter words count as different words.
"""

_AS_NEAR = 0.08
"""Largest difference of similarity at which a name counts as just as likely as the most similar name."""

_MOST_LIKELY = 12
"""Number of names whose longest common subsequence with a mistyped word is computed. They are the most
similar names by their letters.
"""

_MOST_COMPARED, _COMPARED_LETTERS = 5, 150
"""Largest number of names that difflib compares with a mistyped word, and of their letters in total. The time
grows with the square of the letters.
"""


def nearest(word: str, known: Iterable[str]) -> str:
    """Return the known name most similar to a mistyped word, regardless of case; empty if none is similar."""
    return next(iter(near(word, known)), "")


def near(word: str, known: Iterable[str]) -> tuple[str, ...]:
    """Return the known names similar to a mistyped word, regardless of case.

    The first name is the most similar. The others are nearly as similar.
    """
    return _near(word.upper(), tuple(known))


def is_slip(word: str, name: str) -> bool:
    """Return True if a word looks like a mistyped name: one letter missing, one too many, or two exchanged.

    A changed letter or number doesn't count, since it makes another name: PICK2 isn't PICK1, and SIDE_B isn't
    SIDE_A.
    """
    one, other = word.upper(), name.upper()
    if len(one) == len(other):
        apart = [at for at, (mine, theirs) in enumerate(zip(one, other, strict=True)) if mine != theirs]
        if len(apart) != 2 or apart[1] != apart[0] + 1:
            return False
        changed = one[apart[0] : apart[1] + 1]
        return changed[::-1] == other[apart[0] : apart[1] + 1] and changed.isalpha()
    shorter, longer = sorted((one, other), key=len)
    if len(longer) != len(shorter) + 1 or len(shorter) < _SHORTEST_SLIP:
        return False
    at = next((at for at, letter in enumerate(shorter) if letter != longer[at]), len(shorter))
    # A letter at the end distinguishes names, as in PART and PARTS, unless it repeats the last letter.
    if at == len(shorter):
        return longer[-1].isalpha() and longer[-1] == longer[-2]
    return longer[at].isalpha() and shorter[at:] == longer[at + 1 :]


@lru_cache(maxsize=256)
def _near(word: str, known: tuple[str, ...]) -> tuple[str, ...]:
    from difflib import SequenceMatcher, get_close_matches

    if len(word) > _LONGEST_NAME:
        return ()
    names, letters = _described(known)
    close = get_close_matches(word, _likely(word, names, letters), n=5, cutoff=_NEAR)
    if not close:
        return ()
    # If names are equally similar, prefer the name with the same letters in another order.
    close.sort(key=lambda name: sorted(name) != sorted(word))
    if sorted(close[0]) == sorted(word):
        return tuple(names[name] for name in close if sorted(name) == sorted(word))
    likeness = [SequenceMatcher(None, name, word).ratio() for name in close]
    return tuple(
        names[name] for name, like in zip(close, likeness, strict=True) if like > likeness[0] - _AS_NEAR
    )


@lru_cache(maxsize=8)
def _described(known: tuple[str, ...]) -> tuple[dict[str, str], tuple[int, ...]]:
    """Return names by their upper-case form, and the letters of each name as bits."""
    names = dict(zip(map(str.upper, known), known, strict=True))
    return names, tuple(map(_letters, names))


def _likely(word: str, names: Iterable[str], letters: Iterable[int]) -> list[str]:
    """Select the few names that may be most similar to a word.

    Two upper bounds of difflib's ratio select the names. The first compares lengths and letters, and takes a
    hundredth of difflib's time. The second uses the longest common subsequence, and takes a tenth; it is
    computed only for the names that are best by the first bound.

    Args:
        word: the typed word.
        names: the names.
        letters: the letters of each name.
    """
    from heapq import nlargest

    mine, length, begin = _letters(word), len(word), word[: len(word) // 2]
    # A similar name has `common` letters in common with the word: 2 common >= _NEAR (length + other), and
    # other >= common. From this follows the least number of different letters of the word that the name
    # contains.
    fewest = mine.bit_count() - length + _NEAR / (2.0 - _NEAR) * length
    pairs = [
        (name, theirs)
        for name, theirs in zip(names, letters, strict=True)
        if (mine & theirs).bit_count() >= fewest
    ]
    found = []
    for name, theirs in pairs:
        other = len(name)
        both = length + other
        least = _NEAR / 2.0 * both
        common = length - (mine & ~theirs).bit_count()
        if common >= least and (rest := other - (theirs & ~mine).bit_count()) >= least:
            found.append((min(common, rest) / both, name.startswith(begin), name))
    most = max(_MOST_LIKELY, length // 2)  # letters tell little about long words
    if len(found) > most:
        found = nlargest(most, found)
    enough = min(_MOST_COMPARED, max(1, _COMPARED_LETTERS // max(1, length)))
    if len(found) > enough:
        places = _places(word)
        found.sort(key=lambda one: _common(places, length, one[2]) / (length + len(one[2])), reverse=True)
    return [name for _, _, name in found[:enough]]


def _places(word: str) -> dict[str, int]:
    """Return the places of each letter of a word, one bit for each place."""
    found: dict[str, int] = {}
    for place, letter in enumerate(word):
        found[letter] = found.get(letter, 0) | 1 << place
    return found


def _common(places: dict[str, int], length: int, name: str) -> int:
    """Return the length of the longest common subsequence of a word and a name.

    A row of the usual table is one integer: a bit is 0 where the row's value rises (Hyyrö, Bit-Parallel
    LCS-length Computation Revisited, 2004).

    Args:
        places: places of the word's letters.
        length: length of the word.
        name: the name.
    """
    row = whole = (1 << length) - 1
    for letter in name:
        met = row & places.get(letter, 0)
        row = ((row + met) | (row - met)) & whole
    return length - row.bit_count()


@lru_cache(maxsize=2048)
def _letters(word: str) -> int:
    """Return a bit for each letter of a word. Several letters may share one bit."""
    bits = 0
    for letter in word:
        bits |= 1 << (ord(letter) & 63)
    return bits
