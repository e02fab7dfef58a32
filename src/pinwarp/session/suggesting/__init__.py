"""The first guess of a session: every landmark that is missing, suggested on the destination."""

from pinwarp.session.suggesting.ghosts import SuggestedPlace, ghosts_of
from pinwarp.session.suggesting.guessing import SuggestInputs, suggest, why_not
from pinwarp.session.suggesting.placing import with_suggestions

__all__ = [
    "SuggestInputs",
    "SuggestedPlace",
    "ghosts_of",
    "suggest",
    "why_not",
    "with_suggestions",
]
