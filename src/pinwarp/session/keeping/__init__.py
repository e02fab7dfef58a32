"""Sessions on the disk, and work that is not saved yet."""
