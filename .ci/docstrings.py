"""An extension of griffe: the docstrings of the compiled module belong to its stub, which has the types alone."""

from __future__ import annotations

import inspect
from typing import Any

import closecall._closecall
import griffe


class OfTheModule(griffe.Extension):
    """Gives each object of the stub the docstring of the installed module."""

    def on_package(self, *, pkg: griffe.Module, **_: Any) -> None:
        """Once the package has been read."""
        if pkg.name == "closecall":
            describe(pkg["_closecall"], closecall._closecall)


def describe(stub: griffe.Object, compiled: Any) -> None:
    """Describe the members of an object as those of the compiled one are."""
    for name, member in stub.members.items():
        if isinstance(member, griffe.Alias) or name.startswith("_") or not hasattr(compiled, name):
            continue
        own = getattr(compiled, name)
        text = inspect.getdoc(own)
        if text and not member.docstring:
            options = {"warnings": False}
            member.docstring = griffe.Docstring(text, parent=member, parser="google", parser_options=options)
        if member.is_class:
            describe(member, own)
            # The arguments of a class are those of __init__ to griffe, of __new__ to PyO3.
            if "__new__" in member.members:
                member.members["__init__"] = member.members["__new__"]
