"""In what portions the loops over points work, compiled or not."""

# Points are taken in blocks that stay in the first-level cache.
BLOCK = 512
# Fields are stored in 16 bits: the largest value of a block becomes this.
LARGEST_FIELD = 32767.0
