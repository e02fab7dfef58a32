"""The semilandmarks of a warp in names and sentences, for all that leaves a session."""

from __future__ import annotations

from collections.abc import Iterable

from pinwarp.core.groups import Curve, Group
from pinwarp.core.words import counted
from pinwarp.session.warp.result import WarpResult
from pinwarp.session.warp.sliding import SlidGroups


def point_names(at_rest: SlidGroups, landmarks: Iterable[str], *, freed: bool = False) -> list[str]:
    """Return what the semilandmarks that a warp was solved from are called, in their order.

    Parameters
    ----------
    at_rest
        The semilandmarks.
    landmarks
        Names that are taken.
    freed
        Whether those without a counterpart are named too, though they have no part in the warp.
    """
    taken, names = set(landmarks), []
    for group in at_rest.groups:
        for number in group.numbers[~group.is_freed | freed].tolist():
            name = f"{group.group.name}_{number + 1}"
            while name in taken:
                name += "_"
            taken.add(name)
            names.append(name)
    return names


def semilandmarks_in_words(result: WarpResult) -> str:
    """Say how many semilandmarks a warp was solved from; nothing where none were.

    Examples
    --------
    >>> from pinwarp.session.session import Session
    >>> from pinwarp.session.warp.result import WarpInputs
    >>> semilandmarks_in_words(WarpResult(WarpInputs.of(Session())))
    ''
    """
    at_rest = result.semilandmarks
    if at_rest is None:
        return ""
    freed = f", {at_rest.freed:,} more without a counterpart" if at_rest.freed else ""
    return f"{counted(at_rest.count, 'semilandmark')}{freed}"


def not_sliding_note(result: WarpResult) -> tuple[str, ...]:
    """Say that and why the curves and patches of a session have no part in its warp, if so.

    Examples
    --------
    >>> from pinwarp.session.session import Session
    >>> from pinwarp.session.warp.result import WarpInputs
    >>> not_sliding_note(WarpResult(WarpInputs.of(Session()), not_sliding="No mesh."))[0][:53]
    'Curves and patches have no part in this warp, which i'
    """
    if result.not_sliding is None:
        return ()
    if result.inputs.refinement is not None:
        # That is another warp, and says so itself.
        return (result.not_sliding,)
    return (
        "Curves and patches have no part in this warp, which is that of the landmarks alone: "
        f"{result.not_sliding}",
    )


def kind_of(group: Group) -> str:
    """Say what a group is.

    Examples
    --------
    >>> from pinwarp.core.groups import Patch
    >>> kind_of(Patch("shaft"))
    'patch'
    """
    if not isinstance(group, Curve):
        return "patch"
    return "closed curve" if group.is_closed else "curve"
