"""Every link within the site leads to a file and to a name in it, and no page asks for anything from elsewhere."""
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


if __name__ == "__main__":
    import sys
    faults, links, count = site(pathlib.Path(sys.argv[1]))
    print(*faults, f"{count} pages, {links} links", sep="\n")
    sys.exit(bool(faults))
