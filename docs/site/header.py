#!/usr/bin/env python3
"""A variant's header, read: its names, and the text above its class as Markdown with LaTeX.

header.py           writes tests/site/formulas.txt, a section for each variant of the list
header.py --check   says which of them differ; a header that reads wrong is seen there
"""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parents[2]
sys.path.append(str(root / "bindings/python"))
from classes import listed, snake    # noqa: E402  the list of variants, as the Python package reads it

golden = root / "tests/site/formulas.txt"
greek = "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi rho sigma tau phi psi omega".split()
operators = {"<=": r"\le", ">=": r"\ge", "->": r"\to", "+=": r"\mathrel{+}=", "-=": r"\mathrel{-}=", "-+": r"\mp",
             "...": r"\dots", "*": r"\ast", "~": r"\sim"}
index = r"(?:_(?:\{[^}]*\}|[A-Za-z0-9]+)|0(?!\w))?"
power = r"\^(?:\([^)]*\)|-?[A-Za-z0-9]+)"
tokens = re.compile(rf"""(?P<code>`[^`]*`)|(?P<page>docs/theory\.md\ \d+(?:,\ \d+)*)|(?P<file>\w[\w/]*\.(?:md|hpp|cpp))
  |(?P<function>\b(?:sqrt|prod|diag|O)(?=[(\ ])(?!\ [a-z]{{2}}))
  |(?P<letter>(?<![A-Za-z0-9_])(?:{"|".join(greek)}|[A-Za-z]){index}(?![^\W_]|-\w){f"(?:{power})?"}(?:'(?!s\b))*)
  |(?P<word>'s\b|[^\W\d_](?:[\w:.-]*\w)?(?:\(\))?(?:'s\b)?)|(?P<number>\d+(?:\.\d+)?(?:{power})?)|(?P<power>{power})
  |(?P<sign><=|>=|->|\+=|-=|-\+|\.\.\.(?!\w)|[-+*/=<>~])|(?P<bar>\|)
  |(?P<open>[(\[])|(?P<close>[)\]]'*)|(?P<space>\ +)|(?P<other>.)
""", re.X | re.S)


def cut(text):
    """The text as (kind, text) pairs."""
    return [(m.lastgroup, m[0]) for m in tokens.finditer(text)]


def letter(text):
    """A letter of a formula, a number or a power, with its index, power and primes."""
    m = re.fullmatch(rf"([A-Za-z]+|[\d.]+|)({index})({power})?('*)", text)
    base = "\\" + m[1] if m[1] in greek else m[1]
    out = base + (f"_{{{m[2].strip('_{}')}}}" if m[2] else "")
    out += f"^{{{m[3][1:].strip('()')}}}" if m[3] else ""
    return (f"{{{out}}}" if m[3] and m[4] else out) + m[4]


def closing(cells, at):
    """Of the bracket at `at`: where it closes."""
    depth = 0
    for i in range(at, len(cells)):
        depth += (cells[i][0] == "open") - (cells[i][0] == "close")
        if depth == 0:
            return i
    raise ValueError("no closing bracket: " + "".join(t for _, t in cells))


def apart(cells, at):
    """Whether an equation in brackets begins here, which explains what stands before it: theta (R theta = z)."""
    return cells[at] == ("open", "(") and cells[at - 1:at] == [("space", " ")] and \
        cells[at - 2][0] in ("letter", "word") and ("sign", "=") in cells[at:closing_or(cells, at) + 1]


def latex(cells):
    """Cells of a formula as LaTeX; words of English stay words."""
    out, i, depth = [], 0, 0
    while i < len(cells):
        kind, text = cells[i]
        if kind == "function" and text == "sqrt" and cells[i + 1][0] == "open":
            end = closing(cells, i + 1)
            out.append(rf"{{\sqrt{{{latex(cells[i + 2:end])}}}}}")
            i = end
        elif text == "x" and [k for k, _ in cells[i - 2:i + 3:4]] == ["number", "number"]:
            out.append(r"\times")
        elif kind in ("letter", "number", "power"):
            out.append(letter(text))
        elif apart(cells, i):
            out.append(r"\ (")
        elif kind == "function":
            out.append({"sqrt": r"\sqrt", "prod": r"\prod", "O": "O"}.get(text, rf"\operatorname{{{text}}}"))
        elif kind in ("word", "code", "page", "file"):
            words = text.strip("`")
            while i + 2 < len(cells) and cells[i + 1] == ("space", " ") and cells[i + 2][0] == "word":
                words, i = f"{words} {cells[i + 2][1]}", i + 2
            glue = "" if words.startswith("'s") else r"\ "
            out.append(rf"{glue}\text{{{words}}}\ ".replace("_", r"\_"))
        elif kind == "space":
            out.append(r"\quad" if len(text) > 1 else "")
        else:
            depth += (kind == "open") - (kind == "close")
            out.append(r",\ " if text == "," and depth == 0 else operators.get(text, text))
        i += 1
    joined = re.sub(r"\s+", " ", " ".join(out)).strip().rstrip(" ,;\\")
    joined = re.sub(r"(\\ )?(?<!\\) ?(?=[',:;)\]])|(?<!\\) (?=\^)|(?<=[(\[]) |(?<=O) (?=\()", "", joined)
    return re.sub(r"^(\\ )+|(\\ )+(?=\\quad|\\ )|(?<=\\quad)( \\(?= ))+", "", joined).strip()


def in_sentence(cells):
    """Whether a run of cells is a formula: it has a letter that is no word, and not only an article."""
    names = [t for k, t in cells if k == "letter"]
    return bool(names) and (len(cells) > 1 or names[0] not in ("a", "A", "I"))


def sentences(text, link=lambda code: code):
    """Prose with its formulas in dollars. `link` makes what it likes of a name in backticks."""
    cells, out, i = cut(text), [], 0
    inside = ("letter", "number", "power", "sign", "bar", "function", "space", "open", "close")
    while i < len(cells):
        kind, text = cells[i]
        end = i    # the longest run from here that could be a formula, cut back to where brackets match
        while end < len(cells) and not apart(cells, end) and (cells[end][0] in inside or cells[end][1] == "," and any(
                cells[j][0] == "open" and closing_or(cells, j) > end for j in range(i, end))):
            end += 1
        while end > i and (cells[end - 1][0] in ("space", "sign", "function") or not balanced(cells[i:end])
                           or not starts_well(cells[i:end])):
            end -= 1
        if kind in ("letter", "number", "open", "bar", "function") and end > i and in_sentence(cells[i:end]) and (
                kind != "open" or any(c[0] == "sign" or c[1].endswith("'") for c in cells[i:end])):
            if end == i + 2 and cells[i][1] in ("a", "A"):
                end = i
            else:
                out.append(f"${latex(cells[i:end])}$")
                i = end
                continue
        if kind == "page":
            out.append(places(text))
        else:
            name = kind == "code" or kind == "word" and re.search(r"\(\)|::|[a-z]_[a-z]", text)
            out.append(link(f"`{text.strip('`')}`") if name else text)
        i += 1
    return "".join(out)


def slug(title):
    """The name under which a heading is found on a Git server."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def places(text, theory="../docs/theory.md"):
    """Places in the theory, as docs/theory.md 16, 17 to 19, become links to them."""
    return re.sub(r"(?<!\")docs/theory\.md\s((?:\d+(?:,\s|,?\s(?:to|and)\s(?=\d))?)+\b)", lambda m: "theory " + re.sub(
        r"\d+", lambda n: f"[{n[0]}]({theory}#{n[0]})", m[1]), text)


def closing_or(cells, at):
    try:
        return closing(cells, at)
    except ValueError:
        return -1


def balanced(cells):
    depth = 0
    for kind, text in cells:
        depth += (kind == "open") - (kind == "close")
        if depth < 0:
            return False
    return depth == 0 and sum(t == "|" for _, t in cells) % 2 == 0


def starts_well(cells):
    """No article among its letters, no numbers next to one another, no number of a formula in brackets."""
    text = "".join(t for _, t in cells)
    return not re.search(r"(^|\s)[aA](\s(?![-=+/])|$)|\(\d\)|\d \d|  ", text)


def matrix(rows):
    lines = r" \\ ".join(" & ".join(latex(cut(c)) for c in re.split(r"\s{2,}", row.strip())) for row in rows)
    return rf"\begin{{bmatrix}} {lines} \end{{bmatrix}}"


def drawn(first, second):
    """Two lines with matrices drawn in them: what stands in each bracket, and between and behind them."""
    split = [re.split(r"\[ (.*?) \]", line) for line in (first, second)]
    out = ""
    for k in range(1, len(split[0]), 2):
        out += latex(cut(" ".join(split[0][k - 1].split()))) + " " + matrix([s[k] for s in split]) + " "
    return out, split[0][-1].strip(), split[1][-1].strip()


def signs(text):
    """About how many signs LaTeX is drawn with, a wide space as two."""
    return len(re.sub(r"[\\{}_^' ]", "", re.sub(r"\\[a-z]+", "x", text.replace(r"\quad", "xx"))))


def fitting(text, most=62):
    """A row of formulas, or several where one would be wider than a page's column: cut behind a colon, else between two
    formulas."""
    spaces = [m for m in re.finditer(r" ?\\quad ", text) if m.start()]
    if signs(text) <= most or not spaces:
        return [text]
    fit = [m for m in spaces if signs(text[:m.start()]) <= most]
    at = next((m for m in spaces if text[m.start() - 1] == ":"), (fit or spaces[:1])[-1])
    return [text[:at.start()], *fitting(text[at.end():], most)]


def formula_block(lines):
    """Lines of formulas, numbered, continued or drawn, as one aligned block."""
    rows, i = [], 0    # (number, LaTeX)
    while i < len(lines):
        line = lines[i]
        parts = re.split(r"(?:^|\s{2,})\s*\((\d)\) ", line)
        if parts[0].strip():    # goes on from the line above
            parts = ["", "", *parts]
        for number, text in zip(parts[1::2], parts[2::2]):
            label = rf"({number})" if number else ""
            if re.search(r"\[ .* \]", text):
                body, behind, below = drawn(text, lines[i + 1])
                rows.append((label, body + (r"\quad " + latex(cut(behind)) if behind else "")))
                if below:
                    rows.append(("", latex(cut(below))))
                i += 1
            elif text.strip():
                first, *more = fitting(latex(cut(text.strip())))
                rows += [(label, first), *(("", row) for row in more)]
        i += 1
    return "$$\n\\begin{aligned}\n" + " \\\\\n".join(f"{n}\\quad & {f}" for n, f in rows) + "\n\\end{aligned}\n$$"


class Header:
    """name, class name, title, and above its class: `text`, blocks of Markdown; `prose`, its sentences as written."""

    def __init__(self, path):
        page = path.read_text()
        self.name = re.search(r'string_view name = "(\w+)"', page)[1]
        self.type = re.search(r"^class (\w+)", page, re.M)[1]
        self.title = " ".join(line[3:] for line in re.match(r"(?:// .*\n)+", page)[0].splitlines())
        above = re.search(r"((?:^///.*\n)+)(?:template.*\n)?class", page, re.M)[1]
        self.blocks = [b.split("\n") for b in re.split(r"\n\s*\n", "\n".join(ln[4:] for ln in above.splitlines()))]
        self.prose = "\n".join(" ".join(b) for b in self.blocks if not b[0].startswith("  "))
        self.sparse = "GPL" in page.split("\n")[0] + self.title
        self.block = m[1] if (m := re.search(r"Index block = (\d+)", page)) else ""
        self.accumulates = "void accumulate(" in page
        self.needs = "Eigen; any arithmetic" + (" with a square root" if "template <RootedScalar" in page else "")
        if self.sparse:
            self.needs = ("SPQR" if "spqr.hpp" in page else "CHOLMOD") + " (GPL-2+), binary64"
        self.free, self.may_be_indefinite = "starts_without_prior = true" in page, "Health::indefinite" in page
        self.called = f"`{self.name}`"    # in prose: also inverse QR, UD, Joseph's form
        if "_" in self.name:
            self.called += rf"|(?i:\b{self.name.replace('_', ' ')}\b)"
        elif len(self.name) == 2:
            self.called += rf"|(?<!nverse )(?<!xtended )\b{self.name.upper()}\b"
        if (person := re.match(r"(\w+)'s ", self.title)) and person[1].lower() in self.name:
            self.called += rf"|\b{person[1]}\b"
        self.quantity, self.form = re.findall(r"(?:Quantity|Form)::(\w+)", page)[:2]    # of what it stores
        self.propagates = {"plain": "the ", "factor": "a factor of the "}[self.form] + self.quantity
        if self.quantity == "covariance" and "= P^-1" in self.prose:
            self.propagates += " and one of its inverse"

    def text(self, link=lambda code: code):
        """The text above the class as blocks of Markdown."""
        return [formula_block(b) if b[0].startswith("  ") else sentences(" ".join(b), link) for b in self.blocks]


def variants():
    """The headers of THE list, the sparse ones last."""
    folder = root / "variants"
    names = listed(folder)
    names += [n for n in re.findall(r"^    (\w+),?$", (folder / "variants.hpp").read_text().split("#ifdef")[-1], re.M)]
    return [Header(folder / f"{snake(name)}.hpp") for name in names]


if __name__ == "__main__":
    made = {h.name: "\n\n".join(h.text()) + "\n" for h in variants()}
    if sys.argv[1:] == ["--check"]:
        kept = dict(re.findall(r"^== (\w+)\n\n(.*?\n)(?:\n(?===)|\Z)", golden.read_text(), re.M | re.S))
        wrong = [name for name in made | kept if made.get(name) != kept.get(name)]
        sys.exit(f"{golden.relative_to(root)}: {', '.join(wrong)}: not what header.py writes (run it, and read "
                 "what changed)" if wrong else 0)
    golden.write_text("\n".join(f"== {name}\n\n{text}" for name, text in made.items()))
