"""The reference: what headers, docstrings and rlslab.h say, as they stand."""
import ast
import re
import sys

from header import root

sys.path.insert(0, str(root / "docs"))
from type_tables import block, members, row, said    # noqa: E402

# A room of the library, and what of it is public (docs/library.md, "What is public").
rooms = [("core", "src/rlslab/core", "problem concept stored process random complex rounding records"),
         ("arithmetic", "src/rlslab/arithmetic", ""), ("adapt", "src/rlslab/adapt", ""),
         ("state", "src/rlslab/state", ""), ("many", "src/rlslab/many", ""), ("model", "src/rlslab/model", ""),
         ("reference", "src/rlslab/reference", ""), ("input", "src/rlslab/input", ""),
         ("catalogue", "src/catalogue", "catalogue any_filter composition composed native/filter"),
         ("studies", "src/lab/engine", "study_main study table judgements scenarios checkpoints")]


def without_details(text):
    """What is in namespace rlslab, and not in rlslab::detail."""
    while m := re.search(r"^namespace (?:detail|\w+::detail|) ?\{", text, re.M):
        begin, end = block(text, m.start())
        text = text[:m.start()] + text[end:]
    text = re.sub(r"^(namespace .*\{|\}  // namespace.*|#.*)$", "", text, flags=re.M)
    return text


def comment_text(lines):
    """A docstring: prose as prose, what is laid out by hand as it is laid out."""
    out = []
    for part in re.split(r"\n\s*\n", "\n".join(re.sub(r"^\s*/// ?", "", ln) for ln in lines)):
        laid_out = re.search(r"^  |\S {2,}\S|^\w+ +- ", part, re.M)
        prose = re.sub(r"([*_<\[$|`])", r"\\\1", part) if "`" not in part else re.sub(r"([*<\[$|])", r"\\\1", part)
        out.append(f"```text\n{part}\n```" if laid_out else prose.replace("\\<", "&lt;"))
    return "\n\n".join(out) + "\n"


def end_of(text):
    """Where a declaration ends: behind its semicolon, or at the brace that begins its body."""
    depth = 0
    for at, letter in enumerate(text):
        depth += (letter in "({") - (letter in ")}")
        if letter == ";" and depth == 0:
            return at + 1
        if letter == "{" and depth == 1 and not re.search(r"\bconcept\b|requires requires[^{]*$", text[:at]):
            return at
    return len(text)


def declared(header):
    """Of a header: (signature, docstring, body of a class) of what carries a docstring."""
    text = without_details(header)
    for m in re.finditer(r"((?:^///(?!<).*\n)+)(?!\n)", text, re.M):
        comment, rest = m[1].splitlines(), text[m.end():]
        kind = re.match(r"(?:(?!\n\n|^[}/]|;\n).)*?^(class|struct|enum class) \w+[^;{]*\{", rest, re.S | re.M)
        if kind:
            begin, end = block(rest, kind.end() - 1)
            code = rest[:begin].strip() if kind[1] != "enum class" else rest[:end]
            yield code, comment, None if kind[1] == "enum class" else (rest[begin + 1:end - 1], kind[1] == "class")
        elif not re.match(r"(template <.*>\s*)?(extern|friend|static_assert|class|struct)\b", rest):
            code = re.sub(r"(?<!:)//.*", "", rest[:end_of(rest)]).strip()
            if not code.startswith(("concept", "template")) or "concept" not in code:
                code = re.sub(r"\s+", " ", code)
            yield code.rstrip(";"), comment, None


def room_page(name, folder, chosen):
    files = [root / folder / f"{f}.hpp" for f in chosen.split()] or sorted((root / folder).glob("*.hpp"))
    prefix = {"src/catalogue": "rlslab/catalogue", "src/lab/engine": "rlslab/studies"}.get(folder, folder[4:])
    page = [f"# C++: {name}\n", "Signatures and docstrings as they stand in the headers. What a version promises: "
            "[what is public](../docs/library.md#what-is-public).\n"]
    for path in files:
        text = path.read_text()
        found = list(declared(text))
        if not found:
            continue
        inner = path.relative_to(root / folder)
        opening = re.match(r"(?:// .*\n)*", text)[0].replace("// ", "")
        page += [f"## `<{prefix}/{inner}>`\n", said(opening.splitlines()) + "\n"]
        for code, comment, body in found:
            page += [f"```cpp\n{code}\n```\n", comment_text(comment)]
            rows = [r for t, own, _ in members(*body) if (r := row(t, own))] if body else []
            if rows:
                cell = lambda c, d: f"`{c}{' = ' + d if d else ''}`".replace("|", "\\|")    # noqa: E731
                plain = lambda w: re.sub(r"([*$<])", r"\\\1", w).replace("\\<", "&lt;")     # noqa: E731
                page += ["| member | |", "|---|---|", *(f"| {cell(c, d)} | {plain(w)} |" for c, d, w in rows), ""]
    return "\n".join(page)


# Python: reStructuredText, which napoleon makes of the docstrings.

def indented(text, by="   "):
    return "\n".join(by + line if line else "" for line in text.splitlines())


def python_object(node, module, owner=""):
    """A class or function with its docstring; of a class what is public in it, too."""
    doc = ast.get_docstring(node)
    if node.name.startswith("_") or not doc:
        return ""
    words = [ast.unparse(d) for d in node.decorator_list]
    if "overload" in words or any(w.endswith(".setter") for w in words):
        return ""
    from sphinx.ext.napoleon import Config, NumpyDocstring
    text = str(NumpyDocstring(doc, Config(napoleon_use_rtype=False))).replace("|", r"\|")
    if isinstance(node, ast.ClassDef):
        inside = "\n".join(python_object(n, module, node.name) for n in node.body
                           if isinstance(n, (ast.FunctionDef, ast.ClassDef)))
        return f".. py:class:: {node.name}\n   :module: {module}\n\n{indented(text)}\n\n{indented(inside)}\n"
    kind = ("property" if any("property" in w for w in words) else "method") if owner else "function"
    arguments = re.sub(r"^(self|cls)(, )?", "", ast.unparse(node.args)) if owner else ast.unparse(node.args)
    head = f"{node.name}({arguments})" if kind != "property" else node.name
    return f".. py:{kind}:: {head}\n" + ("" if owner else f"   :module: {module}\n") + f"\n{indented(text)}\n"


def index_page(headers):
    rows = [f"| [`{h.name}`](../variants/{h.name}.md) | `rlslab::{h.type}{'' if h.sparse else '<T, N>'}` | "
            f"`<rlslab/variants/{h.name}.hpp>` |" for h in headers]
    return ("# C++: every header\n\nWhat carries a docstring, by room; the types that applications use most are also "
            "in [tables](types.md).\n\n## The variants\n\nA variant's class has the variant's name without "
            "underscores, each word with a capital: `ud_delta` is `rlslab::UdDelta<T, N>` in C++ (T: the scalar; N: "
            "the number of parameters, where it is known), `rlslab.UdDelta` in Python, `\"ud_delta\"` in C and on "
            "the command line (the sparse ones are in C++ and in the program alone). Its page has what it computes; "
            "all have the members of [the concept](core.md).\n\n"
            "| variant | class | header |\n|---|---|---|\n" + "\n".join(rows) + "\n")


def python_classes(headers):
    """A class for each dense variant, as bindings/python/classes.py makes them from the same headers."""
    title = "The variants"
    out = [title, "-" * len(title), "", "``ud_delta`` is ``rlslab.UdDelta``, or ``rlslab.filter(\"ud_delta\", size)``; "
           "in C++ it is ``rlslab::UdDelta``. So with each: the class is the variant's name without underscores, each "
           "word with a capital. ``rlslab.CLASSES`` has them by name.", ""]
    for h in headers:
        if not h.sparse:
            what = re.sub(r"([*`|])", r"\\\1", h.title)
            out += [f".. py:class:: {h.type}(size, **options)", "   :module: rlslab", "",
                    f"   ``{h.name}``. {what} `Formulas, cost, examples <../variants/{h.name}.html>`__", ""]
    return out


def python_page(headers):
    package = root / "bindings/python/rlslab"
    title = "Python: the reference"
    out = [title, "=" * len(title), "", "Docstrings as they stand. From the first import to a filter: "
           "`the Python page <../docs/python.html>`__. The class of each variant (``rlslab.Ud`` ...) takes the "
           "options of ``rlslab.Filter`` and has the formulas of `its page <../variants/index.html>`__ as its "
           "docstring.", "", *python_classes(headers)]
    for name, title in (("_filter", "Filters"), ("_stateful", "States and copies"), ("__init__", "By name"),
                        ("fleet", "Fleets"), ("outputs", "Several outputs"), ("_compare", "Compare"),
                        ("_certified", "Certified"), ("_identify", "Identify"), ("_studies", "Studies"),
                        ("results", "Statistics of a record"), ("sklearn", "scikit-learn"),
                        ("_classifier", "Classification for scikit-learn")):
        tree = ast.parse((package / f"{name}.py").read_text())
        module = "rlslab" if name.startswith("_") else f"rlslab.{name}"
        if name == "_classifier":
            module = "rlslab.sklearn"
        found = [python_object(n, module) for n in tree.body if isinstance(n, (ast.FunctionDef, ast.ClassDef))]
        if any(found):
            out += [title, "-" * len(title), "", *found]
    return "\n".join(out)


def c_page():
    header = (root / "bindings/c/rlslab.h").read_text()
    return ("# C: the header\n\nHow it is used, and what to do about errors: [the C page](../docs/c.md). "
            f"`rlslab.h` as it stands:\n\n```c\n{header}```\n")
