"""Variables and memory (`registers.py`), what they show of the motion (`wiring.py`), status words (`status.py`), and what SAVE keeps (`saved.py`)."""
