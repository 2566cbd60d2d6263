// Verdicts: said, counted, recorded, and as LaTeX.
#include <rlslab/studies/verdicts.hpp>

#include "src/lab/report/json.hpp"
#include <rlslab/input/text.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <sstream>

namespace rlslab::studies {
using namespace report;

extern char const* const recorded_quick;  // of the generated file
extern char const* const recorded_full;

std::string_view name_of(Kind kind) {
    constexpr std::array<std::string_view, 3> names{"verification", "reproduction", "finding"};
    return names[size_t(kind)];
}
std::string_view name_of(Verdict verdict) {
    constexpr std::array<std::string_view, 3> names{"fails", "undecided", "holds"};
    return names[size_t(verdict)];
}
std::string const& data_of(Study const& study, Claim const& claim) {
    return claim.basis.data.empty() ? study.data : claim.basis.data;
}

namespace {

template <class F>
void for_each_claim(std::span<Outcome const> outcomes, F f) {
    for (Outcome const& outcome : outcomes)
        for (size_t i = 0; i < outcome.judgements.size(); ++i)
            f(*outcome.study, outcome.study->claims[i], outcome.judgements[i]);
}
Json json_of(Count const& c) { return object("hold fail undecided", {c.holds, c.fails, c.undecided}); }

}  // namespace

std::array<Count, 3> counted(std::span<Outcome const> outcomes) {
    std::array<Count, 3> out;
    for_each_claim(outcomes, [&](Study const&, Claim const& claim, Judgement const& f) {
        Count& count = out[size_t(claim.basis.kind)];
        ++(f.holds() ? count.holds : f.verdict == Verdict::fails ? count.fails : count.undecided);
    });
    return out;
}

std::string count_lines(std::span<Outcome const> outcomes) {
    auto const [verified, reproduced, found] = counted(outcomes);
    auto const line = [](std::string_view what, Count const& c) {
        return fmt::format("{:<11} {:>3}: {} hold, {} fail, {} undecided\n", what, c.claims(), c.holds, c.fails,
                           c.undecided);
    };
    return line("verified", verified) + line("reproduced", reproduced) + line("found", found);
}

double expected_errors(std::vector<Outcome> const& outcomes) {
    double sum = 0;
    for_each_claim(outcomes, [&](Study const&, Claim const&, Judgement const& f) { sum += f.risk; });
    return sum;
}

std::string verdict_lines(Outcome const& outcome, bool colour, size_t width) {
    auto const painted = [&](std::string_view text, int code) {
        return colour ? fmt::format("\033[{}m{}\033[0m", code, text) : std::string(text);
    };
    std::string out = fmt::format("{}  {}\n", painted(outcome.study->name, 1), outcome.study->question);
    if (!outcome.changed.empty()) out += fmt::format("  not judged: factors changed: {}\n", outcome.changed);
    for (size_t i = 0; i < outcome.numbers.size(); ++i) {
        Claim const& claim = outcome.study->claims[i];
        out += fmt::format("  not judged {:<12}  {}\n", name_of(claim.basis.kind),
                           wrapped(claim.text + ": " + outcome.numbers[i], 27, 13, width));
    }
    std::vector<size_t> order(outcome.judgements.size());
    std::iota(order.begin(), order.end(), size_t(0));
    std::ranges::stable_sort(order, {}, [&](size_t i) { return outcome.judgements[i].verdict; });
    double squares = 0;
    int judged = 0;
    for (size_t i : order) {
        Judgement const& judgement = outcome.judgements[i];
        Claim const& claim = outcome.study->claims[i];
        std::string const verdict = judgement.verdict == Verdict::fails ? painted("FAILS    ", 31)
                                    : judgement.holds()                 ? painted("holds    ", 32)
                                                                        : painted("undecided", 33);
        std::string const said = fmt::format(
            "{}{}: {}{}", claim.text, claim.probability < 0 ? "" : fmt::format(" (probability {})", claim.probability),
            judgement.measured, claim.basis.proof.empty() ? "" : "; proof: " + claim.basis.proof);
        if (claim.probability >= 0 && judgement.verdict != Verdict::undecided) {
            double const miss = claim.probability - judgement.holds();
            squares += miss * miss, ++judged;
        }
        out += fmt::format("  {}  {:<12}  {}\n", verdict, name_of(claim.basis.kind), wrapped(said, 27, 13, width));
    }
    if (judged > 0)  // of probabilities of 1/2: 0.25
        out += fmt::format("  Brier score of {} probabilities: {:.3f}\n", judged, squares / judged);
    return out;
}

std::string verdicts_json(std::vector<Outcome> const& outcomes, RunOptions const& options) {
    auto const [verified, reproduced, found] = counted(outcomes);
    Json out = {
        {"version", RLSLAB_VERSION},         {"revision", revision},
        {"budget", name_of(options.budget)}, {"seed", options.seed},
        {"verification", json_of(verified)}, {"reproduction", json_of(reproduced)},
        {"finding", json_of(found)},         {"expected_errors", std::round(1000 * expected_errors(outcomes)) / 1000},
        {"studies", Json::array()}};
    for (Outcome const& outcome : outcomes) {
        Json claims = Json::array();
        for (size_t i = 0; i < outcome.judgements.size(); ++i) {
            Claim const& claim = outcome.study->claims[i];
            claims.push_back(
                object("claim kind band data proof verdict measured",
                       {claim.text, name_of(claim.basis.kind), claim.basis.band, data_of(*outcome.study, claim),
                        claim.basis.proof, name_of(outcome.judgements[i].verdict), outcome.judgements[i].measured}));
        }
        for (size_t i = 0; i < outcome.numbers.size(); ++i)
            claims.push_back(object("claim kind verdict measured",
                                    {outcome.study->claims[i].text, name_of(outcome.study->claims[i].basis.kind),
                                     "not judged: factors changed", outcome.numbers[i]}));
        out["studies"].push_back(object("name question source holds claims",
                                        {outcome.study->name, outcome.study->question, outcome.study->source,
                                         outcome.changed.empty() ? Json(outcome.holds()) : Json(), claims}));
        if (!outcome.changed.empty()) out["studies"].back()["changed"] = outcome.changed;
    }
    out["run"] = Json::parse(as_json(run_of(outcomes, options)));
    return out.dump(2) + '\n';
}

std::string verdicts_csv(std::vector<Outcome> const& outcomes) {
    std::string out = "study,kind,hold,fail,undecided\n";
    for (Outcome const& outcome : outcomes) {
        auto const counts = counted({&outcome, 1});
        for (Kind const kind : {Kind::verification, Kind::reproduction, Kind::own_result})
            if (Count const& c = counts[size_t(kind)]; c.claims() > 0)
                out +=
                    fmt::format("{},{},{},{},{}\n", outcome.study->name, name_of(kind), c.holds, c.fails, c.undecided);
    }
    return out;
}

Record record_from(std::string const& json) {
    Record out;
    try {
        Json all = Json::parse(json);
        if (all.contains("studies") && all["studies"].is_array()) {  // what a run leaves: out/verdicts.json
            Json as_record = Json::object();
            for (Json const& study : all["studies"])
                for (Json const& claim : study.at("claims"))
                    as_record[study.at("name").get<std::string>()][claim.at("claim").get<std::string>()] =
                        claim.at("verdict");
            all = as_record;
        }
        for (auto const& [study, claims] : all.items())
            for (auto const& [claim, verdict] : claims.items()) {
                std::string const& said = verdict.get_ref<std::string const&>();
                Verdict& at = out[study][claim];
                if (said == "holds") at = Verdict::holds;
                else if (said == "fails") at = Verdict::fails;
                else if (said == "undecided") at = Verdict::undecided;
                else refuse("a record of verdicts: expected holds, fails or undecided, found \"{}\"", printable(said));
            }
    } catch (nlohmann::json::exception const&) {
        refuse("a record of verdicts: expected verdicts.json of a run");
    }
    return out;
}

Record const& recorded(Budget budget) {
    static Record const quick = record_from(recorded_quick), full = record_from(recorded_full);
    return budget == Budget::quick ? quick : full;
}

std::string record_json(std::vector<Outcome> const& outcomes, Record const& old) {
    Json out = Json::object();
    for (Study const* study : studies::studies()) {
        auto const run = std::ranges::find(outcomes, study, &Outcome::study);
        Json claims = Json::object();
        for (size_t i = 0; i < study->claims.size(); ++i) {
            std::string const& text = study->claims[i].text;
            if (run != outcomes.end()) claims[text] = name_of(run->judgements[i].verdict);
            else if (old.contains(study->name) && old.at(study->name).contains(text))
                claims[text] = name_of(old.at(study->name).at(text));
        }
        if (!claims.empty()) out[study->name] = claims;
    }
    return out.dump(1) + '\n';
}

std::vector<std::string> changes(std::vector<Outcome> const& outcomes, Record const& record) {
    std::vector<std::string> out;
    for_each_claim(outcomes, [&](Study const& study, Claim const& claim, Judgement const& f) {
        auto const known = record.find(study.name);
        if (known == record.end()) return;
        auto const was = known->second.find(claim.text);
        if (was != known->second.end() && was->second != f.verdict)
            out.push_back(fmt::format("{}: {}: {}, {} in the record", study.name, claim.text, name_of(f.verdict),
                                      name_of(was->second)));
    });
    return out;
}

std::vector<std::string> unrecorded(std::vector<Outcome> const& outcomes, Record const& record) {
    std::vector<std::string> out;
    for (Outcome const& outcome : outcomes) {
        std::string const& name = outcome.study->name;
        auto const known = record.find(name);
        std::map<std::string, Verdict> left;
        if (known != record.end()) left = known->second;
        for (Claim const& claim : outcome.study->claims)
            if (left.erase(claim.text) == 0) out.push_back(fmt::format("{}: {}: not in the record", name, claim.text));
        for (auto const& [text, verdict] : left)
            out.push_back(fmt::format("{}: {}: in the record, no longer claimed", name, text));
    }
    return out;
}

std::vector<std::string> failed_verifications(std::vector<Outcome> const& outcomes) {
    std::vector<std::string> out;
    for_each_claim(outcomes, [&](Study const& study, Claim const& claim, Judgement const& f) {
        if (claim.basis.kind == Kind::verification && f.verdict == Verdict::fails)
            out.push_back(fmt::format("{}: {}: {}", study.name, claim.text, f.measured));
    });
    return out;
}

// --- in LaTeX, as a paper quotes them --------------------------------------------------------------------------------

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
