#!/usr/bin/env python3
"""The types, from the headers: a table for each public type, its fields with defaults or its members. The site shows
them as a page.

python3 docs/type_tables.py          prints it
python3 docs/type_tables.py --check  says which public type of adapt/ or many/ is in no list
"""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent

# A heading, and header: types; (): its functions. Those behind `left out` are parts of others, or concepts' helpers.
sections = [
    ("A problem, a row, a step", [("src/rlslab/core/problem.hpp", "Problem Prior Step Health Regressor")]),
    ("A guard", [("src/rlslab/adapt/guard.hpp", "Guarded"),
                 ("src/rlslab/adapt/guard_signal.hpp", "GuardSignal GuardCountsOf"),
                 ("src/rlslab/adapt/guard_policy.hpp", "GuardPolicy Action GuardOptions GuardedDigits")]),
    ("A window", [("src/rlslab/adapt/window.hpp", "Windowed WindowOptions")]),
    ("Rules of forgetting", [("src/rlslab/adapt/forgetting.hpp", "Forgetting ConstantForgetting Fortescue Kulhavy "
                              "CaoSchwartz RotatingRidge CovarianceReset RandomWalk")]),
    ("Other layers", [("src/rlslab/adapt/weighted.hpp", "Weighted"),
                      ("src/rlslab/adapt/outputs.hpp",
                       "MultiOutput MissingOutput UnusableRows"), ("src/rlslab/adapt/assessed.hpp",
                       "Assessed AssessedOptions Interval"),
                      ("src/rlslab/adapt/certified.hpp", "Certified Certificate"),
                      ("src/rlslab/adapt/excitation.hpp", "LeastExcited"),
                      ("src/rlslab/adapt/delay_line.hpp", "DelayLine"),
                      ("src/rlslab/adapt/around.hpp", "AroundFilter")]),
    ("Coloured noise", [("src/rlslab/adapt/extended_least_squares.hpp", "ExtendedLeastSquares"),
                        ("src/rlslab/adapt/instrumental_variables.hpp", "InstrumentalVariables")]),
    ("Fast forms of a delay line", [("variants/fast/fast_form.hpp", "FastProblem"),
                                    ("variants/fast/transversal.hpp", "Transversal"),
                                    ("variants/fast/stabilised_transversal.hpp", "StabilisedTransversal"),
                                    ("variants/fast/lattice.hpp", "Lattice"),
                                    ("variants/fast/error_feedback_lattice.hpp", "ErrorFeedbackLattice"),
                                    ("variants/fast/qr_lattice.hpp", "QrLattice")]),
    ("Many filters, many rows", [("src/rlslab/many/fleet.hpp", "Fleet"),
                                 ("src/rlslab/many/fleet_steps.hpp", "FleetSteps FleetCounts"),
                                 ("src/rlslab/many/output_fleet.hpp", "OutputFleet"),
                                 ("src/rlslab/many/rolled.hpp", "RollingOptions RollingRows Rolled"),
                                 ("src/rlslab/many/fold_all.hpp", "RowsInMemory"),
                                 ("src/rlslab/input/row_file.hpp", "RowFile")]),
    ("By name", [("src/catalogue/native/filter.hpp", "Options Step Filter Fleet Counts Certificate Removal "
                  "Excitation"),
                 ("src/catalogue/native/outputs.hpp", "Outputs")]),
    ("A study of your own", [("src/lab/engine/study.hpp", "Study Factor Trial TrialOutput Plot Guide Claim Basis Kind "
                              "Verdict Judgement ()"), ("src/lab/engine/table.hpp", "Table ()"),
                             ("src/lab/engine/judgements.hpp", "Estimate ()"),
                             ("src/lab/engine/scenarios.hpp", "()"), ("src/lab/engine/checkpoints.hpp", "()")]),
]
left_out = """
OneLane Beside MakesFilters RowRing RuleMemory NamedPolicy Removal Remainder RuleDefault RuleRange RuleNumber RecordSize
RecordWriting RecordReading FleetRecords LaneRows LaneRecord RowsFromTo MpiRanks Encoding FilterEach SharedFilter
OfOneRegressor NoProbes ProbeOf Probes OlderZ ProbedForm CovarianceTimes Meeting RootOf
RollingTask RollingPiece RollingPass RowTriangle RowTriangles
""".split()


def block(text, at):
    """From the brace at or behind `at` to the one that closes it."""
    begin = text.index("{", at)
    depth = 0
    for i in range(begin, len(text)):
        depth += {"{": 1, "}": -1}.get(text[i], 0)
        if depth == 0:
            return begin, i + 1
    raise ValueError("no closing brace")


def said(lines):
    """Comment lines as one cell."""
    return " ".join(re.sub(r"^\s*///<? ?", "", line).strip() for line in lines).replace("|", "\\|").strip()


def signature(text):
    text = re.sub(r"\[\[[^\]]*\]\]\s*", "", text)
    text = re.sub(r"\s+", " ", text).strip()
    text = re.sub(r"\) : .*$", ")", text)  # what a constructor initialises
    return text.strip().rstrip("{;").strip()


def members(body, is_class):
    """(signature or field, default, what it says) of the public members, in their order."""
    out, comment, public, i = [], [], not is_class, 0
    lines = body.split("\n")
    while i < len(lines):
        line = lines[i].strip()
        if re.match(r"(public|private|protected):$", line):
            public, comment = line == "public:", []
        elif line.startswith("///"):
            comment.append(line)
        elif not line or line.startswith("//") or line.startswith("#"):
            comment = []
        else:  # one member, to its end
            begin, depth = i, 0
            text = ""
            while True:
                code = re.sub(r"(?<!/)//(?!/).*$", "", lines[i])
                text += code + "\n"
                bare = re.sub(r"///<.*$", "", code)
                depth += bare.count("{") + bare.count("(") - bare.count("}") - bare.count(")")
                stripped = bare.strip()
                if depth == 0 and (stripped.endswith(";") or stripped.endswith("}") or stripped.endswith("},")):
                    break
                i += 1
            while i + 1 < len(lines) and lines[i + 1].strip().startswith("///<"):
                i += 1
                text += "\n" + lines[i]
            if public:
                out.append((text, comment, lines[begin:i + 1]))
            comment = []
        i += 1
    return out


def row(text, comment):
    behind = [line[line.index("///<"):] for line in text.split("\n") if "///<" in line]
    code = re.sub(r"///<.*", "", text)
    what = said(behind) or said(comment)
    code = re.sub(r"\s+", " ", code).strip()
    if re.match(r"(static constexpr|static auto|static std::array|using|friend|template <class> |enum|private|struct)",
                code) or code in (";", "};"):
        return None
    if "(" in code.split("=")[0].split("{")[0] and not code.startswith("std::function"):  # a function, or a constructor
        head = code
        if "{" in head:
            depth = 0
            for at, letter in enumerate(head):
                depth += letter == "("
                depth -= letter == ")"
                if letter == "{" and depth == 0 and not head[:at].rstrip().endswith("="):
                    head = head[:at]
                    break
        return signature(head), None, what
    field = re.match(r"(?P<type>.*?)\s*\b(?P<name>\w+)\s*(?:=\s*(?P<default>.*?)|(?P<braces>\{.*\}))?;$", code)
    if not field:
        return None
    default = (field["default"] or field["braces"] or "").strip()
    return f"{field['type']} {field['name']}", default, what


def grid(head, rows):
    """Rows of code, perhaps a default, and words."""
    code = lambda text: "`" + text.replace("|", "\\|") + "`" if text else ""
    columns = head.split(",")
    return ["| " + " | ".join(columns) + " |", "|---" * len(columns) + "|"] + [
        "| " + " | ".join([*map(code, row[:-1]), row[-1]]) + " |" for row in rows] + [""]


def included(header):
    """As it is included: the tree's folders by the names that they have where they are installed."""
    for where, at in {"src/rlslab/": "", "src/catalogue/": "catalogue/", "src/lab/engine/": "studies/",
                      "variants/fast/": "fast/"}.items():
        if header.startswith(where):
            return f"`<rlslab/{at}{header[len(where):]}>`"
    raise SystemExit(f"{header}: not installed")


def functions(header):
    source = (root / header).read_text()
    begin, end = block(source, source.index("\nnamespace "))
    rows = [r for text, own, _ in members(source[begin + 1:end - 1], False) if (r := row(text, own))]
    return [included(header), "", *grid("function,what it does", [(f, w) for f, d, w in rows if d is None])]


def table(header, name):
    if name == "()":
        return functions(header)
    source = (root / header).read_text()
    found = re.search(rf"^(?P<kind>struct|class|enum class) {name}\b[^;{{]*\{{", source, re.M)
    if not found:
        raise SystemExit(f"docs/type_tables.py: no {name} in {header}")
    above = source[:found.start()].rstrip("\n").split("\n")
    while above and not above[-1].startswith("///"):  # template <...> requires ...
        if re.match(r"$|}|\S.*;$", above.pop()):
            above = []
    comment = []
    while above and above[-1].startswith("///"):
        comment.insert(0, above.pop())
    begin, end = block(source, found.start())
    lines = [re.sub(r"^\s*/// ?", "", line) for line in comment]
    out = [f"### `{name}`", "", included(header), ""] + [f"{line}\n" for line in lines if len(lines) == 1]
    if len(lines) > 1:  # its formulas and lists as they are laid out
        out += ["```text", *lines, "```", ""]
    if found["kind"] == "enum class":
        names = re.sub(r"\s+", " ", re.sub(r"//.*", "", source[begin + 1:end - 1])).strip().rstrip(",")
        return out + ["Values: " + ", ".join(f"`{n.strip()}`" for n in names.split(",")) + ".", ""]
    rows = [r for text, own, _ in members(source[begin + 1:end - 1], found["kind"] == "class") if (r := row(text, own))]
    fields, members_ = [r for r in rows if r[1] is not None], [r for r in rows if r[1] is None]
    if fields:
        out += grid("field,default,meaning", fields)
    if members_:
        out += grid("member,what it does", [(f, w) for f, _, w in members_])
    return out


def made():
    out = ["# The types, from their headers", "",
           "What a header says stands here word for word (`docs/type_tables.py`). How they go together:",
           "[library.md](../docs/library.md). `T` is the filter's scalar, `F` a filter, d its number of parameters.",
           ""]
    for heading, headers in sections:
        out += [f"## {heading}", ""]
        for header, names in headers:
            for name in names.split():
                out += table(header, name)
    return "\n".join(out).rstrip("\n") + "\n"


def forgotten():
    listed = {name for _, headers in sections for _, names in headers for name in names.split()} | set(left_out)
    out = []
    for folder in ("adapt", "many"):
        for header in sorted((root / "src/rlslab" / folder).glob("*.hpp")):
            for name in re.findall(r"^(?:struct|class|enum class) (\w+)", header.read_text(), re.M):
                if name not in listed:
                    out.append(f"{header.name}: {name}")
    return out


if __name__ == "__main__":
    text = made()    # names a type that is listed and not there
    if sys.argv[1:] == ["--check"]:
        sys.exit("\n".join(f"docs/type_tables.py lists no {name}" for name in forgotten()) or 0)
    print(text, end="")
