"""What the pendant's API says beside the coordinator's own messages: typed, each with one JSON form."""
