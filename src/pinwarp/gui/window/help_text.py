"""The longer texts of the Help menu."""

from __future__ import annotations

from pinwarp.version import __version__

ABOUT = (
    f"<b>pinwarp {__version__}</b><p>Pair landmarks on two bones and watch a thin-plate "
    "spline warp one into the other.</p><p>MIT licence.</p>"
)

BIBTEX = f"""@software{{pinwarp,
  author  = {{{{The pinwarp developers}}}},
  title   = {{pinwarp: warping bones by landmarks with a thin-plate spline}},
  version = {{{__version__}}}
}}
"""

CITING = f"""
<p>The pinwarp developers. <i>pinwarp</i>, version {__version__} [computer program].</p>
<pre>{BIBTEX}</pre>
<p>Please say the version: figures follow from it. What a paper says about a warp (equation,
penalty, pairs, leave-one-out error, versions) is a paragraph at the end of
<b>File &gt; Export Report</b>, with what it cites.</p>
<p>Meshes, pictures, and landmark files whose format has comments carry the version, the settings
and the hash of the session, which <i>pinwarp check</i> prints: so it can be told later which
session an output is of.</p>
"""

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
<p>A landmark far from all others is missed by more, though nothing is wrong with it: it is
<b>isolated</b>. Place another one nearby if that part matters. A <b>standardised</b> error is
compared with what is usual for such surroundings.</p>
<p>What makes a pair <b>suspect</b> is told below the table. Explanations compete: nothing is wrong,
one pair is <b>displaced</b>, one of two is, two are <b>swapped</b>. The best is told only where
sets without a mistake hardly ever show as much; then the others are judged without it. What about
one such set in four shows is <b>worth a look</b> and never counts as wrong.</p>
<p>With fewer than a dozen pairs an empty list is no proof: they can hardly contradict one another.
A bone that is truly strange in one place looks like a displaced landmark. Fewer than seven pairs,
or more than three wrong ones in ten, cannot be judged.</p>
<p>The disc where a landmark is expected and the map of the <b>uncertainty</b> show the standard
deviation of one coordinate. Within 1, 2 and 3 of it lay 38, 75 and 88 % of the landmarks that were
left out of a real femur, six of 20 at a time, and 19, 69 and 95 % in fields made up as the spline
supposes them (a normal distribution would have 20, 74 and 97 %).
Beyond 3 there are more on a bone, which is not everywhere the same.</p>
"""

ABOUT_REFINING = """
<p><b>Refine to surface</b> (Ctrl+R) draws places all over the source to the destination's surface,
large features first, and lets them slide on it; every landmark is met, or within its tolerance.
Where the warp would fold it gets stiffer. Hold <b>R</b> to see the warp without the
refinement.</p>
<p>It needs both meshes and at least four pairs that do not lie in a plane. The refinement is kept
with the session. Once a landmark, a drawn curve, a mesh or the penalty changes, it is <b>out of
date</b>: the warp goes without it until you refine again.</p>
<p><b>What it does not tell.</b> The distance is what was fitted: a small one proves nothing. That
the surfaces lie on one another does not mean that the right places do. <b>Check the refinement</b>
refines again without each landmark in turn and measures how far it is then missed; a few may be
missed by more. Where the destination was not scanned (beyond its rims) nothing is fitted, and the
warp there is a guess. Leave-one-out errors, flexibility and uncertainty elsewhere are of the
landmarks' warp.</p>
<p>Landmarks that are a few millimetres off, or a refined warp that folds: try a <b>landmark
tolerance</b>.</p>
"""

ABOUT_SEMILANDMARKS = """
<p>A landmark says which point of one bone answers to which of the other. Of a smooth surface nobody
can say that, only that each point answers to one somewhere. <b>Semilandmarks</b> are such points:
they lie on the destination's curves and surface, and <b>slide</b> there until the warp bends least
(Bookstein 1997; Gunz, Mitteroecker and Bookstein 2005).</p>
<p>A <b>curve</b> is drawn along a crest of the source, click by click; a landmark anchors it.
On the destination it shows, dashed, where it is expected. Accept it there, or drag its handles:
then its points slide on that line, else they slide along their tangents. A <b>patch</b> covers the
surface, or what a closed curve encloses, with points far from one another and from landmarks.</p>
<p>A point whose place on the destination faces elsewhere, or lies where the scan ends, has no
counterpart: it is <b>freed</b>, drawn hollow, and takes no part. One that is known better can be
<b>pinned</b>: it becomes a pair.</p>
<p>They need four pairs that do not lie in a plane. They have no leave-one-out error and are never
suspect; that of the landmarks is found while they slide on. As they were put on the surface, a
small <b>distance</b> to it proves nothing: maps say <i>fitted</i>.</p>
"""

ABOUT_MODELS = """
<p><b>From a generic model to a subject's.</b> A model of OpenSim (.osim, version 4) is opened with
<b>File &gt; Open Model…</b>, or dropped onto a view. The Model tab lists its bodies. A click makes
a body's bone the <b>source</b>; open the subject's as the destination and pair the two as ever.
Another body can be chosen at any time: what was done on the one before is kept, undo included.</p>
<p>Muscle points, markers, wraps and frames are drawn on both bones and go along while you place
landmarks. Muscles run straight from point to point, without wrapping, and dashed where they go on
to another body. A number beside a frame says by how much the bone <b>turns</b> there.</p>
<p>The list below the bodies says of each element what becomes of it, how far it moves, and how far
that may be off (<b>±</b>). <b>!</b> marks what is to be looked at. A click shows it on both bones.
The box below changes its rule: carried, turned with the bone, or left as it is. Frames keep their
orientation unless you turn them; compare both where the bone turns by more than 5°.</p>
<p><b>File &gt; Export Model…</b> shows a dry run first and writes the model, its warped meshes
beside it, and a report of every element. Bodies without a pair, or without a tick, stay generic.
The warp's pose is left out: the subject's scan may lie anywhere, in the model's unit (metres).
Mass, inertia and muscle lengths are kept; the report says so.</p>
<p><b>Save Study</b> saves the sessions of all bodies and a .pinwarp-model.csv that names them.
<i>pinwarp model</i> on the command line reads the same file.</p>
"""

ABOUT_SUGGESTING = """
<p><b>Suggest All</b> (Ctrl+G) finds the destination's pose, unit and hand from its shape, warps the
source onto it, and shows a <b>ghost</b> for every landmark that the destination lacks. A ghost is
no landmark: <b>Space</b> accepts the next one, which has its name beside it; where the bone hides
it the view turns first, and the second press accepts. A click puts it elsewhere, a drag moves any
of them, a click on another one makes that the next. Whatever you accept or put right moves the
others. <b>Esc</b> puts the ghosts away.</p>
<p>The disc around a ghost is its <b>doubt</b>: most lie within it, few twice as far. It is one for
the whole bone, since nothing tells the doubt of a single place honestly, and it follows what you
accept. That a ghost looks right does not make it right: compare with the source, where a ring
marks the same landmark.</p>
<p>A bone that is nearly its own mirror image does not tell its side of the body. Then you are
asked, with a picture of each; where it is the other side, the source is mirrored. Where the
surfaces fit badly there are no ghosts, and the reason is told. That a bone is only <b>a part</b>
must be said: no ghost is shown beyond its rim.</p>
<p>Landmarks that <i>pinwarp suggest</i> or a batch has placed are marked as <b>suggested</b> (a
disc filled by half) until you have looked at them: Space confirms the selected one and goes on to
the next.</p>
"""
