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
