"""The project's folder as the pendant sees it: files, what was deleted, and what has changed since the last commit."""
