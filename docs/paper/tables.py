#!/usr/bin/env python3
"""What paper.tex takes from the tree and from a run of the studies, as LaTeX:

    tables.py OUT TO   writes TO/recorded.tex, TO/claims.txt (the list of claims whose hash the paper has) and
                       TO/figures.txt (the figures that it shows); OUT is the folder of the run. ./lab paper calls this
    tables.py --check [FILE]   what paper.tex, or FILE, names and the tree does not have; needs no run

paper.tex names what it takes:
    \\source{KEY}{WORDS}                  the entry of docs/literature.md that begins with WORDS
    \\cell{PAGE}{HEADING}{ROW}{COLUMN}    a number of a table of a page of docs; HEADING/2 is the second under it
    \\headcell{PAGE}{HEADING}{ROW}{COLUMN}    the same up to its first bracket
    \\quoted{PAGE}{WORDS}                 words that a page of docs, or a file, has, wherever its lines break
    \\rows{PAGE}{HEADING}{COLUMNS}        the rows of one, of the columns named, ; between them
    \\operations{VARIANT}, \\nanoseconds{VARIANT}{PARAMETERS}
    \\counted{STUDY}{VERDICT}              how many claims hold, fail or are undecided there; "of": all
    \\recorded{STUDY}{N}{WORDS}           the verdict on a claim in studies/verdicts-full.json
    \\brier{STUDY}                       the Brier score of its claims on record, where probabilities were given
    \\score                              what was predicted before a run, with its verdicts and its Brier score
    \\plot{NAME}                          a figure of docs or of the run
and single numbers, as below."""
import hashlib, json, pathlib, re, sys

here = pathlib.Path(__file__).resolve().parent
root = here.parent.parent
checks = sys.argv[1:2] == ["--check"]
paper = (pathlib.Path(sys.argv[2]) if checks and sys.argv[2:] else here / "paper.tex").read_text()
faults = []

signs = {"&": r"\&", "%": r"\%", "#": r"\#", "_": r"\_", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}",
         "<": "$<$", ">": "$>$", "|": "$|$", "{": r"\{", "}": r"\}", "–": "--", "…": r"\ldots{}", "²": "$^2$",
         "³": "$^3$", "√": r"$\surd$", "≤": r"$\le$", "≥": r"$\ge$", "±": r"$\pm$", "·": r"$\cdot$", "×": r"$\times$",
         "κ": r"$\kappa$", "λ": r"$\lambda$", "θ": r"$\theta$", "δ": r"$\delta$", "ψ": r"$\psi$", "σ": r"$\sigma$"}


def tex(markdown):
    """Text of a page: formulas as they stand, code in typewriter letters, signs that LaTeX would read escaped."""
    out = []
    for part in re.split(r"(\$[^$]*\$|`[^`]*`)", markdown):
        if part.startswith("$"):
            out.append(part)
        elif part.startswith("`"):
            out.append(r"\texttt{" + "".join(signs.get(c, c) for c in part[1:-1]).replace(r"\_", r"\_\allowbreak ") +
            "}")
        else:
            part = re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", part)
            out.append("".join(signs.get(c, c) for c in re.sub(r"(?<=\s)-(?=\d)", "$-$", " " + part)[1:]))
    return "".join(out)


def defined(name, text):
    return "\\expandafter\\def\\csname rls@%s\\endcsname{%s}" % (name, text)


def named(command, arguments):
    """The arguments of a command, wherever paper.tex has it."""
    one = r"\{([^}]*)\}"
    text = re.sub(r"(?m)^\\newcommand.*$", "", paper)
    found = re.findall(r"\\" + command + r"(?:\[[^]]*\])?" + arguments * one, text)
    return list(dict.fromkeys(tuple(" ".join(a.split()) for a in ((f,) if arguments == 1 else f)) for f in found))


def tables_of(page):
    """The tables of a page: {heading, heading/2: [header, rows ...]}."""
    out, heading, lines = {}, "", (root / "docs" / (page + ".md")).read_text().split("\n")
    count, rows = 0, []
    for line in lines + [""]:
        if line.startswith("|") and line.endswith("|"):    # a line of text may begin with a size
            rows.append([cell.strip() for cell in line.strip().strip("|").split("|")])
            continue
        if rows:
            count += 1
            out[heading + ("/%d" % count if count > 1 else "")] = [rows[0]] + rows[2:]
            rows = []
        if line.startswith("#"):
            heading, count = re.sub(r"<[^>]*>|`", "", line.lstrip("# ")), 0
    return out


def table(page, heading):
    if not (root / "docs" / (page + ".md")).exists():
        faults.append("docs/%s.md: not there" % page)
        return [[""]]
    out = tables_of(page).get(heading)
    if out is None:
        faults.append("docs/%s.md: no table under \"%s\"" % (page, heading))
    return out or [[""]]


def column_of(rows, column, where):
    """The place of a column, by its heading without the marks of code, or by "column N"."""
    names = [name.replace("`", "") for name in rows[0]]
    if re.fullmatch(r"column \d+", column) and int(column[7:]) <= len(names):
        return int(column[7:]) - 1
    if column not in names:
        faults.append("%s: no column \"%s\" among %s" % (where, column, names))
        return 0
    return names.index(column)


def cells():
    for command, (page, heading, row, column) in ((c, n) for c in ("cell", "headcell") for n in named(c, 4)):
        rows = table(page, heading)
        at = column_of(rows, column, "docs/%s.md, %s" % (page, heading))
        found = [r for r in rows[1:] if r[0].replace("`", "") == row]
        if len(found) != 1:
            faults.append("docs/%s.md, %s: expected one row \"%s\"" % (page, heading, row))
        text = found[0][at] if found else "?"
        yield defined("@".join((command, page, heading, row, column)),
                      tex(text if command == "cell" else re.split(r" [(\[]", text)[0]))


def quotations():
    for page, words in named("quoted", 2):
        of = root / (page if "." in page else "docs/%s.md" % page)
        if words not in (" ".join(of.read_text().split()) if of.exists() else ""):
            faults.append("%s does not say \"%s\"" % (of.relative_to(root), words))


def rows():
    for page, heading, columns in named("rows", 3):
        of = table(page, heading)
        places = [column_of(of, c, "docs/%s.md, %s" % (page, heading)) for c in map(str.strip, columns.split(";"))]
        text = "".join(" & ".join(tex(r[p]) for p in places) + r"\\" + "\n" for r in of[1:])
        yield defined("@".join(("rows", page, heading, columns)), text)


def costs():
    """Operations of an update at 10 parameters, counted, and nanoseconds in double; a dash where none were measured."""
    for command, arguments, page, heading in (
            ("operations", 1, "compare", "What is compared: variants, operations, arithmetics"),
            ("nanoseconds", 2, "speed", "What an update takes")):
        of = table(page, heading)
        found = {r[0].strip("` *"): dict(zip(of[0], r)) for r in of[1:]}
        for named_so in named(command, arguments):
            variant, column = named_so if arguments == 2 else (named_so[0], "d = 10")
            if command == "operations" and variant not in found:
                faults.append("docs/compare.md counts no operations of " + variant)
            text = found.get(variant, {}).get(column, "--")
            yield defined("@".join((command,) + named_so), tex(text))


def machine():
    machines = json.loads((root / "bench/baseline.json").read_text())["machines"]
    yield r"\newcommand{\benchmachine}{%s}" % tex("; ".join(machines))


def entries():
    text = (root / "docs/literature.md").read_text()
    return [re.sub(r"\s+", " ", e).strip() for e in re.split(r"\n- ", text[text.index('<a id="6">'):])[1:]]


def none_or(n):
    return "none" if n == 0 else str(n)


def grade_of(entry):
    """As docs/literature.md 0 has it: 0 read, 1 abstract read, 2 not read; 3 for a program, data or a manual, which is
    not its paper. What was not read itself is 2, though a program or data of it were."""
    if re.search(r"[Nn]ot read|(paper|text|report|papers) not", entry):
        return 2
    if re.search(r"[Aa]bstract|first chapter", entry):
        return 1
    return 3 if re.search(r"[Pp]rogram read|Data and certified values|Documentation of the routines", entry) else 0


grades = ("read in full", "abstract read", "not read", "program, data or manual read")


def sources():
    """The bibliography: entries of docs/literature.md without its remarks, and what was read of each in italics."""
    known, counts = entries(), [0, 0, 0, 0]
    for key, words in named("source", 2):
        found = [e for e in known if e.startswith(words)]
        if len(found) != 1:
            faults.append("docs/literature.md 6: expected one entry that begins with \"%s\", found %d"
                          % (words, len(found)))
            continue
        entry = re.sub(r" No DOI known[.;]|, no DOI known", "", re.sub(r" \((`[^`]*`(, )?)+\)", "", found[0]))
        entry = re.sub(r"(?<=\d)–(?=\d)", "--", entry)
        counts[grade_of(entry)] += 1
        link = re.search(r"<(https?://[^>]*)>", entry)
        if link:
            entry = entry.replace(link.group(0), "`" + link.group(1) + "`")
        said = re.search(r"(?<=\. )(?=[^.]*\b(read|Read|Cited)\b)|(?<=\. )(?=Lecture notes)", entry)
        at = said.start() if said else len(entry)
        yield defined("source@" + key, tex(entry[:at]) + r"\emph{[%s]}" % grades[grade_of(entry)])
    for name, n in zip(("read", "abstract", "unread", "program"), counts):
        yield r"\newcommand{\sources%s}{%s}" % (name, none_or(n))


def record(name):
    return json.loads((root / "studies" / (name + ".json")).read_text())


# Words that a claim takes from another than the last that can be understood alone.
meant = {("survey", 9): "symmetric", ("random_problems", 6): "it loses at most half a digit",
         ("random_problems", 14): "what compare names is within half a digit more often"}


def leans_on(study, texts, n):
    """The last claim before the n-th that can be understood alone, in brackets; "" if the n-th can."""
    if (study, n) in meant:
        return "[" + meant[study, n] + "] "
    leaning = r"(and|nor|so|it|its|than|there|the same|at twice|with the (delta|constant)|likewise|otherwise|that) "
    first = next(m for m in range(n, 0, -1) if m == 1 or not re.match(leaning, texts[m - 1]))
    return "" if first == n else "[" + texts[first - 1] + "] "


def verdicts():
    full = record("verdicts-full")
    claims = [(study, n, text, verdict) for study in full
              for n, (text, verdict) in enumerate(full[study].items(), 1)]
    for verdict in ("holds", "fails", "undecided"):
        yield r"\newcommand{\%sone}{%d}" % (verdict, sum(v == verdict for _, _, _, v in claims))
        for study in full:
            yield defined("%s@%s" % (verdict, study), sum(v == verdict for v in full[study].values()))
    for study in full:
        yield defined("of@" + study, len(full[study]))
    yield r"\newcommand{\recordedclaims}{%d}" % len(claims)
    yield r"\newcommand{\recordedstudies}{%d}" % len(full)
    failing = ""
    for study, n, text, verdict in claims:
        lean = leans_on(study, list(full[study]), n)
        yield defined("leans@%s@%d" % (study, n), tex(lean))
        yield defined("recorded@%s@%d" % (study, n), verdict)
        if verdict == "fails":
            failing += r"\failure{%s}{%d}{%s}" % (tex(study), n, tex(lean + text)) + "\n"
    yield r"\newcommand{\failing}{%s}" % failing


# The studies of each message of the paper; any other is under the last heading.
messages = (("an error of the gain", "gain_error gain_error_size gain_error_definiteness mixed_gain blocks"),
            ("basis", "joseph_basis backward_error choose"),
            ("drift", "delta_forms distinct_rows sqrt_lambda_bias accuracy_steps fused_symmetry"),
            ("a state in 16 bits", "test_time_layer"),
            ("map and survey", "winner_map survey random_problems everyday_problems"),
            ("half-power law and certificate", "half_power prior_any certificate"), ("other studies", ""))


def registered(kind, band):
    """A finding whose band was set before a run, as its origin says. What was mended after it stays a prediction."""
    before, after = band.find("before"), band.find("after")
    return kind == "finding" and before >= 0 and (after < 0 or before < after)


def narrowly(kind, band):
    """As docs/questions.md counts: without what was derived beforehand, and what names anything after."""
    return registered(kind, band) and "after" not in band and re.search(r"before\b", band) is not None


def probabilities(study, texts):
    """The probability that a claim's author gave to "holds": the last number of its braces in the study's source."""
    texts_of = (s.read_text() for s in sorted((root / "studies").glob("*/*.cpp")))
    source = re.sub(r'"\s*\n\s*"', "", next((s for s in texts_of if '.name = "%s"' % study in s), ""))
    for text in texts:
        at, depth, within = source.find('{"' + text.replace('"', '\\"') + '"'), 0, False
        for here in range(at, len(source) if at >= 0 else at):
            within ^= source[here] == '"' and source[here - 1] != "\\"
            depth += 0 if within else {"{": 1, "}": -1}.get(source[here], 0)
            if depth == 0:
                given = re.search(r",\s*([01]?\.?\d+)\s*$", source[at:here])
                if given:
                    yield text, float(given.group(1))
                break


def score(claims):
    """Rows of the table of predictions: verdicts on record at the full budget, seed 1, and those of this run.

    claims: (study, kind, text, band, verdict of the run)."""
    full = record("verdicts-full")
    named_so = {study: name for name, studies in messages for study in studies.split()}
    rows, totals = {name: ([], []) for name, _ in messages}, ([], [])
    for study, kind, text, band, verdict in claims:
        if registered(kind, band):
            for of in (rows[named_so.get(study, messages[-1][0])], totals):
                of[0].append((full[study][text], verdict))
    given = {}
    for study, its in full.items():
        given[study] = [(p - (its[t] == "holds")) ** 2 for t, p in probabilities(study, its) if its[t] != "undecided"]
        for of in (rows[named_so.get(study, messages[-1][0])], totals):
            of[1].extend(given[study])
    text = ""
    for name, (judged, squares) in list(rows.items()) + [("all", totals)]:
        count = lambda place, verdict: sum(v[place] == verdict for v in judged)
        brier = "%.3f (%d)" % (sum(squares) / len(squares), len(squares)) if squares else "--"
        text += (r"\midrule " if name == "all" else "") + " & ".join(
            [name, str(len(judged))] + [str(count(0, v)) for v in ("holds", "fails", "undecided")] + [brier] +
            [str(count(1, v)) for v in ("holds", "fails", "undecided")]) + r"\\" + "\n"
    yield r"\newcommand{\score}{%s}" % text
    share = round(100 * sum(v == "holds" for v, _ in totals[0]) / max(1, len(totals[0])))
    yield r"\newcommand{\scoreshare}{%d}" % share
    for name, verdict in (("held", "holds"), ("failed", "fails"), ("undecided", "undecided")):
        yield r"\newcommand{\registered%s}{%d}" % (name, sum(v == verdict for v, _ in totals[0]))
    yield r"\newcommand{\registeredall}{%d}" % len(totals[0])
    narrow = [full[study][text] for study, kind, text, band, _ in claims if narrowly(kind, band)]
    yield r"\newcommand{\narrowall}{%d}" % len(narrow)
    for name, verdict in (("held", "holds"), ("failed", "fails"), ("undecided", "undecided")):
        yield r"\newcommand{\narrow%s}{%d}" % (name, narrow.count(verdict))
    yield r"\newcommand{\narrowrest}{%d}" % (len(totals[0]) - len(narrow))
    for study, squares in given.items():
        if squares:
            yield defined("brier@" + study, "%.3f" % (sum(squares) / len(squares)))


def counts():
    """What \\counted and \\brier name is on record."""
    full = record("verdicts-full")
    for study, verdict in named("counted", 2):
        if study not in full or verdict not in ("holds", "fails", "undecided", "of"):
            faults.append("no count of %s in %s on record" % (verdict, study))
    for (study,) in named("brier", 1):
        if not any(full[study][text] != "undecided" for text, _ in probabilities(study, full.get(study, {}))):
            faults.append("%s: no claim with a probability is decided" % study)


def digest(lines):
    return hashlib.sha256(("\n".join(lines) + "\n").encode()).hexdigest()


def survey():
    used = sum(line.rstrip().endswith(",used") for line in (root / "studies/data/survey/records.csv").open())
    yield r"\newcommand{\recordsused}{%d}" % used
    yield r"\newcommand{\recordssurveyed}{%d}" % len(range(0, used, 3))


def of_run(out, to):
    """The run's claims as `rlslab list claims` prints them, their hash, and how many bands were set before."""
    run = json.loads((out / "verdicts.json").read_text())
    claims = [(study["name"], n, c) for study in run["studies"] for n, c in enumerate(study["claims"], 1)]
    of_list = {(study, n, text) for study, its in record("verdicts-full").items() for n, text in enumerate(its, 1)}
    other = sorted(of_list ^ {(study, n, c["claim"]) for study, n, c in claims})
    counted = sum(map(int, re.findall(r"rls@count@\w+@\w+\\endcsname\{(\d+)\}", (out / "numbers.tex").read_text())))
    if other or counted != len(claims):
        sys.exit("%s: a run of other claims than those on record: %d listed, %d counted, %d on record%s"
                 % (out, len(claims), counted, len(of_list), "; first " + str(other[0]) if other else ""))
    lines = ["\t".join((s, str(n), *(c.get(k, "") for k in ("kind", "claim", "band", "data", "proof"))))
             for s, n, c in claims]
    (to / "claims.txt").write_text("\n".join(lines) + "\n")
    yield r"\newcommand{\claimslisted}{%d}" % len(claims)
    yield r"\newcommand{\claimshash}{%s}" % digest(lines)
    yield r"\newcommand{\expectederrors}{%s}" % run["expected_errors"]
    bands = [c["band"] for _, _, c in claims if c["kind"] == "finding"]
    yield r"\newcommand{\bandsall}{%d}" % len(bands)
    yield r"\newcommand{\bandsother}{%d}" % (len(bands) - sum(registered("finding", b) for b in bands))
    yield from score([(study, c["kind"], c["claim"], c.get("band", ""), c["verdict"]) for study, _, c in claims])


def figures(out):
    """Each figure: of the tree, or of the run."""
    for (name,) in named("plot", 1):
        ours = root / "docs" / (name + ".svg")
        yield str(ours if ours.exists() else out / "figures" / (name + ".svg"))


def main():
    if not checks and len(sys.argv) != 3:
        sys.exit(__doc__)
    quotations()
    counts()
    text = [line for part in (cells, rows, costs, machine, sources, verdicts, survey) for line in part()]
    for fault in dict.fromkeys(faults):
        print(fault, file=sys.stderr)
    if faults or checks:
        sys.exit(1 if faults else 0)
    out, to = map(pathlib.Path, sys.argv[1:])
    text += list(of_run(out, to))
    (to / "recorded.tex").write_text("\n".join(text) + "\n")
    (to / "figures.txt").write_text("".join(figure + "\n" for figure in figures(out)))


if __name__ == "__main__":
    main()
