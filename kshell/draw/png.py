"""Pictures as PNG files: each row as differences of neighbours, which zlib compresses quickly.

Source of the format: ISO/IEC 15948, Portable Network Graphics (chunks IHDR, pHYs, IDAT, IEND; filter type 1).
"""

from __future__ import annotations

import struct
import zlib

import numpy as np
from numpy.typing import NDArray

SIGNATURE = b"\x89PNG\r\n\x1a\n"
TRUE_COLOUR = (8, 2, 0, 0, 0)  # bits, red green blue, and the only ways of compression, filtering and order


def png(pixels: NDArray[np.uint8], dots_per_inch: float, level: int) -> bytes:
    """The file.

    Parameters
    ----------
    pixels : (height, width, 3) array
    level : 1 to 9
        Of zlib.
    """
    height, width, channels = pixels.shape
    rows = pixels.reshape(height, width * channels)
    filtered = np.empty((height, 1 + width * channels), dtype=np.uint8)
    filtered[:, 0] = 1
    filtered[:, 1 : 1 + channels] = rows[:, :channels]
    np.subtract(rows[:, channels:], rows[:, :-channels], out=filtered[:, 1 + channels :])  # modulo 256
    per_metre = round(dots_per_inch / 0.0254)
    return SIGNATURE + b"".join(
        _chunk(kind, data)
        for kind, data in (
            (b"IHDR", struct.pack(">IIBBBBB", width, height, *TRUE_COLOUR)),
            (b"pHYs", struct.pack(">IIB", per_metre, per_metre, 1)),
            (b"IDAT", zlib.compress(filtered.tobytes(), level)),
            (b"IEND", b""),
        )
    )


def _chunk(kind: bytes, data: bytes) -> bytes:
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
