"""Judges the pairs whenever the warp has changed, and tells who wants to know."""

from __future__ import annotations

from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.warp.warps import Warps
from pinwarp.session.judging.quality import Quality, quality_of
from pinwarp.session.signals import isolated
from pinwarp.session.warp.result import WarpResult


class QualityPresenter(Capability):
    """Hands on the quality of each warp; ``quality_changed`` emits it, or None without a warp.

    Where it takes a while, it is found by a worker once the hand rests.

    Parameters
    ----------
    warps
        Where the warps come from.
    """

    quality_changed = isolated(object)

    def __init__(self, warps: Warps) -> None:
        self._warps = warps
        self._judge = LatestWins(quality_of)
        self._judge.computed.connect(self._on_judged)
        self._judge.failed.connect(self._on_failure)
        self.quality: Quality | None = None
        warps.result_changed.connect(self._on_result)

    @property
    def is_settled(self) -> bool:
        """Whether the last warp at rest is judged."""
        return self._judge.is_idle

    def shut_down(self) -> None:
        """Stop the worker and let go of the warps."""
        self._warps.result_changed.disconnect(self._on_result)
        self._judge.shut_down()

    def _on_result(self, result: WarpResult, at_rest: bool, quality: Quality | None) -> None:
        if quality is not None:
            # In a drag the list stays as it was when the hand rested last.
            judged = quality.judgement is not None
            self._on_quality(quality if judged else quality.judged_as(self.quality))
            return
        if result.factor is not None and not result.factor.has_modes:
            # The eigenvalues follow once the hand rests, and this is asked again.
            return
        if at_rest:
            self._judge.request(result)

    def _on_judged(self, quality: Quality | None) -> None:
        now = self._warps.result
        # Another warp, judged along with it, may have come meanwhile.
        if quality is None or (now is not None and quality.inputs == now.inputs):
            self._on_quality(quality)

    def _on_quality(self, quality: Quality | None) -> None:
        self.quality = quality
        self.quality_changed.emit(quality)

    def _on_failure(self, error: Exception) -> None:
        # The old figures must not pass for those of the new pairs.
        self._on_quality(None)
        raise error
