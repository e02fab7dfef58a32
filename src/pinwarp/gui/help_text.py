"""The longer texts of the Help menu."""

from __future__ import annotations

import pinwarp

ABOUT = (
    f"<b>pinwarp {pinwarp.__version__}</b><p>Pair landmarks on two bones and watch a thin-plate "
    "spline warp one into the other.</p><p>MIT licence.</p>"
)

ABOUT_PENALTY = """
<p>The <b>warping penalty</b> trades fit for smoothness. At 0 the warp meets every landmark; the
further right, the more it becomes the affine fit, which only shifts, turns, scales and shears.
It is a length, in the unit of the meshes.</p>
<p>The slider runs along the <b>flexibility</b>: the share of bending that the penalty leaves. That
scale is the same for metres and millimetres and for ten landmarks or a hundred.</p>
<p>The <b>curve</b> above the slider shows how far the landmarks miss theirs when they take part in
the solve (residual) and when each is left out of it (leave-one-out). Where the latter is least, the
pairs predict one another best: that penalty is suggested. Hold <b>B</b> to see the previous
penalty, and take snapshots (<b>P</b>) to have several side by side.</p>
<p><b>Regularising</b> penalises at every value. <b>OPynSim</b> is the equation as published,
K + &alpha;I with the basis U = +r: its matrix is negative where it should be positive, so that the
warp overshoots before each of its poles (the ticks on the slider) and is worse than the affine
fit behind them. Choose it only to match results made elsewhere; the file records it.</p>
"""
