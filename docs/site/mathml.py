"""Sphinx extension: formulas as MathML by pandoc (no script, no font, no request), and headings that are found under
the names that they have on a Git server."""
import re
import subprocess

from docutils import nodes
from header import slug
from sphinx.util import logging

log = logging.getLogger(__name__)
made = {}    # (is a block, LaTeX) -> MathML


def key(node):
    text = re.sub(r"\\[bB]igg?[lr]?(?![a-z])", "", node.astext())    # which pandoc does not read
    return isinstance(node, nodes.math_block), " ".join(text.split())


def drawn(math):
    """Brackets of matrices by the style sheet: not every machine has a font whose brackets grow. += as one sign."""
    math = re.sub(r"<annotation.*?</annotation>", "", math, flags=re.S)
    math = re.sub(r'<mo [^>]*>\[</mo><mtable>((?:(?!<mtable).)*?)</mtable><mo [^>]*>\]</mo>',
                  r'<mtable class="matrix">\1</mtable>', math, flags=re.S)
    return re.sub(r"<mo>([+−])</mo><mo>=</mo>", r"<mo>\1=</mo>", math)


def convert(app, env):
    """All formulas of all pages by one run of pandoc."""
    wanted = [k for k in dict.fromkeys(key(n) for doc in sorted(env.found_docs)
                                       for n in env.get_doctree(doc).findall()
                                       if isinstance(n, (nodes.math, nodes.math_block))) if k not in made]
    text = "\n\n".join(f"$${t}$$" if block else f"${t}$" for block, t in wanted)
    run = subprocess.run(["pandoc", "-f", "markdown", "-t", "html", "--mathml"], input=text, capture_output=True,
                         text=True, check=True)
    paragraphs = re.findall(r"<p>(.*?)</p>", run.stdout, re.S)
    for k, paragraph in zip(wanted, paragraphs):
        if not paragraph.startswith("<math"):
            log.warning("no MathML of this formula: %s", k[1])
        made[k] = drawn(paragraph)
    if len(paragraphs) != len(wanted):
        log.warning("%d formulas, but %d made by pandoc", len(wanted), len(paragraphs))


def write(translator, node):
    block, text = key(node)
    translator.body.append(f'<div class="math">{made[block, text]}</div>' if block else made[block, text])
    raise nodes.SkipNode


def name_headings(app, doctree):
    seen = {}
    for section in doctree.findall(nodes.section):
        name = slug(section.next_node(nodes.title).astext())
        seen[name] = seen.get(name, -1) + 1
        name += f"-{seen[name]}" if seen[name] else ""
        section["ids"] = [name] + [i for i in section["ids"] if i != name]


def setup(app):
    app.connect("doctree-read", name_headings)
    app.connect("env-updated", convert)
    app.add_html_math_renderer("pandoc", (write, None), (write, None))
    return {"parallel_read_safe": False, "parallel_write_safe": True}
