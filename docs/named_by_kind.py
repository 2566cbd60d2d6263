#!/usr/bin/env python3
"""The tables of "How often is `compare` right?" in docs/questions.md, from the table that study everyday_problems or
study random_problems leaves.

docs/named_by_kind.py out/everyday_problems.csv [MORE.csv ...]
"""

import csv
import sys
from math import sqrt


def rows_of(path):
    with open(path) as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def share(hits, of):
    """A percentage with Wilson's interval of 95 %."""
    if of == 0:
        return "–"
    z, p = 1.96, hits / of
    middle, half = p + z * z / (2 * of), z * sqrt(p * (1 - p) / of + z * z / (4 * of * of))
    low, high = ((middle + sign * half) / (1 + z * z / of) for sign in (-1, 1))
    return f"{100 * p:.1f} [{100 * low:.1f}, {100 * high:.1f}]"


rows = [row for path in sys.argv[1:] for row in rows_of(path) if row["word"] in ("float", "double")]
judged = [row for row in rows if row["judged"] == "1"]


def everyday():
    """By kind: how often a form is named, why not, and what is within half a digit on another record."""
    print("| kind | problems | names one, % | not: why | judged | half a digit, % | one digit, % |"
          " `gentleman` always, % | `ud_delta` always, % | `ud` always, % |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    kinds = sorted({row["kind"] for row in rows})
    parts = [(kind, lambda r, k=kind: r["kind"] == k) for kind in kinds]
    parts += [(word, lambda r, w=word: r["word"] == w) for word in ("float", "double")]
    parts += [("lambda = 1", lambda r: r["lambda"] == "1"), ("lambda < 1", lambda r: r["lambda"] != "1"),
              ("prior proposed", lambda r: r["prior"] == "proposed"), ("prior given", lambda r: r["prior"] == "given"),
              ("all", lambda r: True)]
    for name, of in parts:
        drawn = [row for row in rows if row["evidence"] == "itself" and of(row)]
        other = [row for row in judged if row["evidence"] == "other" and of(row)]
        whys = [row["why"] for row in drawn if row["why"] != "named"]
        why = ", ".join(f"{w} {whys.count(w)}" for w in sorted(set(whys), key=lambda w: -whys.count(w)))
        named = share(sum(row["named"] != "none" for row in drawn), len(drawn))
        cells = [share(sum(float(row[column]) < most + 0.01 for row in other), len(other))
                 for column, most in (("loss", 0.5), ("loss", 1), ("gentleman", 0.5), ("ud_delta", 0.5), ("ud", 0.5))]
        print(f"| {name} | {len(drawn)} | {named} | {why or '–'} | {len(other)} | " + " | ".join(cells) + " |")
    draws = [int(float(row["draws"])) for row in rows if row["evidence"] == "itself"]
    print("\ndraws: " + ", ".join(f"{n} in {draws.count(n)}" for n in sorted(set(draws))))


def within(column, evidence, most, of=lambda row: True):
    chosen = [float(row[column]) for row in judged if row["evidence"] == evidence and of(row)]
    return share(sum(loss < most + 0.01 for loss in chosen), len(chosen)), len(chosen)


def drawn_at_random():
    print("| judged by | problems | half a digit, % | half a digit of the least loss, % | one digit, % |"
          " `ud` always, % | `ud_delta` always, % |")
    print("|---|---|---|---|---|---|---|")
    for evidence in ("itself", "again", "half", "other"):
        cells = [within(column, evidence, most)
                 for column, most in (("loss", 0.5), ("excess", 0.5), ("loss", 1), ("ud", 0.5), ("ud_delta", 0.5))]
        print(f"| {evidence} | {cells[0][1]} | " + " | ".join(text for text, _ in cells) + " |")

    kinds = [("float", lambda r: r["word"] == "float"), ("double", lambda r: r["word"] == "double")]
    for name, bounds in (("d", (1, 3, 8, 33)), ("N", (2, 32, 256, 2001)), ("kappa", (1, 1e2, 1e4, 1e8)),
                         ("lambda", (0.9, 0.99, 0.999, 1, 1.1)), ("noise", (0, 1e-6, 1e-3, 1, 10))):
        for low, high in zip(bounds, bounds[1:]):
            label = {(1, 1.1): "lambda = 1", (0, 1e-6): "no noise"}.get((low, high), f"{name} from {low:g} to {high:g}")
            kinds.append((label, lambda r, n=name, a=low, b=high: a <= float(r[n]) < b))
    for name in ("regressors", "theta", "prior"):
        for value in sorted({row[name] for row in rows}):
            kinds.append((f"{name}: {value}", lambda r, n=name, v=value: r[n] == v))
    kinds += [("offset", lambda r: float(r["offset"]) > 0), ("no offset", lambda r: float(r["offset"]) == 0)]

    print("\n| kind | names one, % | judged | another record: half a digit, % | `ud_delta` always, % |")
    print("|---|---|---|---|---|")
    for name, of in kinds:
        drawn = [row for row in rows if row["evidence"] == "itself" and of(row)]
        named = share(sum(row["judged"] == "1" for row in drawn), len(drawn))
        text, count = within("loss", "other", 0.5, of)
        print(f"| {name} | {named} | {count} | {text} | {within('ud_delta', 'other', 0.5, of)[0]} |")


(everyday if "kind" in rows[0] else drawn_at_random)()
forms = {}
for row in judged:
    if row["evidence"] == "itself":
        forms[row["named"]] = forms.get(row["named"], 0) + 1
print("\n" + ", ".join(f"`{form}` {count}" for form, count in sorted(forms.items(), key=lambda f: -f[1])))
