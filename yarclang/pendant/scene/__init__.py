"""The robot in three dimensions for the pages: view's stage as messages and as bytes that a browser draws."""
