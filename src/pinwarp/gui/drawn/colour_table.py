"""The colours of a map as the graphics look them up."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkLookupTable

from pinwarp.gui.style.colour_scale import ColourScale

STEPS = 256


def colour_table(scale: ColourScale) -> vtkLookupTable:
    """Return the colours of a scale, by level."""
    colours = np.full((STEPS, 4), 255, dtype=np.uint8)
    colours[:, :3] = scale.colours(np.linspace(*scale.ends, STEPS))
    table = vtkLookupTable()
    table.SetTable(numpy_to_vtk(colours, deep=True))
    table.SetTableRange(*scale.ends)
    return table
