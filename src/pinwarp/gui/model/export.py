"""File > Export Model: the dry run first, then the model with its meshes and the report."""

from __future__ import annotations

from pathlib import Path

from pinwarp.core.words import counted
from pinwarp.gui.capability.action import Action
from pinwarp.gui.model.model_dialogs import ModelDialogs
from pinwarp.gui.model.opened import OpenedModel
from pinwarp.gui.tasks.dialogs import Existing
from pinwarp.gui.tasks.file_tasks import FileTasks, Progress
from pinwarp.io.file_names import MODEL_SUFFIX
from pinwarp.session.model.bench import Bench
from pinwarp.session.model.warped import WarpedModel, warped_model
from pinwarp.session.model.writing import outputs_of, write_model


class ModelExport:
    """Shows what would become of everything, and writes it.

    Parameters
    ----------
    opened
        The model.
    tasks
        Runs, asks and tells.
    """

    def __init__(self, opened: OpenedModel, tasks: FileTasks[ModelDialogs]) -> None:
        self._opened, self._tasks = opened, tasks
        self.action = Action(
            "export_model",
            "Export Mo&del…",
            self.export,
            at="File.46",
            keys="Ctrl+Shift+D",
            tip="The subject's model with its meshes, and a report that says of every element what "
            "became of it",
            possible=self._has_pairs,
        )

    def _has_pairs(self) -> bool:
        bench = self._opened.bench
        return bench is not None and any(
            one.enabled and one.current is not None and one.current.pairs
            for one in bench.bodies.values()
        )

    def export(self) -> None:
        """Carry all ticked bodies that have pairs, show the report, ask where to, and write."""
        bench = self._opened.bench
        if bench is None:
            return
        study = bench.study(to_export=True)

        def carry(progress: Progress) -> WarpedModel:
            return warped_model(study, lambda body: progress(0.5, f"carrying {body}"))

        self._tasks.run(
            f"Carrying {bench.name}", carry, lambda warped: self._on_warped(bench, warped)
        )

    def _on_warped(self, bench: Bench, warped: WarpedModel) -> None:
        if not self._tasks.dialogs.ask_dry_run(warped):
            return
        proposal = bench.model.path.with_name(f"{bench.name}_warped{MODEL_SUFFIX}")
        path = self._tasks.dialogs.ask_save(
            "Export the model", f"Models (*{MODEL_SUFFIX})", proposal
        )
        if path is None:
            return
        if not path.suffix:
            path = path.with_name(path.name + MODEL_SUFFIX)
        self._write(warped, path)

    def _write(self, warped: WarpedModel, path: Path) -> None:
        outputs: list[Path] = []
        if not self._tasks.write(lambda: outputs.extend(outputs_of(warped, path)), path):
            return
        there = [output for output in outputs if output.exists()]
        if there and self._tasks.dialogs.ask_existing(there) is not Existing.REPLACE:
            self._tasks.said.emit("Nothing was exported")
            return

        def write(progress: Progress) -> None:
            progress(0.1, "writing")
            write_model(warped, path, force=True)

        meshes = counted(len(warped.meshes), "mesh", "meshes")
        told = f"Exported {path.name}, {meshes} beside it, and {outputs[1].name}"
        self._tasks.run(
            f"Exporting {path.name}", write, lambda _nothing: self._tasks.said.emit(told)
        )
