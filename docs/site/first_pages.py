"""The first pages: texts of docs/site/pages/, filled from the rest of the tree."""
import json
import re

from pages import fenced, folded, moved, numbers, parted, read, sizes, tabs


def start_tabs():
    """The same first filter from each language. The tests of the page that a block is of compile or run it."""
    return tabs({"C++": fenced("README.md", "cpp"), "Python": fenced("docs/python.md", "python"),
                 "C": fenced("docs/c.md", "c"),
                 "Command line": "rlslab compare --example longley\n"
                 "rlslab compare mydata.csv --input u --output y --order 4 --detrend\n"})


def paragraph(path, title):
    """Of a page: the paragraph, or the item of a list, that begins with a title in bold."""
    text = "\n\n" + read(path)
    m = re.search(rf"\n(?:- |<a id=\"[^\"]*\"></a>)?\*\*{re.escape(title)}\*\*(.*?)(?=\n\n|\n- )", text, re.S)
    if not m:
        raise SystemExit(f"{path}: no paragraph \"{title}\"")
    rest = text[m.end():].lstrip("\n")
    rest = rest.split("\n\n")[0].removeprefix(numbers) if rest.startswith(numbers) else ""
    return " ".join(f"{m[1]} {rest}".split())


def behind(path, title, links):
    """The numbers behind an answer, folded: that paragraph, with its place."""
    text = links.page(re.sub(r"\]\((\w+\.md)", r"](../docs/\1", paragraph(path, title)))
    text = text.replace("](../", "](")    # the first pages are above
    title = re.sub(r"\$(\w)_?(\w?)\$", r"\1\2", title)    # a summary has no formulas
    return folded(f"The numbers behind it: {title}", parted(f"{text} [→]({path})"))


def lost_on_the_map():
    """studies/maps/losses.csv as the form of which.md reads it: {regime: {basis: {prior: {kappa: cell}}}}, exponents
    of 1/u; a cell is "5.12,4.20,5.03,0.10,...": digits of the best, then losses in the order of the forms."""
    forms, *cells = [line.split(",") for line in read("studies/maps/losses.csv").splitlines() if line[0] != "#"]
    table = {}
    for regime, basis, prior, kappa, *lost in cells:
        table.setdefault(regime, {}).setdefault(basis, {}).setdefault(prior, {})[kappa] = ",".join(lost)
    return {"forms": forms[7:], "lost": table}


def choice(of):
    """What the form of which.md knows: the map of winners, and of each variant its line in the README's table, the
    bench (nanoseconds by word and size), docs/embedded.md (instructions of -O2 by board, word and size), and the claims
    of the study choose that hold, "SLOPE log2 kappa + c with c from A to B" for the variants that they name."""
    boards = {}
    for kind, word, d, m3, m4, m7 in re.findall(r"^\| `(\w+)<(\w+), (\d+)>` \| `-O2` \| \d+ \| \d+ \| (\d+) \| \d+ "
                                                r"\| (\d+) \| \d+ \| (\d+) \| \d+ \|$", read("docs/embedded.md"), re.M):
        for board, count in (("m3", m3), ("m4f", m4), ("m7", m7)):
            boards.setdefault(kind, {}).setdefault(board, {}).setdefault(word, {})[d] = int(count)
    law = r"(.*): (?:(\d) )?log2 kappa \+ c with c from (\d+) to (\d+)"
    laws = [(int(m[2] or 1), m[1], [int(m[3]), int(m[4])])
            for claim, verdict in next(s for s in of.studies if s["name"] == "choose")["verdicts"]
            if verdict == "holds" and (m := re.match(law, claim))]
    speed, rows = read("docs/speed.md"), []
    for h in of.headers:
        row = of.readme.get(h.name, ["", "", "no", ""])
        slope = int(row[-1][0]) if row[-1][:1].isdigit() else 0
        rows.append({
            "name": h.name, "sparse": h.sparse, "free": h.free, "slope": slope,
            "constant": next((c for s, who, c in laws if s == slope and (h.name in re.split(r", ?", who) or
                                                                        who == "factor forms")), None),
            "asymmetric": "Antisymmetric" in h.prose or "antisymmetric part of a rounding error grows" in h.prose,
            "later": f"`{h.name}` *" in speed,
            "cost": boards.get(h.type, {}) | {"x86": {
                word: {d: round(of.times[h.name, word, d]) for d in sizes if (h.name, word, d) in of.times}
                for word in ("float", "double")}}})
    return json.dumps({"machine": of.machine, "variants": rows, "map": lost_on_the_map()}).replace("</", "<\\/")


def filled(path, given, links):
    """A text of pages/: {{NAME}} is given; {{said PATH | TITLE}} is the numbers behind the answer above it."""
    text = moved(path, "")    # the pages stand at the top of the site
    text = re.sub(r"\{\{said (\S+) \| (.*?)\}\}", lambda m: behind(m[1], m[2], links), text)
    for name, value in given.items():
        text = text.replace(f"{{{{{name}}}}}", value if isinstance(value, str) else "")
    return re.sub(r"(?<![\[`])`(\w+)`(?!`)", lambda m: links.name(m[0]).replace("](../", "]("), text)
