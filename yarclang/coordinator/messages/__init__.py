"""What is said to a coordinator and what it says: orders, replies, events, and what is wanted of a live motion. One type each, one JSON form.

Inside of a process they are objects; every socket carries them as JSON, one object a line (`lines.py`). docs/coordinator.md lists them all, made from these types.
"""
