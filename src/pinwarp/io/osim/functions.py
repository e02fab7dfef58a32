"""Functions of a coordinate in a model's file: read, and put in the place of others."""

from __future__ import annotations

import numpy as np

from pinwarp.core.coordinate_function import CoordinateFunction, FunctionKind
from pinwarp.core.errors import FileFormatError
from pinwarp.io.osim.document import Element
from pinwarp.io.osim.model import OsimModel
from pinwarp.io.osim.splicing import Splicer, numbers_text

_MULTIPLIER = "MultiplierFunction"
_KNOTTED = (FunctionKind.SPLINE.value, FunctionKind.LINEAR.value)


class UnknownFunctionError(Exception):
    """A function that has no knots to carry; its message is what it is called."""


def function_in(element: Element, tag: str) -> Element | None:
    """Return the function of a property: within it, or named like it.

    Examples
    --------
    >>> from pathlib import Path
    >>> from pinwarp.io.osim.document import read_document
    >>> axis = read_document(Path("a.osim"), b"<A><Constant name='function'/></A>").root
    >>> function_in(axis, "function").tag
    'Constant'
    """
    for child in element.children:
        if child.name == tag and child.tag[:1].isupper():
            return child
    found = element.child(tag)
    return found.children[0] if found is not None and found.children else None


def read_function(model: OsimModel, element: Element) -> CoordinateFunction:
    """Read a function that has knots, or is constant.

    Parameters
    ----------
    model, element
        The function's element; a multiplier is multiplied out.

    Raises
    ------
    UnknownFunctionError
        When it is of another kind.
    FileFormatError
        When its knots cannot be used; the message names the line.
    """
    if element.tag == _MULTIPLIER:
        inner = function_in(element, "function")
        if inner is None:
            raise UnknownFunctionError(f"{_MULTIPLIER} of nothing")
        found = read_function(model, inner)
        scale = model.numbers(element, "scale", 1.0)[0]
        return CoordinateFunction(found.kind, found.knots, scale * found.values)
    try:
        if element.tag == FunctionKind.CONSTANT.value:
            value = model.numbers(element, "value", 0.0)
            return CoordinateFunction(FunctionKind.CONSTANT, [], value)
        if element.tag in _KNOTTED:
            knots, values = (model.any_numbers(element, axis) for axis in "xy")
            return CoordinateFunction(FunctionKind(element.tag), knots, values)
    except FileFormatError:
        raise
    except ValueError as error:
        raise model.error(element, f"The {element.tag}: {error}. Correct it.") from None
    raise UnknownFunctionError(element.tag)


def put_function(splicer: Splicer, element: Element, function: CoordinateFunction) -> None:
    """Put a function in the place of another: its numbers alone where the kind is the same."""
    if element.tag == function.kind.value:
        if function.kind is FunctionKind.CONSTANT:
            splicer.set_numbers(element, "value", function.values)
            return
        old = element.child("x")
        same = old is not None and np.array_equal(
            np.array(old.text.split(), dtype=np.float64), function.knots
        )
        if not same:
            splicer.set_numbers(element, "x", function.knots)
        splicer.set_numbers(element, "y", function.values)
        return
    indent = splicer.indent_of(element)
    name = f' name="{element.name}"' if element.name.isidentifier() else ""
    numbers = (
        {"value": function.values}
        if function.kind is FunctionKind.CONSTANT
        else {"x": function.knots, "y": function.values}
    )
    inner = f"{indent.decode()}\t" if indent else ""
    lines = "".join(
        f"{inner}<{tag}>{numbers_text(value)}</{tag}>" for tag, value in numbers.items()
    )
    tag = function.kind.value
    splicer.replace(element, f"<{tag}{name}>{lines}{indent.decode()}</{tag}>".encode())
