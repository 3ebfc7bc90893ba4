"""The features, one a file: each translates one thing that yarclang.assist or the pipeline knows."""
