#!/usr/bin/python3
"""Lays out the records of the survey (README.md has the rules): FOLDER/RECORD.csv each, regressors and then y, and
FOLDER/records.csv, the list.   lay_out.py FOLDER"""
import csv, fractions, importlib, math, pathlib, pkgutil, subprocess, sys

import sklearn, sklearn.datasets, statsmodels, statsmodels.datasets

here = pathlib.Path(__file__).resolve().parent
most_rows, most_regressors = 200, 8
# What their documentation says of them.
made = {"datasets.anscombe", "datasets.randu", "MASS.synth.te", "MASS.synth.tr", "cluster.ruspini", "cluster.xclara"}
parts = {"datasets.stack.x": "datasets.stackloss", "datasets.freeny.x": "datasets.freeny"}


def number(text):
    try:
        x = float(text)
        return text if math.isfinite(x) else None
    except ValueError:
        return None


def tables():
    """Each data set: package, version, name, kind, licence, title, column names, columns of decimals (None: missing).
    The last column is the response."""
    for set_ in ("longley", "filip"):
        rows = list(csv.reader(open(here.parent / "nist" / f"{set_}.csv")))
        columns = [list(map(number, c)) for c in zip(*rows[1:])]
        yield "NIST", "StRD", set_, "model", "public domain", f"NIST StRD {set_}", rows[0][1:], columns[1:]
    try:
        subprocess.run(["Rscript", here / "tables.R", folder], check=True)
    except FileNotFoundError:
        sys.exit("lay_out.py: no Rscript: expected Debian's r-base-core")
    for line in open(folder / "raw" / "names.tsv", encoding="utf-8"):
        package, version, name, kind, licence, title = line.rstrip("\n").split("\t")
        rows = list(csv.reader(open(folder / "raw" / f"{package}.{name}.csv", encoding="utf-8", errors="replace")))
        columns = [list(map(number, c)) for c in zip(*rows[1:])] if len(rows[0]) > 0 else []
        licence = licence.replace("Part of R 4.2.2", "GPL-2 | GPL-3")
        yield package, version, name, kind, licence, title, rows[0], columns
    for module in sorted(m.name for m in pkgutil.iter_modules(statsmodels.datasets.__path__) if m.ispkg):
        if module == "tests":
            continue
        set_ = importlib.import_module(f"statsmodels.datasets.{module}")
        data = set_.load_pandas()
        x = data.data
        y = getattr(data, "endog_name", None)
        y = y if isinstance(y, str) else None
        numeric = [c for c in x.columns if x[c].dtype.kind in "if" and c != y] + ([y] if y in x.columns else [])
        columns = [[number(repr(float(v))) for v in x[c]] for c in numeric]
        licence = " ".join(set_.COPYRIGHT.split()).split(". ")[0].rstrip(".").replace(",", ";")
        if len(licence) < 10:
            licence = "not stated"
        if "ublic domain" in licence:
            licence = "public domain"
        title = set_.TITLE.strip().split("\n")[0].replace(",", " ")
        one = len(numeric) == 1 or module in ("sunspots", "nile")
        if one:
            numeric, columns = numeric[-1:], columns[-1:]
        kind = "series" if one else "table"
        yield "statsmodels", statsmodels.__version__, module, kind, licence, title, list(map(str, numeric)), columns
    for name in ("iris", "wine", "breast_cancer", "diabetes", "linnerud", "digits"):
        data = getattr(sklearn.datasets, f"load_{name}")()
        target = data.target if data.target.ndim == 1 else data.target[:, -1]
        columns = [[number(repr(float(v))) for v in c] for c in list(data.data.T) + [target]]
        names = list(map(str, data.feature_names)) + ["target"]
        yield "scikit-learn", sklearn.__version__, name, "table", "BSD-3-Clause", name, names, columns


def regression(kind, names, columns):
    """Names and columns of regressors and response, without the intercept."""
    if kind != "series":
        few = [i for i, c in enumerate(columns) if c.count(None) <= len(c) / 5]
        names, columns = [names[i] for i in few], [columns[i] for i in few]
        most = most_regressors if kind == "table" else len(names)
        keep = [i for i in range(len(names) - 1)][:most] + [len(names) - 1] * bool(names)
        names, columns = [names[i] for i in keep], [columns[i] for i in keep]
    else:                                       # of two lags of the last series, and of the first where there are more
        y, u = columns[-1], columns[0]
        lagged = [(names[-1], y)] + ([(names[0], u)] if len(names) > 1 else [])
        names = [f"{n}[k-{i}]" for n, _ in lagged for i in (1, 2)] + [names[-1]]
        columns = [c[2 - i:len(c) - i] for _, c in lagged for i in (1, 2)] + [y[2:]]
    rows = [r for r in zip(*columns) if None not in r][:most_rows]
    return names, [list(c) for c in zip(*rows)] if rows else [[] for _ in names]


def independent(columns):
    """Places of the columns that are not, as decimals, exactly combinations of a constant and of columns before."""
    n = len(columns[0])
    basis, out = [], []
    for j, c in enumerate([["1"] * n] + columns):
        v = [fractions.Fraction(x) for x in c]
        for pivot, b in basis:
            if v[pivot]:
                f = v[pivot] / b[pivot]
                v = [x - f * y for x, y in zip(v, b)]
        pivot = next((i for i, x in enumerate(v) if x), None)
        if pivot is not None:
            basis.append((pivot, v))
            if j > 0:
                out.append(j - 1)
    return out


def marks(columns):
    """The first 16 values of each column that has four values or more, relative to the largest, in four digits; not of
    columns that count."""
    out = set()
    for c in columns:
        x = [float(v) for v in c[:16]]
        steps = {round(b - a, 9) for a, b in zip(x, x[1:])}
        if len(steps) > 2 and len(set(x)) > 3:
            largest = max(map(abs, x))
            out.add(tuple(round(v / largest, 4) for v in x))
    return out


folder = pathlib.Path(sys.argv[1])
folder.mkdir(parents=True, exist_ok=True)
lines, known = [], []
for package, version, name, kind, licence, title, names, columns in tables():
    record = f"{package}.{name}".replace("-", "_")
    all_rows = len(columns[0]) if columns else 0
    status, y, dropped = "used", "", []
    if record in made:
        status = "left out: made up"
    elif record in parts:
        status = f"left out: a part of {parts[record]}"
    elif kind != "series" and len(columns) < 2:
        status = "left out: fewer than two numeric columns"
    else:
        names, columns = regression(kind, names, columns)
        if len(names) < 2 or len(columns[0]) < 6:
            status = "left out: too few rows or columns without missing values"
    if status == "used":
        keep = independent(columns)
        last = len(columns) - 1
        if last not in keep:
            status = "left out: y is a combination of the regressors"
        elif len(keep) < 2:
            status = "left out: no regressor is left"
        else:
            dropped = [names[i] for i in range(last) if i not in keep]
            names, columns = [names[i] for i in keep], [columns[i] for i in keep]
            if len(columns[0]) < 2 * len(columns) + 2:
                status = "left out: fewer than 2 d + 2 rows"
    if status == "used":
        mine = marks(columns)
        for other, theirs in known:
            if mine and theirs and 2 * len(mine & theirs) > min(len(mine), len(theirs)):
                status = f"the same data as {other}"
                break
    if status == "used":
        known.append((record, mine))
        with open(folder / f"{record}.csv", "w", encoding="utf-8") as out:
            out.write(",".join(["one"] + [f"x{i}" for i in range(1, len(columns))] + ["y"]) + "\n")
            out.writelines("1," + ",".join(r) + "\n" for r in zip(*columns))
    used = status == "used"
    lines.append([record, package, version, name, kind, names[-1] if names else "",
                  ";".join(n.replace(",", " ") for n in names[:-1]) if used else "", ";".join(dropped), all_rows,
                  len(columns[0]) if used else 0, len(columns) if used else 0, licence, title, status])
with open(folder / "records.csv", "w", encoding="utf-8", newline="") as out:
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow("record,package,version,data set,kind,response,regressors,dependent,source rows,rows,parameters,"
                    "licence,title,status".split(","))
    writer.writerows(lines)
used = sum(line[-1] == "used" for line in lines)
print(f"{used} records of {len(lines)} data sets in {folder}")
