"""All messages from and to a coordinator: orders, replies, events, and targets of a live motion. Each has one
type and one JSON form.

Within a process they are objects; every socket carries them as JSON, one object per line (`lines.py`).
docs/coordinator.md lists them all; the lists are made from these types.
"""
