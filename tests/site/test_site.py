"""What the documentation site is made of, without Sphinx: formulas, links among the sources, numbers of the first
pages. With the name of the program as last word: also what is recorded of it."""
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

root = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(root / "docs/site"))
import api       # noqa: E402
import build     # noqa: E402
import check     # noqa: E402
import first_pages    # noqa: E402
import header    # noqa: E402
import pages     # noqa: E402

program = None


def plain(text):
    """A formula of a header as letters and signs alone; a sentence of it by its words."""
    return re.sub(r"[\s{}_]|[,;:.]$", "", re.sub(r"[,;:](?=\s|$)", "", text))


def back(latex):
    """LaTeX that header.py wrote, as the header has it."""
    latex = re.sub(r"\\text\{((?:[^{}])*)\}", lambda m: m[1].replace(r"\_", "_"), latex)
    while r"\sqrt{" in latex:
        at = latex.index(r"\sqrt{")
        depth, end = 0, at + 5
        while True:
            depth += (latex[end] == "{") - (latex[end] == "}")
            if depth == 0:
                break
            end += 1
        inside = latex[at + 6:end]
        latex = latex[:at] + f"sqrt({inside})" + latex[end + 1:]
    for written, sign in ((r"\mathrel{+}=", "+="), (r"\mathrel{-}=", "-="), (r"\le ", "<="), (r"\ge ", ">="),
                          (r"\to ", "->"), (r"\mp ", "-+"), (r"\dots", "..."), (r"\ast", "*"), (r"\quad", " "),
                          (r"\times", "x"), (r"\prod", "prod"), (r"\ ", " ")):
        latex = latex.replace(written, sign)
    powers = re.sub(r"\^\{([^}]*)\}", lambda m: f"^({m[1]})" if len(m[1]) > 3 else f"^{m[1]}", latex)
    return plain(powers.replace("\\", ""))


def differing(h):
    """Numbered formulas of a header whose LaTeX does not lead back to them. Drawn matrices: their cells, in order."""
    out = []
    for lines, made in zip(h.blocks, h.text()):
        if not lines[0].startswith("  "):
            continue
        latex = re.sub(r"\\(begin|end)\{\w+\}|\$\$|&|\\\\(?=\s)", " ", made)
        ours, theirs = back(latex), plain(" ".join(lines))
        if "bmatrix" in made:
            ours, theirs = (sorted(re.sub(r"[\[\]]", "", t)) for t in (ours, theirs))
        if ours != theirs:
            out.append((theirs, ours))
    return out


def said(*words):
    """What a command says on standard error."""
    return subprocess.run([str(w) for w in words], capture_output=True, text=True).stderr


class Formulas(unittest.TestCase):
    def test_they_are_those_that_were_read(self):
        self.assertEqual(said(sys.executable, root / "docs/site/header.py", "--check"), "")

    def test_each_leads_back_to_its_header(self):
        for h in header.variants():
            self.assertEqual(differing(h), [], h.name)

    def test_another_sign_or_letter_is_seen(self):
        h = next(h for h in header.variants() if h.name == "potter")
        text = h.text()
        for was, now in (("- v f'", "+ v f'"), ("lambda s", "lambda f"), ("S f", "S f'")):
            h.blocks = [[line.replace(was, now) for line in b] for b in h.blocks]
            self.assertNotEqual(h.text(), text)
            self.assertEqual(differing(h), [])

    def test_words_stay_words(self):
        self.assertEqual(header.sentences("A band of d numbers, as theta is: x_j = u b, for P (R theta = z)."),
                         "A band of $d$ numbers, as $\\theta$ is: $x_{j} = u b$, for $P$ ($R \\theta = z$).")
        self.assertEqual(header.latex(header.cut("sqrt(lambda)^B x_{i+1}' <= |K_j|^2, and for each")),
                         r"{\sqrt{\lambda}}^{B} x_{i+1}' \le | K_{j} |^{2},\ \text{and for each}")

    def test_a_row_wider_than_a_column_is_cut(self):
        self.assertEqual(header.fitting(r"x = 1: \quad y = 2,\quad z = 3", 15), [r"x = 1: \quad y = 2,\quad z = 3"])
        self.assertEqual(header.fitting(r"x = 1: \quad y = 2,\quad z = 3", 14), ["x = 1:", r"y = 2,\quad z = 3"])
        self.assertEqual(header.fitting(r"x = 1,\quad y = 2,\quad z = 3", 14), [r"x = 1,\quad y = 2,", "z = 3"])
        self.assertEqual(header.fitting(r"x = 1,\quad y = 2", 2), ["x = 1,", "y = 2"])


class Sources(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        try:
            import sphinx    # noqa: F401
        except ImportError:
            api.python_page = lambda headers: "\n".join(api.python_classes(headers))
        cls.site = build.Site(build.sources())

    def test_each_variant_and_study_has_its_page(self):
        listed = set(re.findall(r"<rlslab/variants/(\w+)\.hpp>", (root / "variants/variants.hpp").read_text()))
        self.assertEqual({h.name for h in header.variants()}, listed)
        for name in listed:
            self.assertIn(f"variants/{name}.md", self.site.texts)
        for study in pages.studies():
            self.assertIn(f"studies/{study['name']}.md", self.site.texts)
            for field in ("question", "source", "interpretation", "data"):
                self.assertTrue(study[field], f"{study['name']}: no {field}")

    def test_links_lead_to_pages_or_files(self):
        for name in self.site.texts:
            self.site.page(name)
        with self.assertRaises(SystemExit):
            self.site.target("docs/state.md", "nowhere.md")

    def test_no_line_of_prose_is_a_comment_a_break_or_a_target(self):
        read = build.without_comments
        self.assertEqual(read("on an M3 6\n  % fewer, `15,7\n%` more"), "on an M3 6 % fewer, `15,7 %` more")
        self.assertEqual(read("- % fewer\n\n+++\n\n(a)="), "- \\% fewer\n\n\\+++\n\n\\(a)=")
        self.assertEqual(read("```\n% a comment of the code\n```\n"), "```\n% a comment of the code\n```\n")
        for name in self.site.texts:
            prose = re.sub(r"^ *(`{3,}).*?^ *\1`*$", "", self.site.page(name), flags=re.M | re.S)
            self.assertEqual(re.findall(rf"^[ >]*(?:[-*] +)*{build.only_myst}.*", prose, re.M), [], name)

    def test_words_that_a_page_lost_are_found(self):
        source = "Six `is_it<T>` [of *them*](a.md#b) $x_1$\n% fewer\n\n```cpp\nint main() {}\n```\n\n1. &lt;T> <br>\n"
        page = ('<article><p>Six <code>is_it&lt;T&gt;</code> <a href="a.html">of <em>them</em></a> <math>x</math>{}</p>'
                "<pre><span>int</span> <span>main</span>() {{}}</pre><li>&lt;T></li></article>")
        self.assertEqual(check.lost(source, page.format("% fewer")), [])
        self.assertEqual(check.lost(source, page.format("")), ["fewer"])

    def test_each_page_is_reached(self):
        tree = "".join(t for t in self.site.texts.values() if "{toctree}" in t)
        for name in self.site.texts:
            stem = re.sub(r"\.(md|rst)$", "", name)
            places = (f"<{stem}>", f"\n{stem}\n", f"<{stem.split('/', 1)[-1]}>", f"<{stem.split('/')[-1]}>")
            self.assertTrue(stem == "index" or any(place in tree for place in places), name)

    def test_numbers_of_an_answer_are_among_those_behind_it(self):
        text = (root / "docs/site/pages/which.md").read_text()
        for answer, path, title in re.findall(r"((?:(?!\n\n).)+)\n\n\{\{said (\S+) \| (.*?)\}\}", text, re.S):
            behind = first_pages.paragraph(path, title)
            item = answer.split("\n- ")[-1]
            for number in re.findall(r"(?<![\w.$^_{])\d+(?:\.\d+)?(?![\w.]*\d)", item):
                self.assertRegex(behind, rf"(?<![\d.]){re.escape(number)}(?!\d)", f"{title}: {item}")

    def test_the_form_knows_the_map_that_the_tables_are_of(self):
        known = first_pages.lost_on_the_map()
        lost = [cell.split(",")[3:] for bases in known["lost"].values() for priors in bases.values()
                for kappas in priors.values() for cell in kappas.values()]
        text = (root / "docs/map.md").read_text()
        rows = re.findall(r"^\| `(\w+)` \| (\d+) \| (\d+) \| (\d+) \| ([\d.]+) \(", text, re.M)
        self.assertEqual([r[0] for r in rows], known["forms"])
        for form, *shares, largest in rows:
            of = [float("inf") if x == "lost" else float(x) for x in (c[known["forms"].index(form)] for c in lost)]
            for share, least in zip(shares, (float("inf"), 0.5, 1)):    # rounded twice: one may differ
                self.assertAlmostEqual(100 * sum(x >= least for x in of) / len(of), int(share), delta=1, msg=form)
            self.assertAlmostEqual(max(x for x in of if x < float("inf")), float(largest), delta=0.056, msg=form)

    def test_numbers_of_good_at_are_in_what_it_names(self):
        asked = {a: f"{short} {text}" for _, a, short, text in pages.questions()}
        names = {h.name for h in header.variants()}
        for name, said in pages.good_at().items():
            self.assertIn(name, names)
            self.assertEqual([p[:11] for p in said], ["**Good at**", "**Bad at** "], name)
            for paragraph in said:
                self.assertNotIn("{{", paragraph, "no such question")
                numbers = [n for n in re.findall(r"questions?\s(\d+)(?: and (\d+))?", paragraph) for n in n if n]
                anchors = [f"question-{n}" for n in numbers] + re.findall(r"questions\.md#([\w-]+)", paragraph)
                behind = [asked[a] for a in anchors]
                behind += [pages.read(f) for f in re.findall(r"\(\.\./(docs/(?!questions)\w+\.md)", paragraph)]
                own = re.sub(r"\[[^]]*\]\(.*?\)|questions?\s\d+(?: and \d+)?|\^\{.*?\}", "", paragraph)
                for number in re.findall(r"(?<![\w.$^_{])\d+(?:\.\d+)?(?![\w.]*\d)", own):
                    with self.subTest(name, number=number):
                        self.assertRegex(" ".join(behind), rf"(?<![\d.]){re.escape(number)}(?!\d)")

    def test_times_of_a_page_are_those_of_the_speed_page(self):
        times = pages.times()[1]
        for name, cells in re.findall(r"^\| `(\w+)`(?: \*)? \| ([\d |]+?) \| [>\d]", re.split(
                r"\n\n", pages.read("docs/speed.md"))[2], re.M):
            for d, time in zip((4, 8, 16, 32, 64, 128, 256), cells.split(" | ")):
                self.assertEqual(f"{times[name, 'double', d]:.0f}", time, f"{name}, {d}")

    def test_the_pages_of_python_and_headers_name_each_class(self):
        for h in header.variants():
            self.assertIn(f"`rlslab::{h.type}", self.site.texts["api/index.md"])
            self.assertEqual(f".. py:class:: {h.type}(" in self.site.texts["api/python.rst"], not h.sparse, h.name)

    def test_files_are_named_as_a_reader_of_the_site_knows_them(self):
        site = build.Site({"index.md": "A survey <docs/survey>\n", "docs/survey.md": "# Survey\n", "docs/theory.md": "",
                           "docs/questions.md": "", "docs/nist.md": "[survey.md](survey.md), `docs/survey.md`, [theory."
                           "md 16](theory.md#16), docs/theory.md 17 to\n19, docs/survey.md; questions 1 and 2",
                           "README.md": "[![a](docs/a.svg)](docs/survey.md), docs/survey.md"})
        of = "[{0}](theory.html#{0})".format
        self.assertEqual(site.page("docs/nist.md"), "[A survey](survey.html), `docs/survey.md`, "
                         f"{of(16).replace('[', '[theory ')}, theory {of(17)} to\n{of(19)}, [A survey](survey.html); "
                         "[questions 1](questions.html#question-1) and [2](questions.html#question-2)")
        self.assertEqual(site.page("README.md"), "[![a](docs/a.svg)](docs/survey.html), [A survey](docs/survey.html)")

    def test_a_long_paragraph_is_parted_between_sentences(self):
        text = " ".join(f"Sentence {n} has five words." for n in range(60))
        parts = pages.parted(text).split("\n\n")
        self.assertEqual(" ".join(parts), text)
        self.assertTrue(len(parts) > 3 and all(p.endswith("words.") and len(p.split()) <= 80 for p in parts))
        self.assertEqual(pages.parted(text[:500]), text[:500])

    def test_numbers_of_an_answer_in_short_are_behind_it(self):
        shorts = [(title, short, text) for title, _, short, text in pages.questions() if short]
        self.assertGreaterEqual(len(shorts), 11)
        for title, short, text in shorts:
            said = re.sub(r"\]\(.*?\)|\(\d\)|1/2|2d", "", short)
            for number in re.findall(r"(?<![\w.$^_{])\d+(?:\.\d+)?(?![\w.]*\d)", said):
                with self.subTest(title, number=number):
                    self.assertRegex(text, rf"(?<![\d.]){re.escape(number)}(?!\d)")
        page = self.site.page("docs/questions.md")
        self.assertNotIn(pages.numbers, page)
        self.assertEqual(page.count("<summary>The numbers</summary>"), len(shorts) + 1)    # and those of all

    def test_the_form_knows_what_was_measured_on_boards(self):
        known = {v["name"]: v["cost"] for v in json.loads(first_pages.choice(pages.Shared()))["variants"]}
        rows = re.findall(r"^\| `(\w+)<(\w+), (\d+)>` \| `-O2` \|(.*)\|$", pages.read("docs/embedded.md"), re.M)
        self.assertGreater(len(rows), 5)
        for kind, word, d, cells in rows:
            counts = [int(c) for c in cells.split("|")][2::2]
            name = re.sub(r"\B(?=[A-Z])", "_", kind).lower()
            self.assertEqual([known[name][b][word][d] for b in ("m3", "m4f", "m7")], counts)

    def test_places_and_links_of_the_sources_exist(self):
        texts = {p: p.read_text() for room in ("src", "variants", "studies", "tests", "docs", ".")
                 for p in (root / room).glob("*" if room == "." else "**/*") if p.suffix in (".cpp", ".hpp", ".md")}
        self.assertEqual(check.dead(root, texts), [])
        page = root / "docs/a.md"
        self.assertEqual([f.partition(": ")[2] for f in check.dead(root, {
            page: "docs/" + "theory.md 1, docs/" + "theory.md\n/// 999, [a](nowhere.hpp), [b](../README.md)"})],
            ["theory.md 999", "nowhere.hpp"])

    def test_no_formula_is_parted_by_what_begins_a_list(self):
        def parted(text):
            prose = re.sub(r"```[^`]*```|`[^`]*`|^    [^\n]*", "", text, flags=re.M)
            blocks = re.split(r"\n\s*\n|\n(?= *(?:[-+*>#|]|\d+[.)]) )", prose)
            return [b for b in blocks if b.replace("$$", "").count("$") % 2]
        for page in sorted((root / "docs").glob("*.md")):
            self.assertEqual(parted(page.read_text()), [], page.name)
        self.assertEqual(len(parted("It is $a\n- b$ at most, and $c$.")), 2)

    def test_a_dead_link_and_a_request_are_found(self):
        with tempfile.TemporaryDirectory() as folder:
            page = pathlib.Path(folder) / "a.html"
            page.write_text('<a href="b.html">b</a><a href="#c">c</a><script src="//d.example/e.js"></script>'
                            '<p id="f"></p><a href="#f">f</a>')
            faults, links, _ = check.site(pathlib.Path(folder))
        self.assertEqual([re.sub(".*?: ", "", f, count=1) for f in faults],
                         ["asks //d.example/e.js", "b.html: no such file", "#c: no such name there"])
        self.assertEqual(links, 3)


class Recorded(unittest.TestCase):
    def setUp(self):
        if not program:
            self.skipTest("no program named")

    def test_help_and_terminal_are_what_the_program_prints(self):
        self.assertEqual(said(sys.executable, root / "docs/site/recorded.py", program, "--check"), "")

    def test_factors_of_studies_are_the_programs(self):
        for study in pages.studies():
            refusal = said(program, "study", study["name"], "--set", "no factor=1")
            self.assertEqual(study["factors"], refusal.strip().split("its factors are ")[-1].split(", "))


if __name__ == "__main__":
    if len(sys.argv) > 1 and "/" in sys.argv[-1]:
        program = sys.argv.pop()
    unittest.main()
