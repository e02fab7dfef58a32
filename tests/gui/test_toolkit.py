"""What we rely on in the toolkit, found out the hard way."""

from __future__ import annotations

import subprocess
import sys

from qtpy.QtCore import QPointF


def run_apart(code):
    """Run some lines in an interpreter of their own, which has loaded nothing yet."""
    subprocess.run([sys.executable, "-c", code], check=True, timeout=60)


def test_calls_into_qt_lose_no_reference_to_none(qapp):
    """PySide 6.12.0 did on Python 3.11: the program died in the middle of long work."""
    point = QPointF()
    before = sys.getrefcount(None)
    for _ in range(1000):
        point.setX(1.0)
    assert sys.getrefcount(None) > before - 500


def test_a_window_opens_without_a_warning_of_qt(user, qtlog):
    user.open_sample()
    assert [record.message for record in qtlog.records] == []


def test_the_window_is_there_before_what_only_later_work_needs():
    code = (
        "import sys, pinwarp.gui.app\n"
        "from pinwarp.gui.views.fast_view import FastView\n"
        "pinwarp.gui.app.make_application(), FastView().close()\n"
        "late = {'matplotlib.pyplot', 'matplotlib.figure', 'matplotlib.backend_bases', 'numba',\n"
        "    'scipy.interpolate', 'scipy.optimize', 'scipy.stats', 'vtkmodules.all', 'asyncio',\n"
        "    'distributed', 'imageio_ffmpeg', 'opensim', 'rich', 'typer'}\n"
        "assert not late & set(sys.modules), late & set(sys.modules)"
    )
    run_apart(code)


def test_a_chart_still_finds_its_figures_and_a_script_finds_matplotlib():
    code = (
        "import sys, pinwarp.gui.views.fast_view\n"
        "import matplotlib, matplotlib.pyplot as plt\n"
        "from pyvista.plotting import charts\n"
        "assert matplotlib.pyplot is plt is sys.modules['matplotlib.pyplot']\n"
        "assert charts.plt.subplots is plt.subplots\n"
        "figure, _ = plt.subplots()\n"
        "from matplotlib.backends.backend_agg import FigureCanvasAgg\n"
        "assert type(charts.FigureCanvasAgg(figure)) is FigureCanvasAgg"
    )
    run_apart(code)


def test_what_asks_for_figures_at_once_has_them():
    code = (
        "from pinwarp.gui.views.without_charts import without_charts\n"
        "with without_charts():\n"
        "    import matplotlib.pyplot as plt\n"
        "    assert plt.subplots.__module__ == 'matplotlib.pyplot'\n"
        "    from matplotlib.backends.backend_agg import RendererAgg\n"
        "import matplotlib.pyplot as later\n"
        "assert later.subplots is plt.subplots"
    )
    run_apart(code)
