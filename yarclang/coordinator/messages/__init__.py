"""All messages from and to a coordinator: orders, replies, events, and targets of a live motion. Each message
is a type with one JSON form.

Within a process, messages are objects. Sockets transfer them as JSON, one object per line (`lines.py`).
docs/coordinator.md lists all messages; the lists are generated from these types.
"""
