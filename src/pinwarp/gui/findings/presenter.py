"""Brings what the pairs say about one another to the table and its list, and does the remedies."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from pinwarp.core.findings import FindingKind, gravest_first
from pinwarp.core.landmarks import Side
from pinwarp.core.mirror import axis_to_mirror
from pinwarp.gui.capability.action import Action
from pinwarp.gui.capability.capability import Capability
from pinwarp.gui.findings.fold_note import FoldNote
from pinwarp.gui.findings.panel import FindingsPanel
from pinwarp.gui.maps.presenter import MapPresenter
from pinwarp.gui.placing.bone_edits import BoneEdits
from pinwarp.gui.placing.hand import Hand
from pinwarp.gui.placing.reviewing import Reviewing
from pinwarp.gui.table.presenter import TablePresenter
from pinwarp.gui.tasks.jobs import LatestWins
from pinwarp.gui.views.controls import ViewControls
from pinwarp.gui.warp.quality import QualityPresenter
from pinwarp.session import edits
from pinwarp.session.editor import Editor
from pinwarp.session.importing.fit import fitted
from pinwarp.session.judging.different_units import different_units
from pinwarp.session.judging.elsewhere import Elsewhere, MeshGuard
from pinwarp.session.judging.quality import NamedFinding, Quality, judged_at, named_findings
from pinwarp.session.judging.suggested import about_suggested
from pinwarp.session.mesh_units import scale_side, scaling_words, scalings
from pinwarp.session.naming import in_words
from pinwarp.session.session import Session
from pinwarp.session.warp.pair_names import pair_names

# What the pairs say about one another, at penalty 0.
_OF_PAIRS = (
    FindingKind.DISPLACED,
    FindingKind.EITHER,
    FindingKind.SWAPPED,
    FindingKind.MIRRORED,
    FindingKind.WORTH_A_LOOK,
)
# These are about the penalty and the solve, and told where the penalty is set.
_TOLD_ELSEWHERE = (FindingKind.NEARLY_PLANAR, FindingKind.POLE)
# What is suggested has a sign of its own in the table, and nothing is wrong with what was accepted.
_WITHOUT_SIGN = (FindingKind.SUGGESTED, FindingKind.ACCEPTED)


class FindingsPresenter(Capability):
    """Everything between the quality of the pairs and the landmark panel.

    Parameters
    ----------
    editor
        The truth.
    quality, maps
        Where the figures and the folds come from.
    table
        The list stands below it.
    hand
        Moves landmarks, unless they are locked.
    bones
        Mirrors the source.
    reviewing
        Looks at what is only suggested.
    views
        Look at landmarks.
    undo_key
        Which key undoes a remedy.
    open_mesh
        Asks for a mesh and opens it on a side.
    say
        Says a sentence in passing.
    """

    def __init__(
        self,
        editor: Editor,
        quality: QualityPresenter,
        maps: MapPresenter,
        table: TablePresenter,
        hand: Hand,
        bones: BoneEdits,
        reviewing: Reviewing,
        views: ViewControls,
        undo_key: str,
        open_mesh: Callable[[Side], None],
        say: Callable[[str], None],
    ) -> None:
        self._editor = editor
        self._source = quality
        self._maps = maps
        self._table = table
        self._hand = hand
        self._bones = bones
        self._reviewing = reviewing
        self._views = views
        self._undo_key = undo_key
        self._open_mesh = open_mesh
        self._say = say
        self._found: tuple[NamedFinding, ...] = ()
        self._last: NamedFinding | None = None
        self._astray: tuple[Elsewhere, ...] = ()
        self._looked_at: object = None
        self._guard = LatestWins(_looked)
        self._guard.computed.connect(self._on_looked)
        self._meshes = MeshGuard()
        self._shown_for: object = None
        self._next = Action(
            "next_finding",
            "Next Pair to &Check",
            self.next,
            at="Place.14",
            keys="Shift+N",
            deed="Select Next Pair to Check",
            tip="The next one listed below the table",
            possible=lambda: self._found,
        )
        self.actions = (self._next,)
        self.panel = FindingsPanel()
        table.panel.put_below(self.panel, self.panel.set_room)
        self.fold_note = FoldNote(editor, views.focus)
        self.notes = (self.fold_note,)
        self.panel.chosen.connect(self._choose)
        self.panel.swap_requested.connect(self._swap)
        self.panel.mirror_requested.connect(bones.mirror)
        self.panel.reading_requested.connect(self._read_otherwise)
        self.panel.scale_requested.connect(self._scale)
        self.panel.replace_requested.connect(self._show_expected)
        self.panel.disable_requested.connect(self._disable)
        maps.survey_shown.connect(self.fold_note.show_survey)
        quality.quality_changed.connect(self._on_quality)
        maps.folds_changed.connect(self._on_folds)
        editor.rulers_changed.connect(self._on_session)
        editor.session_changed.connect(self._on_session)
        editor.selection_changed.connect(self._on_selection)
        self._on_session()

    def shut_down(self) -> None:
        """Let go of the editor and the figures."""
        self._guard.shut_down()
        self._source.quality_changed.disconnect(self._on_quality)
        self._maps.folds_changed.disconnect(self._on_folds)
        self._maps.survey_shown.disconnect(self.fold_note.show_survey)
        self._editor.rulers_changed.disconnect(self._on_session)
        self._editor.session_changed.disconnect(self._on_session)
        self._editor.selection_changed.disconnect(self._on_selection)

    # What is shown

    def _on_quality(self, quality: Quality | None) -> None:
        self._table.model.show_quality(quality)
        self._show()

    def _on_folds(self, _folds: object) -> None:
        self._show()

    def _on_session(self, _changed: object = None) -> None:
        if self._editor.is_previewing:
            # Names do not change in a drag, and its figures come by themselves.
            return
        self._look()
        self._show()
        self._on_selection()

    def _look(self) -> None:
        """Ask whether landmarks lie on their meshes, where either is another than before."""
        session = self._editor.committed
        places = tuple((x.source, x.destination) for x in session.landmarks)
        key = (places, session.groups, session.source, session.destination, session.unit)
        if key != self._looked_at:
            self._looked_at = key
            self._guard.request((self._meshes, session, key))

    def _on_looked(self, found: tuple[object, tuple[Elsewhere, ...]]) -> None:
        key, astray = found
        if key == self._looked_at and astray != self._astray:
            self._astray = astray
            self._show()

    @property
    def is_settled(self) -> bool:
        """Whether the landmarks were compared with their meshes as they are now."""
        return self._guard.is_idle

    def _show(self) -> None:
        session, quality, survey = self._editor.session, self._source.quality, self._maps.survey
        # Not the survey itself: where its folds are the same, an older one would stay for ever.
        folds = survey.findings if survey is not None else ()
        judged = survey.result.inputs if survey is not None else None
        places = (judged.source, judged.destination) if judged is not None else None
        astray = self._astray
        rulers = self._editor.rulers
        shown = (session.settings.penalty, rulers, session.source, session.destination)
        key = (session.landmarks, shown, quality, folds, places, astray)
        if key == self._shown_for:
            return
        self._shown_for = key
        found = quality.findings_in(session, rulers.session) if quality is not None else ()
        if judged is not None:
            found += named_findings(folds, judged, session, rulers.session)
        # Folds come behind what causes them, what is only isolated last.
        found = (*different_units(session), *found, *about_suggested(session, rulers.destination))
        found = gravest_first((*(x.by(rulers) for x in astray), *found))
        self._found = tuple(one for one in found if one.finding.kind not in _TOLD_ELSEWHERE)
        self._table.model.show_findings(
            [one for one in self._found if one.finding.kind not in _WITHOUT_SIGN]
        )
        judged_pairs = any(one.finding.kind in _OF_PAIRS for one in self._found)
        words = judged_at(session, rulers.session) if judged_pairs else ""
        self.panel.show_findings(self._found, self._mirror_axis(quality), words)
        self.panel.show_selection(self._editor.selection.names)
        self._next.renew()

    def _mirror_axis(self, quality: Quality | None) -> str:
        mirrored = any(one.finding.kind is FindingKind.MIRRORED for one in self._found)
        if quality is None or not mirrored:
            return ""
        axis = axis_to_mirror(quality.inputs.source, quality.inputs.destination)
        return axis if self._bones.can_mirror() else ""

    def _on_selection(self, _changed: object = None) -> None:
        self.panel.show_selection(self._editor.selection.names)

    # What is asked for

    def _choose(self, found: NamedFinding) -> None:
        """Select the landmarks of a finding and look at them."""
        self._last = found
        if found.finding.kind is FindingKind.SUGGESTED:
            self._reviewing.begin()
            return
        self._table.panel.reveal(found.names)
        self._editor.select(*found.names)
        self._views.focus()

    def next(self) -> None:
        """Choose the finding after the one that is selected, and let the keys go to it."""
        if not self._found:
            return
        chosen = set(self._editor.selection.names)
        here = [i for i, one in enumerate(self._found) if one.names and set(one.names) == chosen]
        # Several may be about all landmarks, and name none.
        if not chosen and self._last in self._found:
            here = [self._found.index(self._last)]
        following = (here[0] + 1) % len(self._found) if here else 0
        self._choose(self._found[following])
        if self._found[following].finding.kind is not FindingKind.SUGGESTED:
            self.panel.focus_row(following)

    def _is_current(self, found: NamedFinding) -> bool:
        """Whether the pairs are still those that were judged: a second click must not undo it."""
        quality = self._source.quality
        if quality is None:
            return False
        names = pair_names(quality.inputs, self._editor.committed, exactly=True)
        return tuple(names[row] for row in found.finding.rows) == found.names

    def _swap(self, found: NamedFinding) -> None:
        if self._is_current(found):
            self._hand.swap_destinations(found.names)

    def _read_otherwise(self, found: Elsewhere) -> None:
        # Not the findings themselves: another ruler tells them in other words.
        if (found.side, found.fit) not in [(one.side, one.fit) for one in self._astray]:
            return
        if found.fit is None:
            self._open_mesh(found.side)
            return
        session = fitted(self._editor.committed, found.side, found.fit)
        self._editor.commit(session, f"Correct {found.side.value} {found.what}")
        self._say(f"{found.fit.describe()}: {self._undo_key} undoes it.")

    def _scale(self, side: Side) -> None:
        session = self._editor.committed
        ways = scalings(session)
        if side in ways:
            words = scaling_words(side.value, ways[side])
            self._editor.commit(scale_side(session, side, ways[side]), words)
            self._say(f"{words}, with its landmarks: {self._undo_key} undoes it.")

    def _show_expected(self, name: str) -> None:
        """Select a landmark to be placed anew, and show where the other pairs expect it."""
        quality, landmark = self._source.quality, self._editor.committed.landmark(name)
        if landmark is None or landmark.destination is None:
            return
        self._table.panel.reveal((name,))
        self._editor.select(name, side=Side.DESTINATION)
        self._editor.look(arrows=True)
        if quality is None or quality.left_out is None:
            self._views.focus()
            self._say(f"Check where {name} lies, and drag it where it belongs.")
            return
        row = pair_names(quality.inputs, self._editor.committed).index(name)
        expected = np.array(landmark.destination) - quality.left_out.errors[row]
        there = [landmark.destination, *([expected] if np.isfinite(expected).all() else [])]
        self._views.focus_on(
            {Side.SOURCE: np.array([landmark.source]), Side.DESTINATION: np.array(there)}
        )
        self._say(
            f"The dashed arrow starts where the other pairs expect {name}: "
            "drag it where it belongs, on either bone, or Shift+click there."
        )

    def _disable(self, found: NamedFinding, names: Sequence[str]) -> None:
        if self._is_current(found):
            session = edits.set_enabled(self._editor.committed, names, False)
            self._editor.commit(session, f"Disable {in_words(names)}")
            takes = "takes" if len(names) == 1 else "take"
            self._say(f"{in_words(names)} no longer {takes} part: {self._undo_key} undoes it.")


def _looked(asked: tuple[MeshGuard, Session, object]) -> tuple[object, tuple[Elsewhere, ...]]:
    guard, session, key = asked
    return key, guard.look(session)
