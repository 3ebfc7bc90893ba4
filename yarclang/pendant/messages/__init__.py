"""Messages of the pendant's API besides those of the coordinator: typed, each with one JSON form."""
