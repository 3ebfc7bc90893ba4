"""Find the argument that a CALL gives for each parameter of a SUB: by position first, then by name. A
parameter without an argument gets its default.
"""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from yarclang.diagnostics import Collector
from yarclang.semantics.files import values_of
from yarclang.subjects import unknown
from yarclang.syntax.ast import FrameName, NamedValue, Other, Parameter, Statement, Value, Word
from yarclang.syntax.leaves import from_to


def matched(statement: Statement, head: Statement, findings: Collector) -> tuple[Value | None, ...] | None:
    """Return the argument that a CALL gives for each parameter of a SUB.

    Args:
        statement: the CALL.
        head: the SUB's first line.
        findings: the findings of the CALL's file; receives one for each argument without a parameter.

    Returns:
        The arguments in the order of the parameters; an element is None if the parameter's default applies.
        None instead of the arguments if an argument has no parameter, or a parameter has neither default nor
        argument.
    """
    wanted, given = parameters_of(head), values_of(statement)[1:]
    if not _in_order(statement, given, findings):
        return None
    by_position = [one for one in given if not isinstance(one, NamedValue)]
    name = values_of(head)[0].text
    if len(by_position) > len(wanted) or (
        len(by_position) == len(given) < _least(wanted) and not any(map(_has_default, wanted))
    ):
        listed = " ".join(value.text for value in wanted) or "nothing"
        message = (
            f"{name} takes {len(wanted)} argument{'s' * (len(wanted) != 1)} ({listed}), {len(given)} given"
        )
        if given and len(given) < len(wanted):
            message += f"; {', '.join(map(_shown, wanted[len(given) :]))} is missing"
        help_ = f"write CALL {name} {listed}, with a value for each" if wanted else f"write CALL {name} alone"
        findings.add("Y0411", message, statement.whole_span, help_)
        return None
    found: dict[int, Value] = dict(enumerate(by_position))
    fine = True
    for one in given:
        if isinstance(one, NamedValue):
            fine &= _by_name(statement, one, head, found, findings)
    lacking = [one for at, one in enumerate(wanted) if at not in found and not (_has_default(one))]
    if fine and lacking:
        listed = ", ".join(_shown(one) for one in lacking)
        how = " ".join(f"{_plain(one)}={'{...}' if isinstance(one, FrameName) else '...'}" for one in lacking)
        message = f"{name} needs a value for {listed}"
        findings.add("Y0411", message, statement.whole_span, f"add {how} to the line")
    return tuple(found.get(at) for at in range(len(wanted))) if fine and not lacking else None


def _in_order(statement: Statement, given: list[Value], findings: Collector) -> bool:
    """Check that a CALL's unnamed arguments come before the named ones, and that names before an equals sign
    have no braces.
    """
    named: NamedValue | None = None
    for frame, sign in pairwise(given):
        if isinstance(frame, FrameName) and isinstance(sign, Other) and sign.text.startswith("="):
            help_ = f"write {frame.name}={{...}}"
            message = f"a name in front of `=` has no braces: {frame.text}"
            findings.add("Y0411", message, statement.span(from_to(frame.place, sign.place)), help_)
            return False
    for one in given:
        if isinstance(one, NamedValue):
            named = one
        elif named is not None:
            message = f"`{one.text}` has no name and follows `{named.text}`"
            help_ = "arguments without a name come first, in the order of the SUB"
            findings.add("Y0491", message, statement.span(one.place), help_)
            return False
    return True


def _by_name(
    statement: Statement, one: NamedValue, head: Statement, found: dict[int, Value], findings: Collector
) -> bool:
    """Find the parameter of a named argument, and store the argument in `found` by the parameter's number.

    Returns:
        False with a finding if no parameter has this name, or if the parameter has an argument already.
    """
    wanted = parameters_of(head)
    span = statement.span(one.word.place)
    named = [at for at, parameter in enumerate(wanted) if _plain(parameter) == one.word.name]
    if not named:
        sub = values_of(head)[0].text
        subject = unknown(one.word.text, [_plain(parameter) for parameter in wanted])
        help_ = subject.question or (
            f"it takes {' '.join(map(_shown, wanted))}" if wanted else f"write CALL {sub} alone"
        )
        findings.add("Y0489", f"{sub} has no parameter {one.word.text}", span, help_, subject=subject)
        return False
    # A frame and a number may have the same name: the kind of the value decides which of them is meant.
    of_kind = [at for at in named if isinstance(wanted[at], FrameName) == isinstance(one.value, FrameName)]
    at = (of_kind or named)[0]
    if at in found:
        message = f"{_shown(wanted[at])} is given twice: `{found[at].text}` and `{one.value.text}`"
        findings.add("Y0490", message, statement.span(one.place), "remove one of them")
        return False
    found[at] = one.value
    return True


def arguments_by_name(statement: Statement, head: Statement) -> Mapping[str, Value]:
    """Return the arguments of a CALL except frames, by the names of their parameters in upper case.

    Args:
        statement: the CALL; arguments without a parameter are left out.
        head: the SUB's first line.
    """
    found: dict[str, Value] = {}
    names = names_of_parameters(head)
    for at, one in enumerate(values_of(statement)[1:]):
        if isinstance(one, NamedValue):
            found[one.word.name] = one.value
        elif at < len(names):
            found[names[at]] = one
    return {name: value for name, value in found.items() if name in names and name}


def parameters_of(head: Statement) -> list[Value]:
    """Return the parameters of a SUB: the values after its name in its first line."""
    return values_of(head)[1:]


def names_of_parameters(head: Statement) -> list[str]:
    """Return the names of a SUB's parameters in upper case, with an empty text for each frame."""
    words = map(word_of, parameters_of(head))
    return [word.name if word is not None else "" for word in words]


def word_of(parameter: Value) -> Word | None:
    """Return the name of a parameter; None for a frame."""
    if isinstance(parameter, Parameter):
        return parameter.word
    return parameter if isinstance(parameter, Word) else None


def _plain(parameter: Value) -> str:
    """Return the name of a parameter in upper case, without braces."""
    word = word_of(parameter)
    return parameter.name if isinstance(parameter, FrameName) else word.name if word is not None else ""


def _shown(parameter: Value) -> str:
    """Return the name of a parameter as messages show it."""
    return f"{{{parameter.name}}}" if isinstance(parameter, FrameName) else _plain(parameter)


def _has_default(parameter: Value) -> bool:
    return isinstance(parameter, Parameter) and parameter.default is not None


def _least(wanted: list[Value]) -> int:
    """Return the smallest number of arguments that a CALL needs."""
    return sum(not _has_default(one) for one in wanted)
