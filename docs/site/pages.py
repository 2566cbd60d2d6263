"""Pages made from what the tree records: one for each variant and for each study, and tables for the others.

Each function returns Markdown whose links are those of the tree; build.py turns them into links of the site.
"""
import json
import os
import re

from header import places, root, sentences, slug, variants

sizes = (2, 4, 8, 16, 32, 64, 128)
listing = {"C++": "cpp", "Python": "python", "C": "c", "Command line": "none"}


def read(path):
    return (root / path).read_text()


def moved(path, to):
    """A page's text with its links as from another folder of the tree."""
    def link(m):
        return f"]({os.path.relpath(os.path.join(os.path.dirname(path), m[1]), to or '.')}"
    return re.sub(r"\]\(((?:\.\./)+[^)#]*)", link, read(path))


def fenced(path, language, number=0):
    """Of a page: its block in a language. These are the blocks that tests compile or run."""
    return re.findall(rf"^```{language}\n(.*?)^```$", read(path), re.M | re.S)[number]


def close(code):
    """Without the blanks that align comments: pages are narrower than files."""
    return re.sub(r" {3,}(//|#)", r"    \1", code)


def tabs(blocks):
    out = "".join(f"````{{group-tab}} {name}\n```{listing[name]}\n{close(code).rstrip()}\n```\n````\n"
                  for name, code in blocks.items())
    return f"`````{{tabs}}\n{out}`````\n"


def table(head, rows):
    rows = [[str(c) for c in row] for row in rows]
    return "\n".join(f"| {' | '.join(row)} |" for row in [[str(c) for c in head], ["---"] * len(head), *rows]) + "\n"


def parted(text, most=150, each=70):
    """A paragraph of more than so many words, as paragraphs of whole sentences."""
    if len(text.split()) <= most:
        return text
    parts = [""]
    for sentence in re.split(r"(?<=\.)\s+(?=[A-Z*(`$])|(?<=\.\))\s+", text):
        if len(parts[-1].split()) + len(sentence.split()) / 2 > each:
            parts.append("")
        parts[-1] += f" {sentence}" if parts[-1] else sentence
    return "\n\n".join(parts)


def folded(title, text):
    return f"<details><summary>{title}</summary>\n\n{text}\n\n</details>\n"


# What a variant's page takes from elsewhere.

def readme_rows():
    """The README's table of variants: operations, no prior, ns ..., bits."""
    return {name: [c.strip() for c in rest.split("|")]
            for name, rest in re.findall(r"^\| `(\w+)` \|(.*)\|$", read("README.md"), re.M)}


def times():
    """(variant, arithmetic, d) -> nanoseconds of an update, and the machine, from bench/baseline.json. A unit of that
    file in nanoseconds stands in docs/speed.md, and so do the times of the same run in double, less rounded: those that
    are there are taken from there."""
    machine, recorded = next(iter(json.loads(read("bench/baseline.json"))["machines"].items()))
    unit = float(re.search(r"\(([\d.]+) ns here\)", read("docs/speed.md").replace("\n", " "))[1])
    out = {}
    for name, (_, median, _) in recorded["rows"].items():
        kind, *rest = name.split("/")
        if kind == "update" and len(rest) == 3:
            out[rest[0], rest[1], int(rest[2])] = median * unit
    first = re.search(r"^\| ns an update.*?\n\n", read("docs/speed.md"), re.M | re.S)[0].splitlines()
    asked = [int(c) for c in re.findall(r"\| (\d+) (?=\|)", first[0])]
    for name, cells in re.findall(r"^\| `(\w+)`(?: \*)? \|(.*)", "\n".join(first), re.M):
        out |= {(name, "double", d): int(c) for d, c in zip(asked, cells.split("|")) if c.strip().isdigit()}
    return machine, out


numbers = "*The numbers.* "    # begins the paragraph behind an answer in short; build.py folds it


def anchor(title):
    """The name of a question in docs/questions.md, as build.py gives it: question-7 of the fifteen, or its words."""
    number = re.match(r"(\d+)\. ", title)
    return f"question-{number[1]}" if number else slug(" ".join(title.rstrip("?.").split()))


def questions():
    """docs/questions.md by question: (title, anchor, the answer in short or "", the numbers)."""
    found = []
    for block in re.split(r"\n\n", read("docs/questions.md")):
        if m := re.match(r'(?:<a id="[^"]*"></a>)?\*\*(.*?)\*\*(.*)', block, re.S):
            found.append((" ".join(m[1].split()), anchor(m[1]), "", " ".join(m[2].split())))
        elif found and block.startswith(numbers):
            title, place, _, short = found.pop()
            found.append((title, place, short, " ".join(block.removeprefix(numbers).split())))
    return found


def studies():
    """The studies in the order of the record: their words from their sources, their verdicts from studies/*.json."""
    full = json.loads(read("studies/verdicts-full.json"))
    sources = {p: p.read_text() for p in sorted((root / "studies").glob("*/*.cpp"))}
    string = re.compile(r'\s*(?:R"tex\((.*?)\)tex"|"((?:[^"\\]|\\.)*)")', re.S)
    out = []
    written = re.findall(r"^(?:extern )?Study const (\w+)\{", "\n".join(sources.values()), re.M)
    for name, verdicts in (full | {n: {} for n in written if n not in full}).items():
        path, code = next((p, t[m.start():]) for p, t in sources.items()
                          if (m := re.search(rf"^(?:extern )?Study const {name}\{{", t, re.M)))
        study = {"name": name, "folder": path.parent.name, "path": path.relative_to(root),
                 "verdicts": list(verdicts.items())}
        for field in ("question", "source", "formula", "interpretation", "data"):
            study[field], at = "", code.find(f".{field} =") + len(f".{field} =")
            while at > len(field) + 2 and (m := string.match(code, at)):
                study[field] += m[1] or m[2].replace('\\"', '"').replace("\\\\", "\\")
                at = m.end()
        named = re.search(r"\.factors = (\w+),", code)
        factors = (re.search(rf"std::vector<Factor> {named[1]}\((.*?)\n}}", sources[path], re.S) if named else
                   re.search(r"\.factors =(.*?)\.measures", code, re.S))
        study["factors"] = list(dict.fromkeys(re.findall(r'\{"([\w ]+)",(?!\s*")', factors[1]))) if factors else []
        out.append(study)
    return out


class Links:
    """Names that have a page become links to it: `ud`, study gain_error, docs/theory.md 16."""

    def __init__(self, variants, studies):
        self.variants, self.studies = set(variants), set(studies)

    def name(self, code):
        bare = code.strip("`")
        if bare in self.variants:
            return f"[{code}](../variants/{bare}.md)"
        return f"[{code}](../studies/{bare}.md)" if bare in self.studies else code

    def prose(self, text):
        """Words of a source file as they stand; names of studies and variants, and places in the theory, are linked."""
        text = re.sub(r"\b(studies|study) (\w+)\b", lambda m: f"{m[1]} `{m[2]}`" if m[2] in self.studies else m[0],
                      text)
        text = re.sub(r"(?<![`\w])[a-z]+_[a-z_]+(?![`\w])", lambda m: f"`{m[0]}`", escaped(text))
        text = re.sub(r"`\w+`", lambda m: self.name(m[0]), text)
        return places(text)

    def page(self, text):
        """Words of a Markdown page, whose links are of docs/."""
        text = re.sub(r"\]\((?!\.\.|\w+:)(#?)", lambda m: "](../docs/" + ("questions.md#" if m[1] else ""), text)
        return re.sub(r"(?<!\[)`(\w+)`", lambda m: self.name(m[0]), text)


def escaped(text):
    """Words that are no Markdown. (Underscores within a word are none.)"""
    return re.sub(r"([*<\[$])(?!\s)", lambda m: "&lt;" if m[1] == "<" else "\\" + m[1], text)


# The code of a variant: the blocks of README, docs/python.md and docs/c.md with its name in place of theirs; with the
# default prior where it needs one.

def code_of(header):
    out = {}
    use = "<double>" if not header.sparse else ""
    out["C++"] = (fenced("README.md", "cpp").replace("variants/ud.hpp", f"variants/{header.name}.hpp")
                  .replace("Ud<double>", header.type + use))
    if not header.sparse:
        out["Python"] = fenced("docs/python.md", "python").replace("rlslab.Qr(", f"rlslab.{header.type}(")
        out["C"] = fenced("docs/c.md", "c").replace('"qr"', f'"{header.name}"')
        if not header.free:
            out["Python"] = out["Python"].replace(", prior_variance=None", "")
            out["C"] = re.sub(r"\n *options\.prior_variance = 0;.*", "", out["C"])
    return out


dies = {
    ("covariance", "plain"): "$P$ itself is stored, and rounding can make it indefinite. `health` is `indefinite` at "
    "each row whose $\\gamma$ lies outside $[0, 1]$. A row meets $P$ along its $\\psi$ only, so that $P$ may have been "
    "indefinite for a while. A [guard](../docs/library.md#around-a-filter) around it resets $P$.",
    ("covariance", "factor"): "A factor of $P$ is stored: $P$ stays positive definite while nothing overflows or "
    "underflows (docs/theory.md 34).",
    ("covariance", "full root"): "A full root of $P$ is stored: $P$ stays semidefinite, but under a large prior "
    "rounding can make it singular, which `health` does not report (docs/theory.md 44).",
    ("information", "factor"): "A factor of $P^{-1}$ is stored, and a row only adds to $P^{-1}$.",
    ("information", "plain"): "$P^{-1}$ itself is stored and factored for the report.",
}


def death(h):
    """How a filter ends: by what it stores, and by what its page says of health."""
    out = [places(dies[h.quantity, "full root" if "a full square root" in h.prose else h.form])]
    if h.may_be_indefinite and h.quantity == "information":
        out.append("`health` is `indefinite` where a pivot is not positive.")
    if h.free:
        out.append("Without a prior it is `undetermined` until enough rows have come.")
    return " ".join([*out, "After an overflow, or a row that is not finite, it is `nonfinite`.\n"])


def good_at():
    """docs/site/pages/good_at.md by variant: its paragraphs. {{TITLE}} is a question of docs/questions.md."""
    asked = {t: f"[{t}](../docs/questions.md#{a})" for t, a, *_ in questions()}
    text = re.sub(r"\{\{([^}]*)\}\}", lambda m: asked.get(" ".join(m[1].split()), m[0]),
                  moved("docs/site/pages/good_at.md", "variants"))
    parts = re.split(r"^## (\w+)\n", text, flags=re.M)
    return dict(zip(parts[1::2], (p.strip().split("\n\n") for p in parts[2::2])))


def on_the_map(name):
    """What the table of all cells in docs/map.md has of a form, as a sentence."""
    row = re.search(rf"^\| `{name}` \| (\d+) \| (\d+) \| (\d+) \| ([\d.]+) \(", read("docs/map.md"), re.M)
    return (f"- **On [the map of winners](../docs/map.md)**, 750 cells of word, memory, prior, condition and basis: it "
            f"broke down in {row[1]} % of them, lost half a digit or more to the best form in {row[2]} % and a digit "
            f"or more in {row[3]} %; where it was sound it lost {row[4]} at most.") if row else ""


def said(header, of):
    """What a variant is good and bad at, where it stands on the map, and the questions that name it; and the claims
    that name it: those on its end apart."""
    found = [f"- {of.links.page(p)}" for p in of.good_at.get(header.name, [])] + [on_the_map(header.name)]
    asked = [f"[{t.rstrip('?.')}](../docs/questions.md#{a})" for t, a, *text in of.questions
             if re.search(header.called, " ".join([t, *text]))]
    if asked:
        found += ["", folded(f"{counted(asked, 'question')} whose answers name it", "\n".join(f"- {q}" for q in asked))]
    claims = [(s["name"], c, v) for s in of.studies for c, v in s["verdicts"]
              if re.search(rf"\b{header.name}\b(?!')|{header.called}", c)]
    ends = [c for c in claims if re.search(r"definite|overflow|break|surviv|ends|freez|lose", c[1])]
    return found, [c for c in claims if c not in ends], ends


def counted(what, name):
    return f"{len(what)} {name}{'s' * (len(what) > 1)}"


legend = ("A claim puts a number in a *band*. It **holds** where the number's interval over the seeds lies inside the "
          "band, **fails** where it lies outside, and is **undecided** otherwise. *Full budget*: at least 20 draws of "
          "the data behind each interval (`winner_map`: 11). A "
          "letter and a number before a colon (`T3:`) are the claim's own name in the study's source. $u$ is the unit "
          "roundoff; other letters: [notation](../docs/notation.md), words: [words](../docs/words.md), counts: "
          "[verdicts](../docs/questions.md#verdicts).\n\n")


def claim_table(claims, links):
    """Folded: the claims of studies."""
    rows = [[links.name(f"`{s}`"), links.prose(c).replace("|", "\\|"), f"**{v}**"] for s, c, v in claims]
    title = f"{counted(rows, 'claim')} of the studies that name{'s' * (len(rows) == 1)} it (full budget, seed 1)"
    return folded(title, legend + table(["study", "claim", "verdict"], rows)) if rows else ""


def cost(header, of, storage):
    operations = of.readme.get(header.name, ["", "–"])[1]
    page = [storage + ".\n"] if storage else []
    if operations != "–":
        what = f"A row of a block of {header.block}, without theta," if header.block else "An update, theta included,"
        page.append(f"{what} at 10 parameters: {operations} operations, counted by running the code.\n")
    timed = [[a, *(f"{of.times[header.name, a, d]:.0f}" for d in sizes)] for a in ("float", "double")
             if all((header.name, a, d) in of.times for d in sizes)]
    if timed:
        call = "accumulate()`, without report" if header.accumulates else "update()`, without solving for theta" if (
            f"`{header.name}` *" in read("docs/speed.md")) else "update()`"
        page += [f"Nanoseconds of an `{call}, by number of parameters ({of.machine}; `bench/baseline.json`,\n"
                 "[how it was measured](../docs/speed.md#how-it-was-measured)):\n", table(["", *sizes], timed)]
    return page


def variant_page(h, of):
    """The page of a header; `of`: what all of them share."""
    links = of.links
    row = of.readme.get(h.name, ["–"] * 7)
    title, _, lead = h.title.split(". ")[0].rstrip(".").partition(": ")
    source = re.search(r"Sources?: (.*?)(?:\. Nothing.*|\.)?$", h.prose)[1]
    storage = m[1] if (m := re.search(r"(Storage .*?)(?:\. |\.?$)", h.prose)) else ""
    storage = sentences(storage, links.name)
    blocks = [re.sub(r" ?Sources?: .*?(\. (?=Nothing)|$)", "", b.replace(storage + "." if storage else "\0", ""))
              for b in h.text(links.name)]
    found, claims, ends = said(h, of)
    dying = [s for s in re.split(r"(?<=\.) |\n", h.prose) if re.search(
        r"NaN|breakdown|indefinite|warning|drift|grows? as|Squares|definite exactly|walk replaces", s)]
    page = [f"# {title} (`{h.name}`)\n", sentences(f"{lead[0].upper()}{lead[1:]}.\n") if lead else ""]
    page += [table(["", ""], [
        ["class", f"`rlslab::{h.type}{'' if h.sparse else '<T, N>'}`"],
        ["header", f"[`<rlslab/variants/{h.name}.hpp>`]({h.name}.hpp)"],
        ["propagates", h.propagates],
        ["starts without a prior", "yes" if h.free else "no"],
        ["needs", h.needs]]),
        f"{{{{live {h.name} {h.type}}}}}\n", "## What it computes\n", *(b.strip() + "\n" for b in blocks),
        "## What it costs\n",
        *cost(h, of, storage), "## Good at, bad at\n"]
    if row[-1] != "–":
        page.append(f"Bits that its word needs more when the condition number of the rows doubles: **{row[-1]}** "
                    "([how that was found](../README.md#the-variants-and-their-speed)).\n")
    page += found + ["", claim_table(claims, links) or "" if found or claims else "No study asks about it yet.\n",
                     "## How it dies\n", death(h)]
    page += [f"- {sentences(s, links.name)}" for s in dying]
    page += ["", claim_table(ends, links), "## In a program\n", tabs(code_of(h)),
             f"## Source\n\n{source}. `rlslab cite {h.name}` prints BibTeX; all works: "
             "[literature](../docs/literature.md#6).\n"]
    return "\n".join(page)


class Shared:
    """What the pages of variants take from the rest of the tree."""
    def __init__(self):
        self.headers = variants()
        self.readme, self.questions, self.studies, self.good_at = readme_rows(), questions(), studies(), good_at()
        self.machine, self.times = times()
        self.links = Links([h.name for h in self.headers], [s["name"] for s in self.studies])


def variant_index(of):
    rows = []
    for h in of.headers:
        row = of.readme.get(h.name, ["–"] * 7)
        bits, _, more = row[-1].partition("; ")
        rows.append([f"[`{h.name}`]({h.name}.md)", bits, row[4], row[1], row[2], row[0],
                     f'<span class="title">{re.split(": |[.] ", h.title)[0].rstrip(".")}{more and "; "}{more}</span>'])
    return "# The variants\n\nEach is one page in `variants/`: its formula, then the code in the same letters. What " \
        "the columns mean: [README](../README.md#the-variants-and-their-speed).\n\n" + \
        table(["variant", "bits", "ns at 16", "operations at 10", "no prior", "propagates", ""], rows)


def quoted(factor):
    return f"'{factor}'" if " " in factor else factor


def study_page(s, links):
    runs = ["--budget full --out mine", "--describe",
            *(f"--set {quoted(f)}=... --out mine" for f in s["factors"] if f != "replicate")]
    page = [f"# {s['question']}\n",
            f"Study `{s['name']}` ([its source](../{s['path']}); all of them: [studies](index.md)).\n"]
    page += ["$$\n" + " ".join(s["formula"].split()) + "\n$$\n"] if s["formula"] else []
    drawn = sorted((root / "out/figures").glob(f"{s['name']}-*.svg"))    # where ./lab report has run
    page += [f"![A figure of the study, as the last report here drew it](figures/{p.name})\n" for p in drawn]
    page += [links.prose(s["interpretation"]) + "\n", f"*Data:* {links.prose(s['data'])}.\n" if s["data"] else "",
             f"*Source of the law:* {links.prose(s['source'])}.\n" if s["source"] else "", "## Verdicts\n",
             legend,
             table(["claim", "verdict"], [[links.prose(c).replace("|", "\\|"), f"**{v}**"] for c, v in s["verdicts"]]),
             "## Run it, vary it\n", "```", *(f"rlslab study {s['name']} {words}" for words in runs), "```\n",
             "`--out` leaves the table, the figure and a report. `--describe` prints its factors with their values, "
             "its measures, the origin of each band, and how long it takes. More: "
             "[vary a study](../docs/questions.md#vary-a-study)."]
    return "\n".join(page)


def study_index(of):
    subjects = {}
    for s in of.studies:
        subjects.setdefault(s["folder"], []).append(s)
    page = ["# The studies\n", "Each asks one question and judges claims by intervals over seeds. What came out is in "
            "[questions and answers](../docs/questions.md). Verdicts at the full budget, seed 1: "
            "[the record](verdicts-full.json).\n"]
    for subject, found in subjects.items():
        page += [f"## {subject.capitalize()}\n", table(["study", "question", "holds", "fails", "undecided"], [
            [f"[`{s['name']}`]({s['name']}.md)", s["question"].replace("|", "\\|"),
             *(sum(v == w for _, v in s["verdicts"]) for w in ("holds", "fails", "undecided"))] for s in found])]
    return "\n".join(page)
