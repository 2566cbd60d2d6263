#!/usr/bin/env python3
"""The tables of docs/map.md from a table of the study winner_map: tables.py out/winner_map.csv

tables.py out/winner_map.csv --losses studies/maps/losses.csv
    writes the digits that each form loses in each cell of the base: the site's "Which variant?" reads them
"""
import csv
import statistics
import sys

FACTORS = ["regime", "size", "spectrum", "theta", "noise", "basis", "prior_exponent", "kappa_exponent"]
BASE = {"size": "4", "spectrum": "geometric", "theta": "generic", "noise": "0.001"}
LOST = float("inf")


def cells(path):
    """Factors of each cell, and for each form its median digits of theta, worst component and P; None: broken down in
    more than half of the runs."""
    runs = {}
    with open(path, encoding="utf-8") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        forms = [name[6:] for name in rows.fieldnames if name.startswith("theta_")]
        for row in rows:
            runs.setdefault(tuple(row[f] for f in FACTORS), []).append(row)
    for key, same in runs.items():
        kept = {}
        for form in forms:
            digits = [[float(r[m + form]) for r in same] for m in ("theta_", "worst_", "P_")]
            broken = sum(x != x for x in digits[2])
            kept[form] = None if 2 * broken > len(same) else [
                statistics.median(-LOST if x != x else x for x in of) for of in digits]
        yield dict(zip(FACTORS, key)), kept


def loss(form, kept, forms):
    if kept[form] is None:
        return LOST
    best = [max(kept[f][m] for f in forms if kept[f]) for m in range(3)]
    return max(0.0, *(b - own for b, own in zip(best, kept[form])))


def text(x, places=1):
    return "lost" if x == LOST else f"{x:.{places}f}"


def losses_by_form(table, forms):
    """Shares of cells and the largest loss, one row a form."""
    print("| form | broken down, % | 0.5 digits lost or more, % | 1 or more, % "
          "| largest loss of a cell where it is sound |")
    print("|---|---|---|---|---|")
    for form in forms:
        all_of = [(loss(form, kept, forms), at) for at, kept in table]
        sound = [x for x in all_of if x[0] < LOST]
        share = lambda least: round(100 * sum(x >= least for x, _ in all_of) / len(all_of))
        largest, at = max(sound, key=lambda x: x[0])
        where = f"{at['regime']}, {at['basis']}, c² = u^-{at['prior_exponent']}, κ = u^-{at['kappa_exponent']}"
        print(f"| `{form}` | {share(LOST)} | {share(0.5)} | {share(1)} | {largest:.1f} ({where}) |")


def losses_by_regime(table, forms, shown):
    """The median and the largest loss of some forms in each regime."""
    print("| regime | " + " | ".join(f"`{f}`" for f in shown) + " |")
    print("|---|" + "---|" * len(shown))
    for regime in dict.fromkeys(at["regime"] for at, _ in table):
        here = [kept for at, kept in table if at["regime"] == regime]
        row = []
        for form in shown:
            of = [loss(form, kept, forms) for kept in here]
            row.append(f"{text(statistics.median(of))}, {text(max(of))}")
        print(f"| {regime} | " + " | ".join(row) + " |")


def losses_by_prior(base, forms, basis):
    """The median loss of some forms at each prior, and how often symmetric loses."""
    print(f"| {basis}, $c^2$ | `symmetric`: median loss | half a digit or more, % | lost, % "
          "| `joseph`: median loss | `ud` | `ud_delta` |")
    print("|---|---|---|---|---|---|---|")
    for prior in dict.fromkeys(at["prior_exponent"] for at, _ in base):
        here = [kept for at, kept in base if at["basis"] == basis and at["prior_exponent"] == prior]
        of = {f: [loss(f, kept, forms) for kept in here] for f in ("symmetric", "joseph", "ud", "ud_delta")}
        share = lambda least: round(100 * sum(x >= least for x in of["symmetric"]) / len(here))
        row = [text(statistics.median(of["symmetric"])), str(share(0.5)), str(share(LOST))]
        row += [text(statistics.median(of[f])) for f in ("joseph", "ud", "ud_delta")]
        print(f"| u^-{prior} | " + " | ".join(row) + " |")


def joseph_against_symmetric(base):
    """What joseph keeps more than symmetric of P and of theta's worst component: median, least, greatest."""
    for basis in ("rotated", "units"):
        for prior in dict.fromkeys(at["prior_exponent"] for at, _ in base):
            more = [(kept["joseph"], kept["symmetric"]) for at, kept in base if at["basis"] == basis and
                    at["prior_exponent"] == prior and at["kappa_exponent"] != "0"]
            both = [(j[2] - s[2], j[1] - s[1]) for j, s in more if j and s]
            spread = lambda x: f"{statistics.median(x):.2f} [{min(x):.2f}, {max(x):.2f}]"
            print(f"{basis}, c² = u^-{prior}: P {spread([b[0] for b in both])}, "
                  f"worst {spread([b[1] for b in both])}; lost: joseph {sum(j is None for j, _ in more)}, "
                  f"symmetric {sum(s is None for _, s in more)} of {len(more)}")


def digits_in(everything, factor, value):
    """Digits of theta, worst component and P in float with a memory of 100 and the prior u^-1/2."""
    for at, kept in everything:
        if (at["regime"], at["prior_exponent"], at["kappa_exponent"]) == ("float memory 100", "0.5", "0.5") and \
                at[factor] == value and all(at[f] == v for f, v in BASE.items() if f != factor):
            of = {f: "lost" if kept[f] is None else "/".join(f"{x:.1f}" for x in kept[f]) for f in ("symmetric", "ud")}
            print(f"{factor} {value}, {at['basis']}, κ = u^-0.5: " + ", ".join(f"{f} {x}" for f, x in of.items()))


def write_losses(base, forms, path):
    """One row a cell: what the best of each measure keeps, then what each form loses."""
    where = [f for f in FACTORS if f not in BASE]
    with open(path, "w", encoding="utf-8") as file:
        print("# cells of docs/map.md: most digits kept of theta, of its worst component and of P; then for each\n"
              "# form the largest of what it lacks in the three, or lost: indefinite in more than half of 11 runs;\n"
              "# medians; by studies/maps/tables.py", file=file)
        print(",".join(where + ["theta", "worst", "P"] + forms), file=file)
        for at, kept in base:
            best = [max(kept[f][m] for f in forms if kept[f]) for m in range(3)]
            digits = best + [loss(f, kept, forms) for f in forms]
            print(",".join([at[f] for f in where] + [text(x, 2) for x in digits]), file=file)


def main():
    everything = list(cells(sys.argv[1]))
    base = [(at, kept) for at, kept in everything if all(at[f] == v for f, v in BASE.items())]
    forms = list(base[0][1])
    if sys.argv[2:3] == ["--losses"]:
        return write_losses(base, forms, sys.argv[3])
    plain = [f for f in forms if not f.endswith("_delta")]
    print(f"Base: {len(base)} cells of {len(everything)}. Losses to the best of {len(forms)}.\n")
    losses_by_form(base, forms)
    print("\nMedian, largest loss; to the best plain form.\n")
    losses_by_regime(base, plain, ["symmetric", "joseph", "ud", "carlson", "inverse_qr", "qr", "gentleman",
                                   "information"])
    for basis in ("rotated", "units"):
        print(f"\nLoss to the best of {len(forms)}.\n")
        losses_by_prior(base, forms, basis)
    print("\nJoseph's products against symmetric, kappa above 1.\n")
    joseph_against_symmetric(base)
    decides = [0, 0, 0]
    for _, kept in base:
        if kept["symmetric"] and loss("symmetric", kept, forms) >= 0.5:
            lacks = [max(kept[f][m] for f in forms if kept[f]) - kept["symmetric"][m] for m in range(3)]
            decides[lacks.index(max(lacks))] += 1
    print(f"\nWhat decides a loss of half a digit or more of symmetric: theta {decides[0]}, worst {decides[1]}, "
          f"P {decides[2]} cells")
    for form in ("ud", "ud_delta"):
        print(f"{form}: median loss {statistics.median(loss(form, k, forms) for _, k in base):.2f}, "
              f"largest over all {len(everything)} cells {max(loss(form, k, forms) for _, k in everything):.2f}")
    print("\nDigits of theta/worst/P.\n")
    for factor in ("theta", "noise"):
        for value in dict.fromkeys(at[factor] for at, _ in everything):
            digits_in(everything, factor, value)
    print("\nWhite rows, P0 = I: digits of P.\n")
    for at, kept in base:
        if at["kappa_exponent"] == "0" and at["prior_exponent"] == "0":
            print(f"{at['regime']}: " + ", ".join(f"{f} {kept[f][2]:.1f}" for f in
                                                  ("symmetric", "ud", "carlson", "inverse_qr", "ud_delta")))
    for factor in ("size", "spectrum", "theta", "noise"):
        print(f"\nBy {factor}, beside the base.\n")
        for value in dict.fromkeys(at[factor] for at, _ in everything):
            here = [kept for at, kept in everything if at[factor] == value and
                    all(at[f] == v for f, v in BASE.items() if f != factor) and at["regime"] == "float memory 100"]
            row = [f"{f} {text(statistics.median(loss(f, k, forms) for k in here))}, "
                   f"{text(max(loss(f, k, forms) for k in here))}" for f in ("symmetric", "ud", "ud_delta")]
            print(f"{factor} {value}: {len(here)} cells: " + "; ".join(row))


main()
