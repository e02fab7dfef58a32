"""Handles, boxes and pressed buttons that can be seen in either theme.

The style draws them in shades of the window's own colour: pale on a light window, gone on a dark
one.
"""

from __future__ import annotations

from qtpy.QtGui import QPalette

from pinwarp.gui.style import theme
from pinwarp.io.samples import assets_folder


def window_sheet(palette: QPalette) -> str:
    """Return the style sheet of a window.

    Parameters
    ----------
    palette
        Of the application.
    """
    base, accent, text = (
        palette.color(role).name()
        for role in (
            QPalette.ColorRole.Base,
            QPalette.ColorRole.Highlight,
            QPalette.ColorRole.WindowText,
        )
    )
    dark = theme.is_dark()
    edge, faint = ("#a0a6ae", "#62676e") if dark else ("#6b727b", "#b9bec4")
    handle, pressed = (text, "#235c93") if dark else (base, "#c3d9ee")
    tick, close, detach = (
        (assets_folder() / "icons" / f"{name}_{'light' if dark else 'dark'}.svg").as_posix()
        for name in ("tick", "close", "detach")
    )
    boxes = ("QCheckBox", "QAbstractItemView", "QGroupBox")
    box = ", ".join(f"{kind}::indicator" for kind in boxes)
    ticked = ", ".join(f"{kind}::indicator:checked" for kind in boxes)
    off = ", ".join(f"{kind}::indicator:disabled" for kind in ("QRadioButton", *boxes))
    dot = f"qradialgradient(cx:0.5, cy:0.5, radius:0.5, stop:0.45 {text}, stop:0.55 {base})"
    return f"""
    QDockWidget {{
        titlebar-close-icon: url({close}); titlebar-normal-icon: url({detach});
    }}
    QSlider::groove:horizontal {{ height: 4px; border-radius: 2px; background: {faint}; }}
    QSlider::sub-page:horizontal:enabled {{ border-radius: 2px; background: {accent}; }}
    QSlider::handle:horizontal {{
        width: 12px; margin: -5px 0; border-radius: 7px;
        border: 1px solid {edge}; background: {handle};
    }}
    QSlider::handle:horizontal:disabled {{ border-color: {faint}; background: {faint}; }}
    QSlider::handle:horizontal:hover, QSlider::handle:horizontal:focus {{
        border-color: {accent};
    }}
    QRadioButton, QCheckBox {{ min-height: 19px; }}
    QRadioButton::indicator {{
        width: 12px; height: 12px; border-radius: 7px; border: 1px solid {edge};
        background: {base};
    }}
    QRadioButton::indicator:checked {{ background: {dot}; }}
    {box} {{
        width: 12px; height: 12px; border-radius: 2px; border: 1px solid {edge};
        background: {base};
    }}
    {ticked} {{ image: url({tick}); }}
    {off} {{ border-color: {faint}; }}
    QToolButton:checked, QPushButton:checked {{
        border: 1px solid {edge}; border-radius: 4px; background: {pressed};
    }}
    QPushButton:checked {{ padding: 4px 10px; }}
    QProgressBar {{
        border: 1px solid {edge}; border-radius: 3px; text-align: center;
        background: {base}; color: {text};
    }}
    QProgressBar::chunk {{ border-radius: 2px; background: {pressed}; }}
    QPushButton[primary="true"]:enabled {{
        border: none; border-radius: 4px; padding: 5px 10px; background: #1d6bb0; color: white;
    }}
    QPushButton[primary="true"]:enabled:hover {{ background: #2477c0; }}
    QPushButton[primary="true"]:enabled:pressed {{ background: #175a96; }}
    QPushButton[primary="true"]:focus {{ border: 2px solid {text}; padding: 3px 8px; }}
    """
