"""How much a file may unpack to: a small one must not fill the memory."""

from __future__ import annotations

from pinwarp.io.mesh_formats.surface import BrokenMeshError

# A flat and regular mesh packs to a thirtieth; zeros, to a thousandth.
_MOST_UNPACKED = 50
_ALWAYS_ALLOWED = 64 << 20


class Allowance:
    """How many bytes all arrays of a file together may come to, in proportion to the file.

    Examples
    --------
    >>> Allowance(100).take(1000)
    """

    def __init__(self, size: int) -> None:
        self._left = max(_ALWAYS_ALLOWED, _MOST_UNPACKED * size)

    def take(self, size: int) -> None:
        """Set so many bytes aside before they are unpacked.

        Raises
        ------
        BrokenMeshError
            When so many are not left.
        """
        self._left -= size
        if self._left < 0:
            raise BrokenMeshError(
                "The file unpacks to far more than its size, which no mesh does. Export it again."
            )
