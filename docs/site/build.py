#!/usr/bin/env python3
"""Builds the documentation site: build.py SPHINX_SOURCE OUT. The tree's pages and those that pages.py,
first_pages.py and api.py make go to SPHINX_SOURCE, Sphinx writes OUT, and check.py looks at every page of it.
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys

import api
import check
import first_pages
import pages
from header import root
import type_tables    # of docs/, where api found it

here = pathlib.Path(__file__).resolve().parent
live = root / "build/live/index.html"    # ./lab live
shows = root / "docs/site/live/page.cpp"      # its list of variants
ours = [p for kind in ("*.md", "docs/*.md", "docs/decisions/*.md", "docs/examples/**/*.md", "studies/data/*.md")
        for p in sorted(root.glob(kind)) if p != root / "docs/README.md"]    # the sidebar has what it lists


def sources():
    """path in the tree -> text of each page."""
    of = pages.Shared()
    out = {"api/types.md": type_tables.made()}
    out |= {str(p.relative_to(root)): p.read_text() for p in ours}
    out["commands.md"] = (here / "commands.md").read_text()    # as recorded.py wrote it
    out |= {f"variants/{h.name}.md": pages.variant_page(h, of) for h in of.headers}
    out |= {f"studies/{s['name']}.md": pages.study_page(s, of.links) for s in of.studies}
    out |= {"variants/index.md": pages.variant_index(of), "studies/index.md": pages.study_index(of)}
    out |= {f"api/{name}.md": api.room_page(name, folder, chosen) for name, folder, chosen in api.rooms}
    out |= {"api/c.md": api.c_page(), "api/python.rst": api.python_page(of.headers)}
    out["api/index.md"] = api.index_page(of.headers)
    below_index = {"variants/index": [h.name for h in of.headers], "studies/index": [s["name"] for s in of.studies],
                   "api/index": [name for name, _, _ in api.rooms],
                   "docs/decisions/README": [p.stem for p in ours if p.name.startswith("00")],
                   "docs/examples/README": [p[14:-3] for p in out if re.match(r"docs/examples/\w+/", p)]}
    for page, below in below_index.items():
        lines = [f"{b.split('/')[0]} <{b}>" for b in below]
        out[f"{page}.md"] += "\n```{toctree}\n:hidden:\n:titlesonly:\n\n" + "\n".join(lines) + "\n```\n"
    first = (here / "pages/start.md").read_text()
    others = [p[:-3] for p in out if re.match(r"(docs/)?\w+\.md", p) and f"<{p[:-3]}>" not in first]
    given = {"tabs": first_pages.start_tabs(), "picked": first_pages.choice(of), "others": "\n".join(others)}
    out |= {"index.md": first_pages.filled("docs/site/pages/start.md", given, of.links),
            "which.md": first_pages.filled("docs/site/pages/which.md", given, of.links)}
    return out


class Site:
    """Links of the tree as links of the site. A file that is no page is shown from files/."""

    def __init__(self, texts):
        self.texts, self.files = texts, set()
        self.titles = {p: m[1] for p, text in texts.items() if (m := re.match(r"# (.*)", text)) and p.endswith(".md")}
        self.titles |= {f"{p}.md": title for title, p in re.findall(r"^([\w' :+.?]+) <(.*)>$", texts["index.md"], re.M)}

    def target(self, page, link):
        if re.match(r"[a-z]+:|#", link):
            return link
        path, _, part = link.partition("#")
        whole = os.path.normpath(os.path.join(os.path.dirname(page), path))
        shown = {"docs": "index.md", "docs/README.md": "index.md", "docs/type_tables.py": "api/types.md"}
        whole = shown.get(whole, whole)
        found = next((p for p in (whole, f"{whole}/index.md", f"{whole}/README.md") if p in self.texts), None)
        if found:
            made = re.sub(r"\.(md|rst)$", ".html", found)
        elif (root / whole).is_file():
            self.files.add(whole)
            made = f"files/{whole}" + ("" if whole.endswith((".svg", ".json", ".csv")) else ".txt")
        elif (root / whole).is_dir():
            made = "files/" + whole + "/index.txt"
            self.files |= {whole, *(str(p.relative_to(root)) for p in (root / whole).iterdir() if p.is_file())}
        else:
            raise SystemExit(f"{page}: {link} leads nowhere")
        return os.path.relpath(made, os.path.dirname(page) or ".") + ("#" + part if part else "")

    def named(self, name, prose):
        """Files of Markdown as a reader of the site knows them: a link to one has the page's title for its text, and a
        file, a place in the theory or a question that is named alone becomes a link."""
        def to(path):
            return os.path.relpath(path, os.path.dirname(name) or ".")

        def title(m):
            path = os.path.normpath(os.path.join(os.path.dirname(name), m[3].partition("#")[0]))
            if m[2] and path in ("docs/theory.md", "docs/literature.md"):
                return f"[{path[5:-3]}{m[2]}]({m[3]})"
            return f"[{self.titles[path]}]({m[3]})" if path in self.titles else m[0]
        prose = re.sub(r"\[((?:[\w./]*/)?\w+\.md)(\s[\d.][\w., ]*)?\]\(([^()\s]+)\)", title, prose)
        parts = re.split(r"(\[[^\]]*\]\([^()\s]+\)|^#+ .*$)", prose, flags=re.M)    # links and headings stay
        for i in range(0, len(parts), 2):
            part = re.sub(r"(?<![\w/`])(?<!\]\()((?:docs/)?(?:\w+/)?\w+\.md)\b(?!\s\d)", lambda m: (
                f"[{self.titles[m[1]]}]({to(m[1])})" if m[1] in self.titles else m[0]), parts[i])
            part = re.sub(r'(?<!")docs/literature\.md (\d+(?:\.\d+)?)', lambda m: (
                f"literature [{m[1]}]({to('docs/literature.md')}#{m[1]})"), part)
            part = pages.places(part, to("docs/theory.md"))
            parts[i] = re.sub(r"\b(questions?)\s(\d+)( and )?((?<=and )\d+)?", lambda m: (
                f"[{m[1]} {m[2]}]({to('docs/questions.md')}#question-{m[2]})" + (m[3] or "") +
                (f"[{m[4]}]({to('docs/questions.md')}#question-{m[4]})" if m[4] else "")), part)
        return "".join(parts)

    def page(self, name):
        """A page's text as Sphinx reads it."""
        text = re.sub(r"^(#+ )(<a id=\"[^\"]*\"></a>)", r"\2\n\n\1", self.texts[name], flags=re.M)
        up = os.path.relpath("live/index.html", os.path.dirname(name) or ".")
        shown = re.search(r"using Shown = TypeList<(.*?)>;", shows.read_text() if shows.exists() else "", re.S)
        text = re.sub(r"\{\{live (\w+) (\w+)\}\}", lambda m: (
            f"[Take bits away from it, and change its data, in the live page]({up}#variant={m[1]})"
            if live.exists() and (not shown or f"{m[2]}<" in shown[1]) else ""), text)
        picture = root / "docs/live.svg"
        drawn = "![Digits that variants keep, row by row](docs/live.svg)\n\n" if picture.exists() else ""
        text = text.replace("{{live}}", f"{drawn}[The live page]({up}): the library itself in your browser. Take bits "
                            "away, and watch which variant breaks first." if live.exists() else "")
        if name.endswith(".rst"):
            return text
        text = re.sub(rf"^{re.escape(pages.numbers)}((?:.+\n)+)", lambda m: pages.folded(
            "The numbers", pages.parted(m[1].rstrip())), text, flags=re.M)
        if name == "docs/questions.md":
            text = re.sub(r"^(?:<a [^>]*></a>)?(?=\*\*([^*]+)\*\*)", lambda m: (
                m[0] if f'"{pages.anchor(m[1])}"' in m[0] else f'<a id="{pages.anchor(m[1])}"></a>{m[0]}'), text,
                          flags=re.M)
        text = without_comments(text)
        apart = (r"(^(`{3,})(?!\{|`).*?^\2$|(?<!`)`[^`\n]+`(?!`)|"     # blocks and names of code
                 r"!\[[^\]]*\]\([^)]*\)|\]\(\S*live/index\.html[^)]*\))")    # pictures, what is resolved
        parts = re.split(apart, text, flags=re.M | re.S)
        linked = [re.sub(r"\]\(([^()\s]+)\)", lambda m: f"]({self.target(name, m[1])})", self.named(name, part))
                  for part in parts[::3]]
        return "".join(a + (b or "") for a, b in zip(linked, parts[1::3] + [""]))


# What MyST takes at the beginning of a line, and other readers of Markdown do not: a comment, a break, a target.
only_myst = r"(?=%|(?:\+ *){3,}|\([^\n]+\)= *$)"


def without_comments(text):
    """A line of prose that MyST would take for something else joins the line before it; the first of a paragraph or of
    an item has its sign escaped."""
    parts = re.split(r"(^ *(`{3,})(?!`).*?^ *\2`*$)", text, flags=re.M | re.S)    # blocks of code stay as they are
    prose = [re.sub(rf"^([ >]*(?:(?:[-*+]|\d+\.) +)*){only_myst}", r"\1\\",
                    re.sub(rf"(?<=\S)\n[ >]*{only_myst}", " ", part, flags=re.M), flags=re.M) for part in parts[::3]]
    return "".join(a + b for a, b in zip(prose, [*parts[1::3], ""]))


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    if not path.exists() or path.read_text() != text:    # Sphinx reads anew what is newer
        path.write_text(text)


def mend_theme(static):
    """Debian's furo is in parts: a module that no page can load from a folder, a style sheet at the root of a server,
    and no dark colours where the system asks for them. Here they are put together."""
    script = static / "scripts/furo.js"
    module = static / "scripts/gumshoe-patched.js"
    script.write_text(re.sub(r"^import .*\n", "", module.read_text() + "\n" + script.read_text(), flags=re.M))
    module.unlink()
    sheet = static / "styles/furo.css"
    text = re.sub(r"@import url\((/\S+)\);", lambda m: pathlib.Path(f"/usr/share{m[1]}").read_text(), sheet.read_text())
    if (dark := re.search(r'body\[data-theme="dark"\] (\{.*?\})', text, re.S)) and "prefers-color-scheme" not in text:
        text += ("\n@media not print { @media (prefers-color-scheme: dark) {\n"
                 f'  body:not([data-theme="light"]) {dark[1]} }} }}\n')
    sheet.write_text(text)


def main(source, out):
    site = Site(sources())
    texts = {name: site.page(name) for name in site.texts}
    for name, text in texts.items():
        write(source / name, text)
    for old in [*source.rglob("*.md"), *source.rglob("*.rst")]:
        if str(old.relative_to(source)) not in texts:
            old.unlink()
    for picture in (*root.glob("docs/*.svg"), here / "terminal.svg", *root.glob("out/figures/*.svg")):
        to = source / {"docs": "docs", "site": "docs/site", "figures": "studies/figures"}[picture.parent.name]
        to.mkdir(exist_ok=True)
        shutil.copy(picture, to)
    shutil.rmtree(out, ignore_errors=True)
    run = subprocess.run([sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-b", "html", "-c", here, "-d",
                          source.parent / "doctrees", source, out], env=os.environ | {"RLSLAB_SITE": str(here)})
    if run.returncode:
        sys.exit("site: Sphinx has something to say of the pages above")
    mend_theme(out / "_static")
    for page in out.rglob("*.html"):    # a level for readers of screens; no icon, so that none is asked for
        text = page.read_text().replace(' role="heading"', ' role="heading" aria-level="2"')
        write(page, text.replace("</title>\n", '</title>\n<link rel="icon" href="data:,">\n', 1))
    for name in sorted(site.files):
        to = out / "files" / name
        if (root / name).is_dir():
            write(to / "index.txt", "\n".join(sorted(p.name for p in (root / name).iterdir())) + "\n")
        else:
            write(to if name.endswith((".svg", ".json", ".csv")) else to.with_name(to.name + ".txt"),
                  (root / name).read_text())
    if live.exists():
        write(out / "live/index.html", live.read_text().replace('data-variants=""', 'data-variants="../variants/"'))
    for name in ("objects.inv", ".buildinfo"):
        (out / name).unlink(missing_ok=True)
    faults, links, count = check.site(out)
    faults += [f"{name}: not on its page: {' '.join(words)}" for name in texts if name.endswith(".md")
               and (words := check.lost(texts[name], (out / name).with_suffix(".html").read_text()))]
    if faults:
        sys.exit("\n".join(faults))
    print(f"{count} pages, {links} links within them, each leads somewhere; no page asks another machine:\n"
          f"{out}/index.html")


if __name__ == "__main__":
    main(*map(pathlib.Path, sys.argv[1:3]))
