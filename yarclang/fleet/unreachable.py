"""Why a scheduler can't be used."""


class UnreachableError(Exception):
    """A scheduler that can't be used: the message says why, and what to do."""
