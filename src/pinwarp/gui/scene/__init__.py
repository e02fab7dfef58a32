"""What a viewport shows and from where, without a toolkit."""
