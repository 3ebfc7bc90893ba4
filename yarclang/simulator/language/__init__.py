"""The controller's language: expressions, and the statements that a buffer can hold."""
