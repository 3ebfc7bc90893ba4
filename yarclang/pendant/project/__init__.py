"""The project's folder on the pendant: its files, the trash, and the changes since the last commit."""
