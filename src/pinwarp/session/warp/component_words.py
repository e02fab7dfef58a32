"""What the parts of a warp are called, everywhere."""

from __future__ import annotations

from dataclasses import dataclass

from pinwarp.core.components import Components
from pinwarp.core.settings import WarpSettings


@dataclass(frozen=True)
class ComponentWords:
    """The words for one part of a warp.

    Parameters
    ----------
    title
        As a choice.
    noun
        As a thing.
    meaning
        What it does.
    start
        Where its blend begins.
    """

    title: str
    noun: str
    meaning: str
    start: str = "aligned source"


COMPONENT_WORDS = {
    Components.FULL: ComponentWords(
        "Full warp", "full warp", "meets every pair as closely as the penalty lets it"
    ),
    Components.WITHOUT_POSE: ComponentWords(
        "Without pose",
        "warp without pose",
        "size and shape only: keeps the source's frame",
        start="source",
    ),
    Components.AFFINE: ComponentWords(
        "Affine fit", "affine fit", "moved, turned, sized and sheared as a whole"
    ),
    Components.SIMILARITY: ComponentWords(
        "Similarity fit", "similarity fit", "moved, turned and sized"
    ),
    Components.RIGID: ComponentWords(
        "Rigid fit", "rigid fit", "moved and turned, neither sized nor bent"
    ),
}
# What leaves the bending out.
_FITS = (Components.AFFINE, Components.SIMILARITY, Components.RIGID)


def applied_in_words(settings: WarpSettings) -> str:
    """Say what of the warp is applied, to what is shown and to what is exported.

    Examples
    --------
    >>> applied_in_words(WarpSettings(components=Components.AFFINE, blend=0.5))
    'the affine fit only, 50% of the way from the aligned source'
    """
    words = COMPONENT_WORDS[settings.components]
    said = f"the {words.noun}" + (" only" if settings.components in _FITS else "")
    if settings.blend == 1 or settings.components is Components.RIGID:
        return said
    return f"{said}, {settings.blend:.0%} of the way from the {words.start}"
