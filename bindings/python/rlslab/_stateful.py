"""What filters, fleets and several outputs do with their state."""

from __future__ import annotations

import os
import reprlib
from typing import TYPE_CHECKING, Any, TypeVar, Union

from . import _core

Path = Union[str, "os.PathLike[str]"]
Self = TypeVar("Self", bound="Stateful")
#: Counts up when what a pickle holds changes.
PICKLE = 1


def in_pythons_words(error: ValueError) -> ValueError:
    """The native layer's line with the names that Python has."""
    words = {" in float with": " in float32 with", " in double with": " in float64 with"}
    words |= {"leave_out leaves": 'unusable="leave_out" leaves', "without a prior:": "of prior_variance=None:"}
    line = str(error)
    for native, ours in words.items():
        line = line.replace(native, ours)
    return ValueError(line)


class Stateful:
    """`_made` is what it was made with."""

    __slots__ = ()
    _made: dict[str, Any]
    if TYPE_CHECKING:

        def _state(self) -> bytes: ...
        def _load(self, state: Any, /) -> None: ...
        def _clone(self: Self) -> Self: ...

    @property
    def state(self) -> bytes:
        """The state in the library's format: the same bytes in C++, in C and on every machine.

        Examples
        --------
        >>> f = rlslab.Ud(2)
        >>> _ = f.update([1.0, 2.0], 5.0)
        >>> g = rlslab.Ud(2)
        >>> g.restore(f.state)
        >>> bool((g.theta == f.theta).all())
        True
        """
        return self._state()

    def restore(self, state: bytes) -> None:
        """Go on from a state of the same variant, dtype, size and composition, of as many filters or outputs.

        Raises
        ------
        ValueError
            If the bytes are damaged, or of another; this one is then as it was.
        """
        try:
            self._load(state)
        except ValueError as error:
            raise in_pythons_words(error) from None

    def save(self, path: Path) -> None:
        """Write `state` to a file, which holds the old bytes or the new whenever the program ends.

        A symbolic link stays, and what it names is replaced. A device or a pipe takes the bytes. OSError where it
        cannot be written.
        """
        _core.save(path, self.state)

    def load(self, path: Path) -> None:
        """Go on from the state in a file: see `restore`. `rlslab.load` makes a filter, too."""
        with open(path, "rb") as file:
            self.restore(file.read())

    def copy(self: Self) -> Self:
        """One that goes on from here on its own, with the same bits."""
        out = self._clone()
        out._made = self._made
        return out

    __copy__ = copy

    def __deepcopy__(self: Self, memo: dict[int, Any]) -> Self:
        return self.copy()

    def __reduce__(self) -> tuple[Any, ...]:
        return remade, (PICKLE, type(self), self._made, self.state)


def remade(version: int, made_of: type[Stateful], options: dict[str, Any], state: bytes) -> Stateful:
    """A pickled one. ValueError for a pickle of another version of this module, or a damaged one."""
    if version != PICKLE:
        raise ValueError(f"a pickle of version {reprlib.repr(version)}; this rlslab reads version {PICKLE}")
    if not (isinstance(made_of, type) and issubclass(made_of, Stateful) and isinstance(options, dict)):
        raise ValueError("a damaged pickle of a filter")
    out = made_of(**options)
    out.restore(state)
    return out
