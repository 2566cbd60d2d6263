"""The examples of docstrings, of docs/python.md and of docs/first_record.md are what they print."""

import doctest
import inspect
import re
import runpy
from pathlib import Path

import numpy as np
import pytest

import rlslab

ROOT = Path(__file__).resolve().parents[2]
PAGES = {name: (ROOT / "docs" / name).read_text() for name in ("python.md", "first_record.md")}
PAGE = PAGES["python.md"]
FLAGS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS


def public():
    """Every function, class, method and property that users call."""
    yield "rlslab", rlslab
    for name in rlslab.__all__:
        thing = getattr(rlslab, name)
        if not callable(thing):
            continue
        yield name, thing
        if inspect.isclass(thing):
            for base in thing.__mro__:
                for member, value in vars(base).items():
                    if not member.startswith("_") and base.__module__.startswith("rlslab"):
                        yield f"{name}.{member}", value


def test_everything_public_has_a_docstring():
    missing = [name for name, thing in public() if not (inspect.getdoc(thing) or "").strip()]
    assert missing == []
    for name, made in rlslab.CLASSES.items():
        assert re.search(r"Sources?: ", made.__doc__) and "(1)" in made.__doc__, name


def run(text, name, examples):
    test = doctest.DocTestParser().get_doctest(text, dict(examples), name, None, 0)
    runner = doctest.DocTestRunner(optionflags=FLAGS)
    said = []
    runner.run(test, out=said.append)
    assert runner.failures == 0, "".join(said)
    return len(test.examples)


def test_the_examples_of_docstrings(examples):
    texts = {inspect.getdoc(thing): name for name, thing in public()}
    assert sum(run(text, name, examples) for text, name in texts.items()) > 70
    with pytest.raises(AssertionError):
        run(">>> 1 + 1\n3\n", "planted", examples)


def test_the_examples_of_results(examples):
    from rlslab.results import RecursiveLS

    assert run(inspect.getdoc(RecursiveLS), "RecursiveLS", examples) == 5


def test_the_examples_of_the_estimators(examples):
    pytest.importorskip("sklearn")
    from rlslab.sklearn import RLSClassifier, RLSRegressor

    assert run(inspect.getdoc(RLSRegressor), "RLSRegressor", examples) == 4
    assert run(inspect.getdoc(RLSClassifier), "RLSClassifier", examples) == 3


@pytest.mark.parametrize("page", PAGES)
def test_the_page(page, examples, tmp_path):
    """The blocks of python, one after another, as the reader types them; after python.md's, which others refer to."""
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    blocks = re.findall(r"```python\n(.*?)```\n", PAGES[page], re.S)
    assert len(blocks) > 5
    names = {}
    if page != "python.md":
        blocks.insert(0, next(b for b in re.findall(r"```python\n(.*?)```\n", PAGE, re.S) if "def how_sure" in b))
        names = dict(examples)
    for block in blocks:
        for needed in ("sklearn", "pandas"):
            if f"{needed} " in block or f"{needed}." in block:
                pytest.importorskip(needed)
        names = {**names, **run_block(block, names)}


def test_the_page_on_closed_loops(examples):
    names = dict(examples)
    blocks = re.findall(r"```python\n(.*?)```\n", (ROOT / "docs/closed_loop.md").read_text(), re.S)
    assert len(blocks) == 3
    for block in blocks:
        names = {**names, **run_block(block, names)}


NOTEBOOKS = sorted((ROOT / "bindings/python/notebooks").glob("*.py"))


@pytest.mark.parametrize("script", NOTEBOOKS, ids=lambda path: path.stem)
def test_the_notebooks(script, capsys):
    """They hold what they say by assertions."""
    text = script.read_text()
    assert text.count("# %%") > 3
    runpy.run_path(str(script))
    assert capsys.readouterr().out


def test_the_example_of_complex_spectra(capsys):
    folder = ROOT / "docs/examples/dereverberation"
    runpy.run_path(str(folder / "main.py"), run_name="__main__")
    block = re.search(r"```text\n(.*?)```", (folder / "README.md").read_text(), re.S)
    assert capsys.readouterr().out == block[1]


def run_block(block, names):
    if ">>>" not in block:
        exec(compile(block, "docs/python.md", "exec"), names)
        return names
    test = doctest.DocTestParser().get_doctest(block, names, "docs/python.md", None, 0)
    runner = doctest.DocTestRunner(optionflags=FLAGS)
    said = []
    runner.run(test, out=said.append, clear_globs=False)
    assert runner.failures == 0, "".join(said)
    return test.globs


def test_the_page_names_what_there_is():
    for word in [*rlslab.variants(), *rlslab.guards(), *rlslab.controls()]:
        assert f"`{word}`" in PAGE, word
    assert np.dtype(rlslab.STEP).itemsize == 32
