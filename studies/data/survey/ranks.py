#!/usr/bin/env python3
"""The tables of docs/survey.md, from the table of the study:   ranks.py OUT/survey.csv
Intervals are percentiles, 2.5 % and 97.5 %, over 2000 resamples of the records (seed 1)."""
import collections, csv, functools, random, statistics, sys

forms = ("conventional conventional_two_sided symmetric joseph joseph_rank_two kalman information potter carlson ud "
         "inverse_qr qr gentleman extended_qr ud_delta carlson_delta inverse_qr_delta").split()
resamples = 2000


@functools.lru_cache
def drawn(n):
    """The resamples of n records, as places."""
    draws = random.Random(1)
    return [draws.choices(range(n), k=n) for _ in range(resamples)]


def percentiles(numbers, of):
    """Of a statistic of {record: number}: itself and its interval."""
    x = [numbers[record] for record in sorted(numbers)]
    values = sorted(of([x[i] for i in places]) for places in drawn(len(x)))
    return of(x), values[round(0.025 * resamples)], values[round(0.975 * resamples) - 1]


def mean(x):
    x = list(x)
    return sum(x) / len(x)


def ranks_of(losses):
    """Ranks from 1, equal losses share the mean of theirs."""
    ordered = sorted(losses.values())
    return {f: mean(i + 1 for i, x in enumerate(ordered) if x == loss) for f, loss in losses.items()}


def per_record(cells, number):
    """The mean over each record's cells of a number of a cell; None is left out."""
    out = collections.defaultdict(list)
    for key, cell in cells:
        x = number(cell)
        if x is not None:
            out[key[0]].append(x)
    return {record: mean(x) for record, x in out.items()}


def line(*cells):
    print("| " + " | ".join(map(str, cells)) + " |")


def heading(*cells):
    print()
    line(*cells)
    print("|" + "---|" * len(cells))


def interval(x, digits=1, scale=1):
    return "{:.{d}f} [{:.{d}f}, {:.{d}f}]".format(*(scale * v for v in x), d=digits)


# They overlap with others of the sample: found after the list was registered.
twice = {"lattice.environmental", "survival.jasa1", "MASS.mammals"}
rows = [r for r in csv.DictReader(x for x in open(sys.argv[1]) if not x.startswith("#")) if r["record"] not in twice]
cells = collections.defaultdict(dict)
for r in rows:
    cells[r["record"], r["units"], r["prior"], r["lambda"], r["word"]][r["variant"]] = r
priors = list(dict.fromkeys(r["prior"] for r in rows))
columns = [(w, p) for w in ("float", "double") for p in priors]
print(f"{len({r['record'] for r in rows})} records, {len(cells)} cells")


def where(word, prior=None, units=None):
    return [(k, c) for k, c in cells.items()
            if k[4] == word and prior in (None, k[2]) and units in (None, k[1])]


def loss(cell, form):
    return float(cell[form]["loss"])


print("\nMedian over records of a form's rank, each record's the mean over units and lambda:")
heading("form", *(f"{w}, {p}" for w, p in columns))
ranked = {at: [(k, ranks_of({f: loss(c, f) for f in forms})) for k, c in where(*at)] for at in columns}
for f in forms:
    line(f"`{f}`", *(interval(percentiles(per_record(ranked[at], lambda r: r[f]), statistics.median))
                     for at in columns))
print("\nShare of resamples in which the form has the least median rank (ties share it):")
for at in columns:
    of = {f: per_record(ranked[at], lambda r: r[f]) for f in forms}
    names, leads = sorted(of["ud"]), collections.Counter()
    for places in drawn(len(names)):
        medians = {f: statistics.median(of[f][names[i]] for i in places) for f in forms}
        best = [f for f in forms if medians[f] == min(medians.values())]
        for f in best:
            leads[f] += 1 / len(best)
    print(at, ", ".join(f"{f} {100 * n / resamples:.0f} %" for f, n in leads.most_common(4)))

print("\nMedian loss in digits over cells (inf: most cells broke down):")
heading("form", *(f"{w}, {p}" for w, p in columns))
for f in forms:
    line(f"`{f}`", *(f"{statistics.median(loss(c, f) for _, c in where(*at)):.1f}" for at in columns))

every = [(w, u) for w in ("bfloat16", "binary16", "float", "double") for u in ("natural", "scaled")]
print("\nPer cent of cells in which a form broke down:")
heading("form", *(f"{w}, {u}" for w, u in every))
for f in forms + ["all of them"]:
    def broke(c):
        return 100 * min(float(c[g]["broken"]) > 0 for g in (forms if f == "all of them" else [f]))
    line(f"`{f}`" if f in forms else f,
         *("{:.0f}".format(mean(broke(c) for _, c in where(w, units=u))) for w, u in every))
print("\nof these conventional by prior and lambda:")
heading("word", *(f"{p}, {x}" for p in priors for x in ("1", "0.99")))
for w in ("float", "double"):
    line(w, *("{:.0f}".format(mean(100 * (float(c["conventional"]["broken"]) > 0)
                                              for k, c in where(w, p) if k[3] == x))
              for p in priors for x in ("1", "0.99")))


def chosen(cell, by):
    return next((r for r in cell.values() if float(r[by]) == 1), None)


def within(most, pick):
    def of(cell):
        r = pick(cell)
        return None if r is None else float(float(r["loss"]) <= most)
    return of


print("\nPer cent of cells within so many digits of the best:")
heading("rule", "word", "cells", "0.5", "1", "broke down")
rules = [("the whole record names it", lambda c: chosen(c, "named")),
         ("the first half names it", lambda c: chosen(c, "named_by_half"))]
for f in ("ud", "ud_delta", "gentleman", "qr", "carlson", "inverse_qr", "symmetric", "conventional"):
    rules.append((f"`{f}` always, same cells as the first half",
                  lambda c, f=f: c[f] if chosen(c, "named_by_half") else None))
for name, pick in rules:
    for w in ("float", "double"):
        of = where(w)
        count = sum(pick(c) is not None for _, c in of)
        broken = mean(100 * (float(pick(c)["broken"]) > 0) for _, c in of if pick(c))
        line(name, w, count, *(interval(percentiles(per_record(of, within(m, pick)), mean), 0, 100)
                               for m in (0.5, 1)), f"{broken:.1f}")
print("\nForms that are named, per cent of the named cells:")
for w in ("float", "double"):
    for by in ("named", "named_by_half"):
        names = collections.Counter(r["variant"] for _, c in where(w) if (r := chosen(c, by)))
        total = sum(names.values())
        shares = ", ".join(f"{f} {100 * n / total:.0f}" for f, n in names.most_common())
        print(w, by, total, "of", len(where(w)), shares)
print("\nWorst misses of the first half:")
misses = sorted(((float(r["loss"]), k, r["variant"]) for w in ("float", "double") for k, c in where(w)
                 if (r := chosen(c, "named_by_half"))), reverse=True)
for lost, key, form in misses[:15]:
    print(f"{lost:.1f}", *key, form, "| ud", cells[key]["ud"]["loss"])
print("\nMisses of the whole record:")
misses = sorted(((float(r["loss"]), k, r["variant"]) for w in ("float", "double") for k, c in where(w)
                 if (r := chosen(c, "named"))), reverse=True)
for lost, key, form in misses[:10]:
    print(f"{lost:.1f}", *key, form)
