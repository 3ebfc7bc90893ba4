"""The project's folder at the pendant: its files, the trash, and the changes since the last commit."""
