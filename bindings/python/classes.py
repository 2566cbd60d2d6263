"""Writes rlslab/_variants.py: a class for each dense variant, from the list and the variants' pages.

usage: classes.py FOLDER_OF_THE_VARIANTS VERSION OUT
"""

import re
import sys
from pathlib import Path

HEAD = '''"""The class of each variant. Written by bindings/python/classes.py from the variants' pages."""

from __future__ import annotations

from ._filter import Filter

VERSION = {version!r}
__all__ = [
{names}
]
'''
CLASS = '''

class {name}(Filter):
    {quotes}{what}

    {start}The options are those of `rlslab.Filter`.

{text}

    Examples
    --------
    >>> f = rlslab.{name}(2, forgetting=0.99)
    >>> _ = f.update_many([[1, 0], [1, 1], [1, 2]], [3, 5, 7])
    >>> f.theta.round(2), f.health in rlslab.HEALTHS
    (array([3., 2.]), True)
    """

    __slots__ = ()
    _variant = "{variant}"
'''


# What a page says of the start, by whether it starts without a prior.
START = {
    True: "Starts without a prior where ``prior_variance=None``: theta is then that of least squares. ",
    False: "Needs a prior, which keeps theta from least squares by (I - A)^-1 A (theta - theta0), A = lambda^k P P0^-1,"
    "\n    in units of the data. ",
}


def listed(variants: Path) -> list[str]:
    """The classes of THE list, without the sparse ones."""
    text = (variants / "variants.hpp").read_text()
    inside = re.search(r"OverScalar<T,(.*?)#ifdef", text, re.S)
    assert inside, "variants.hpp: no list"
    return re.findall(r"(\w+)<", inside[1])


def snake(name: str) -> str:
    return re.sub(r"(?<!^)([A-Z])", r"_\1", name).lower()


def described(page: str) -> tuple[str, str]:
    """The first sentence of a page, and the text above its class: prose as paragraphs, formulas as a block."""
    first = re.match(r"(?:// .*\n)+", page)
    above = re.search(r"((?:^///.*\n)+)template", page, re.M)
    assert first and above, "a page without its text"
    what = " ".join(line[3:] for line in first[0].splitlines())
    blocks = re.split(r"\n\s*\n", "\n".join(line[4:] for line in above[1].splitlines()))
    out = []
    for block in blocks:
        lines = block.splitlines()
        if all(line.startswith("  ") for line in lines):
            out.append("    ::\n\n" + "\n".join("      " + line for line in lines))
        else:
            out.append("\n".join("    " + line.strip() for line in lines))
    text = "\n\n".join(out)
    return what, re.sub(r"\n(\s*)(Sources?: )", r"\n\n\1\2", text)


def main(variants: Path, version: str, out: Path) -> None:
    names = listed(variants)
    text = HEAD.format(version=version, names="\n".join(f'    "{name}",' for name in names))
    for name in names:
        page = (variants / f"{snake(name)}.hpp").read_text()
        what, formulas = described(page)
        start = START["starts_without_prior = true" in page]
        raw = 'r"""' if "\\" in formulas else '"""'
        text += CLASS.format(name=name, variant=snake(name), what=what, text=formulas, quotes=raw,
                             start=start)
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(text)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3]))
