"""The first guess of a session: every landmark that is missing, suggested on the destination."""

from pinwarp.session.suggesting.ghosts import SuggestedPlace, ghosts_of
from pinwarp.session.suggesting.guessing import METHOD, SuggestInputs, missing_of, suggest, why_not
from pinwarp.session.suggesting.placing import mirrored_first, with_ghosts, with_suggestions

__all__ = [
    "METHOD",
    "SuggestInputs",
    "SuggestedPlace",
    "ghosts_of",
    "mirrored_first",
    "missing_of",
    "suggest",
    "why_not",
    "with_ghosts",
    "with_suggestions",
]
