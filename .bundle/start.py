"""Where the bundled program begins."""

import os
import sys
from multiprocessing import freeze_support

from pinwarp.__main__ import main

if __name__ == "__main__":
    # Without a console Windows gives a program nothing to write to.
    for name in ("stdout", "stderr"):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, "w", encoding="utf-8"))  # noqa: SIM115
    # A cohort's worker is this program once more.
    freeze_support()
    main()
