"""The pendant's API and its pages, over HTTP and WebSocket (docs/pendant.md)."""
