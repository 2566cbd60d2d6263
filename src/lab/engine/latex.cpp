// LaTeX of tables and numbers: verdicts as a paper quotes them.
#include <rlslab/studies/latex.hpp>

#include "src/lab/report/revision.hpp"
#include <rlslab/studies/verdicts.hpp>

#include <fmt/format.h>
#include <sstream>

namespace rlslab::studies {
using namespace report;
namespace {

/// Signs, each with its LaTeX behind it.
std::vector<std::pair<std::string, std::string>> const& signs() {
    static auto const list = [] {
        std::vector<std::pair<std::string, std::string>> out;
        std::istringstream left(R"(
        & \&  % \%  $ \$  # \#  _ \_\allowbreak{}  { \{  } \}  ~ \textasciitilde{}  ^ \textasciicircum{}
        \ \textbackslash{}  < $<$  > $>$  | $|$  " ''  ± $\pm$  × $\times$  · $\cdot$  √ $\surd$  ² $^2$  ³ $^3$
        ≤ $\le$  ≥ $\ge$  ≈ $\approx$  − $-$  – --  … \ldots{}  ∞ $\infty$  Δ $\Delta$  α $\alpha$  β $\beta$
        γ $\gamma$  δ $\delta$  ε $\varepsilon$  η $\eta$  θ $\theta$  κ $\kappa$  λ $\lambda$  σ $\sigma$
        φ $\varphi$  ψ $\psi$)");
        for (std::string sign, set; left >> sign >> set;) out.emplace_back(sign, set);
        return out;
    }();
    return list;
}

std::string head(RunOptions const& options) {
    return fmt::format("% rlslab {}, {} budget, seed {}\n", revision, name_of(options.budget), options.seed);
}

}  // namespace

std::string latex(std::string_view text) {
    std::string out;
    while (!text.empty()) {
        bool found = false;
        for (auto const& [sign, set] : signs())
            if (text.starts_with(sign)) {
                out += set;
                text.remove_prefix(sign.size());
                found = true;
                break;
            }
        if (found) continue;
        out += text.front();
        text.remove_prefix(1);
    }
    return out;
}

std::string table_tex(Outcome const& outcome, RunOptions const& options) {
    std::string out = head(options) + "% needs \\usepackage{booktabs,longtable}\n";
    out += "\\begin{longtable}{p{0.45\\linewidth}p{0.37\\linewidth}l}\n";
    out += fmt::format("\\caption{{\\texttt{{{}}}: {}}}\\\\\n", latex(outcome.study->name),
                       latex(outcome.study->question));
    out += "\\toprule\nclaim & measured & verdict\\\\\n\\midrule\\endhead\n";
    for (size_t i = 0; i < outcome.judgements.size(); ++i) {
        Claim const& claim = outcome.study->claims[i];
        out += fmt::format("{} (\\emph{{{}}}) & {} & {}\\\\\n", latex(claim.text), name_of(claim.basis.kind),
                           latex(outcome.judgements[i].measured), name_of(outcome.judgements[i].verdict));
    }
    for (size_t i = 0; i < outcome.numbers.size(); ++i)
        out +=
            fmt::format("{} & {} & not judged\\\\\n", latex(outcome.study->claims[i].text), latex(outcome.numbers[i]));
    return out + "\\bottomrule\n\\end{longtable}\n";
}

std::string numbers_tex(std::vector<Outcome> const& outcomes, RunOptions const& options) {
    std::string out = head(options);
    out +=
        "\\makeatletter\n"
        "\\newcommand{\\measured}[3]{\\@ifundefined{rls@#1@#2}"
        "{\\textbf{??}\\typeout{missing: #1, claim #2}}{\\csname rls@#1@#2\\endcsname}}\n"
        "\\newcommand{\\verdict}[3]{\\@ifundefined{rls@#1@#2}{\\textbf{??}}{\\csname rls@v@#1@#2\\endcsname}}\n"
        "\\newcommand{\\claimed}[3]{\\@ifundefined{rls@#1@#2}{\\textbf{??}}{\\csname rls@c@#1@#2\\endcsname}}\n"
        "\\newcommand{\\runcount}[2]{\\csname rls@count@#1@#2\\endcsname}\n";
    out += fmt::format(
        "\\newcommand{{\\runbudget}}{{{}}}\n\\newcommand{{\\runseed}}{{{}}}\n\\newcommand{{\\runrevision}}{{{}}}\n",
        name_of(options.budget), options.seed, latex(revision));
    out += fmt::format("\\newcommand{{\\runstudies}}{{{}}}\n", outcomes.size());
    auto const counts = counted(outcomes);
    for (Kind const kind : {Kind::verification, Kind::reproduction, Kind::own_result}) {
        Count const& c = counts[size_t(kind)];
        auto const define = [&](char const* what, size_t n) {
            out += fmt::format("\\expandafter\\def\\csname rls@count@{}@{}\\endcsname{{{}}}\n", name_of(kind), what, n);
        };
        define("hold", c.holds);
        define("fail", c.fails);
        define("undecided", c.undecided);
    }
    for (Outcome const& outcome : outcomes)
        for (size_t i = 0; i < outcome.judgements.size(); ++i)
            out += fmt::format(
                "\\expandafter\\def\\csname rls@{0}@{1}\\endcsname{{{2}}}\n"
                "\\expandafter\\def\\csname rls@v@{0}@{1}\\endcsname{{{3}}}\n"
                "\\expandafter\\def\\csname rls@c@{0}@{1}\\endcsname{{{4}}}\n",
                outcome.study->name, i + 1, latex(outcome.judgements[i].measured),
                name_of(outcome.judgements[i].verdict), latex(outcome.study->claims[i].text));
    return out + "\\makeatother\n";
}

}  // namespace rlslab::studies
