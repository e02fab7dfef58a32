"""The longer texts of the Help menu."""

from __future__ import annotations

from pinwarp.version import __version__

ABOUT = (
    f"<b>pinwarp {__version__}</b><p>Pair landmarks on two bones and watch a thin-plate "
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

ABOUT_QUALITY = """
<p>The <b>residual</b> is how far the warp carries a source landmark from its destination. At
penalty 0 it is zero for every pair, right or wrong: it says nothing about which to trust.</p>
<p>The <b>leave-one-out error</b> (Left out) does: the pair is taken away, the others alone carry
the landmark, and this is how far they miss its destination. Select a landmark to see it as a
dashed arrow.</p>
<p>A landmark far from all others is missed by more, though nothing is wrong with it. So each
error is <b>standardised</b>: compared with what is usual for such surroundings. One that is large
even so makes a pair <b>suspect</b>; one that is large only because the landmark is alone makes it
<b>isolated</b>, which is no fault: place another landmark nearby if that part matters.</p>
<p>Few pairs can hardly contradict one another. In trials with one wrong pair among 6 it was found
in 3 % of the cases, among 12 in 91 %: with fewer than a dozen an empty list is no proof.</p>
"""
