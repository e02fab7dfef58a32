"""Squeezes what is drawn into a share of the picture's depth, before or behind other things."""

from __future__ import annotations

from typing import Any

# From the nearest (0) to the furthest (1).
Depth = tuple[float, float]
WHOLE_DEPTH: Depth = (0.0, 1.0)
_TAG = "//VTK::Depth::Impl"


def squeeze(actor: Any, depth: Depth) -> None:
    """Draw an actor in a share of the picture's depth; its own parts hide one another as ever."""
    shader = actor.GetShaderProperty()
    shader.ClearAllFragmentShaderReplacements()
    if depth != WHOLE_DEPTH:
        nearest, furthest = depth
        # Only where it is needed: who writes depths costs the graphics their early exit.
        replaced = f"{_TAG}\ngl_FragDepth = mix({nearest:f}, {furthest:f}, gl_FragCoord.z);\n"
        shader.AddFragmentShaderReplacement(_TAG, True, replaced, False)
