"""The features, one in each file. Each translates one kind of result of yarclang.assist or the pipeline."""
