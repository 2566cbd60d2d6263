"""Every link within the site leads to a file and to a name in it, no page asks for anything from elsewhere, and no word
of a page's source is lost."""
import collections
import html
import pathlib
import re
import urllib.parse
from html.parser import HTMLParser


asked = re.compile(r"(?:url\(|@import)\s*[\"']?((?:https?:)?//[^\"')]*)")    # by a style sheet


class Page(HTMLParser):
    """The links, names and requests of a page."""
    asks = {"script": "src", "img": "src", "iframe": "src", "source": "src", "object": "data", "embed": "src"}

    def __init__(self, text):
        super().__init__()
        self.links, self.names, self.requests = [], set(), asked.findall(text)
        self.feed(text)

    def handle_starttag(self, tag, pairs):
        given = dict(pairs)
        self.names |= {given[k] for k in ("id", "name") if given.get(k)}
        if tag == "a" and given.get("href"):
            self.links.append(given["href"])
        want = given.get(self.asks.get(tag, "")) or (given.get("href") if tag == "link" else None)
        if want and not want.startswith("data:"):
            (self.requests if re.match(r"(https?:)?//", want) else self.links).append(want)


class Words(HTMLParser):
    """The text of a page's article without its formulas; what stands in blocks of their own is apart."""
    inline = {"a", "code", "em", "span", "strong", "sub", "sup"}
    without = {"math", "script", "style"}

    def __init__(self, page):
        super().__init__()
        self.text, self.skipped = [], 0
        self.feed(page)

    def handle_starttag(self, tag, pairs):
        self.skipped += tag in self.without
        self.text += [] if tag in self.inline else [" "]

    def handle_endtag(self, tag):
        self.skipped -= tag in self.without
        self.text += [] if tag in self.inline else [" "]

    def handle_data(self, data):
        self.text += [] if self.skipped else [data]


def counted(text):
    return collections.Counter(re.findall(r"[^\W_]+", text))


def lost(markdown, page):
    """Words of a Markdown text that its page has less often; formulas and numbers of items are not looked for."""
    text = re.sub(r"^(`{3,})\{toctree\}.*?^\1$|<script\b.*?</script>|^ *\d+\. ", "", markdown, flags=re.M | re.S)
    text = re.sub(r"^`{4,}(?:\{[\w-]+\} ?(.*))?$", r"\1", text, flags=re.M)    # around tabs
    prose, code = re.split(r"^ *(`{3,})(?!`).*\n(.*?)^ *\1 *$", text, flags=re.M | re.S), []
    prose, code = prose[::3], prose[2::3]
    for part in prose:
        spans = re.split(r"(?<!`)`([^`]+)`(?!`)", re.sub(r"\$\$.*?\$\$|(?<!\\)\$[^$]+(?<!\\)\$", " ", part, flags=re.S))
        plain = re.sub(r"!\[[^\]]*\]\([^)]*\)|\]\([^)]*\)|<[^>]*>", "", " ".join(spans[::2]))
        code += [html.unescape(plain), *spans[1::2]]
    return sorted((counted("\n".join(code)) - counted("".join(Words(page).text))).elements())


def site(folder):
    """(faults, links within the site, pages)."""
    folder = folder.resolve()
    pages = {p: Page(p.read_text()) for p in sorted(folder.rglob("*.html"))}
    faults, links = [], 0
    for path, page in pages.items():
        where = path.relative_to(folder)
        faults += [f"{where}: asks {r}" for r in page.requests]
        for link in page.links:
            if re.match(r"[a-z]+:", link):
                continue
            links += 1
            to, part = urllib.parse.urldefrag(link)
            target = (path.parent / urllib.parse.unquote(to.split("?")[0])).resolve() if to else path
            if not target.is_file() or folder not in target.parents:
                faults.append(f"{where}: {link}: no such file")
            elif part and target.parent.name != "live" and target in pages and \
                    urllib.parse.unquote(part) not in pages[target].names:
                faults.append(f"{where}: {link}: no such name there")
    for path in folder.rglob("*.css"):
        faults += [f"{path.relative_to(folder)}: asks {r}" for r in asked.findall(path.read_text())]
    return faults, links, len(pages)


def dead(root, texts):
    """Places of the theory and the literature that are cited in the texts, and files that Markdown links to, which do
    not exist."""
    anchors = {n: set(re.findall(r'<a id="([\d.]+)">', (root / "docs" / n).read_text()))
               for n in ("theory.md", "literature.md")}
    out = []
    for path, text in texts.items():
        places = re.findall(r"docs/(theory\.md|literature\.md)[\s/*#]+(\d+(?:\.\d+)?)", text)
        out += [f"{path.name}: {page} {number}" for page, number in places if number not in anchors[page]]
        if path.suffix == ".md":
            prose = re.sub(r"^```.*?^```$|`[^`\n]*`", "", text, flags=re.M | re.S)
            links = [urllib.parse.unquote(t.partition("#")[0]) for t in re.findall(r"\]\(([^()\s]+)\)", prose)]
            out += [f"{path.name}: {to}" for to in links
                    if to and not re.match(r"[a-z]+:", to) and not (path.parent / to).exists()]
    return out


if __name__ == "__main__":
    import sys
    faults, links, count = site(pathlib.Path(sys.argv[1]))
    print(*faults, f"{count} pages, {links} links", sep="\n")
    sys.exit(bool(faults))
