// Rows, filters and the certified solution of one cell; and the table read: losses to the best form, and the condition
// at which they reach half a digit.
#include "studies/maps/winner_map.hpp"

#include <rlslab/studies/spectra.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/variable_precision.hpp>
#include <rlslab/catalogue/breakdown.hpp>
#include <rlslab/catalogue/catalogue.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace rlslab::studies {
namespace {

constexpr int of_float = 24, of_double = 53;
// Four memories, or the rows of the name. u m^1.5 stays below 1/2: item 91.
constexpr MapRegime regimes[] = {
    {"11 bits memory 10", 11, 0.9, 40},           {"float memory 100", of_float, 0.99, 400},
    {"float 100 rows", of_float, 1, 100},         {"float memory 10000", of_float, 0.9999, 40000},
    {"11 bits memory 100", 11, 0.99, 400},        {"11 bits 100 rows", 11, 1, 100},
    {"16 bits memory 100", 16, 0.99, 400},        {"16 bits 1000 rows", 16, 1, 1000},
    {"float memory 1000", of_float, 0.999, 4000}, {"float 4096 rows", of_float, 1, 4096},
    {"double memory 100", of_double, 0.99, 400},  {"double memory 1000", of_double, 0.999, 4000},
    {"double 100 rows", of_double, 1, 100},       {"double 4096 rows", of_double, 1, 4096}};
constexpr size_t quick_regimes = 4;
constexpr double middle = 0.925;  // of the rows: where the errors are read, in the mean

Records rows_of(MapCell const& at, Index rows, Seed seed) {
    Index const d = Index(at.sigma.size());
    Matrix<double> V = orthonormal(d, d, seed);
    if (!at.rotated) V = Matrix<double>::Identity(d, d);
    Vector<double> theta(d), w(d);
    double squares = 0;
    for (double& x : theta) x = seed.bell(), squares += x * x;
    for (Index i = 0; i < d; ++i)
        theta[i] = at.theta == "v_1" ? V(i, 0) : at.theta == "v_d" ? V(i, d - 1) : theta[i] / std::sqrt(squares);
    Records out{.psi = Matrix<double>::Zero(d, rows), .y = Vector<double>(rows), .names = {}};
    for (Index k = 0; k < rows; ++k) {
        for (Index j = 0; j < d; ++j) w[j] = at.sigma[size_t(j)] * seed.bell();
        for (Index j = 0; j < d; ++j)
            for (Index i = 0; i < d; ++i) out.psi(i, k) += V(i, j) * w[j];
        double y = at.noise * seed.bell();
        for (Index i = 0; i < d; ++i) y += out.psi(i, k) * theta[i];
        out.y[k] = y;
    }
    return out;
}

/// Three decimals: a table of 600 000 numbers.
double rounded(double digits) { return std::round(digits * 1000) / 1000; }

}  // namespace

MapRegime const& map_regime(std::string_view name) { return *std::ranges::find(regimes, name, &MapRegime::name); }

std::vector<Cell> map_regimes(bool all) {
    std::vector<Cell> out;
    for (size_t i = 0; i < (all ? std::size(regimes) : quick_regimes); ++i)
        out.emplace_back(std::string(regimes[i].name));
    return out;
}

std::vector<std::string> const& plain_forms() {
    static std::vector<std::string> const forms = words(row_forms());
    return forms;
}
std::vector<std::string> const& all_forms() {
    static std::vector<std::string> const forms = [] {
        std::vector<std::string> out = plain_forms();
        out.insert(out.end(), {"ud_delta", "carlson_delta", "inverse_qr_delta"});
        return out;
    }();
    return forms;
}

MapCell map_cell(std::function<Cell const&(std::string_view)> const& value) {
    auto const number = [&](std::string_view name) { return std::get<double>(value(name)); };
    auto const text = [&](std::string_view name) { return std::get<std::string>(value(name)); };
    MapRegime const& r = map_regime(text("regime"));
    double const kappa = correctly::pow(2, r.bits * number("kappa_exponent")), size = number("size");
    return {.bits = r.bits,
            .lambda = round_to_bits(r.lambda, 0, r.bits),
            .rows = middle * double(r.rows),
            .c2 = correctly::pow(2, r.bits * number("prior_exponent")),
            .noise = number("noise"),
            .sigma = singular_values(text("spectrum"), Index(size), kappa),
            .rotated = text("basis") == "rotated",
            .theta = text("theta")};
}

std::vector<std::string> map_measures() {
    std::vector<std::string> out;
    for (std::string const& form : all_forms())
        for (char const* const of : {"theta_", "worst_", "P_"}) out.push_back(of + form);
    out.insert(out.end(), {"within", "foretold"});
    return out;
}

MapDigits const& MapRun::of(std::string_view form) const {
    return kept[size_t(std::ranges::find(all_forms(), form) - all_forms().begin())];
}

MapDigits MapRun::law(std::string_view form, Laws laws) const {
    MapLaw const law = law_of(form, at, laws);
    auto const digits = [&](double error) { return law.broken ? NAN : -correctly::log10(std::min(error, 1.0)); };
    return {digits(law.theta), digits(law.theta), digits(law.covariance)};
}

MapRun MapRun::foretold() const {
    MapRun out = *this;
    for (size_t i = 0; i < kept.size(); ++i) out.kept[i] = law(all_forms()[i]);
    return out;
}

double MapRun::loss(std::string_view form, std::vector<std::string> const& forms) const {
    MapDigits const& own = of(form);
    if (is_broken(own)) return INFINITY;
    double out = 0;
    for (std::string const& other : forms)
        if (MapDigits const& digits = of(other); !is_broken(digits))
            for (size_t m = 0; m < own.size(); ++m)
                if (digits[m] > own[m]) out = std::max(out, digits[m] - own[m]);
    return out;
}

double MapRun::loss_of_family(std::string_view family, std::vector<std::string> const& forms) const {
    double out = INFINITY;
    for (std::string const& form : forms)
        if (family_in_map(form) == family) out = std::min(out, loss(form, forms));
    return out;
}

std::string_view MapRun::winner(std::vector<std::string> const& forms) const {
    return family_in_map(*std::ranges::min_element(forms, {}, [&](std::string const& f) { return loss(f, forms); }));
}

std::string MapRun::letters() const {
    auto const is_within = [&](char const* family) { return loss_of_family(family, plain_forms()) <= 0.5; };
    std::string out;
    if (is_within("stored")) out += 'S';
    if (is_within("factor")) out += 'F';
    if (out.empty() && is_within("joseph")) out += 'J';
    if (out.empty() && is_within("information")) out += 'I';
    return out.empty() ? "none" : out;
}

bool is_broken(MapDigits const& digits) { return !(digits[0] == digits[0] && digits[2] == digits[2]); }

void measure_map(Trial const& trial, TrialOutput& out) {
    MapRegime const& regime = map_regime(trial.text("regime"));
    MapCell const at = map_cell([&](std::string_view name) -> Cell const& { return trial.value(name); });
    PrecisionScope const precision(regime.bits);
    auto const entry = [&](std::string const& form) -> CatalogueEntry const& {
        if (regime.bits == of_float) return trial.entry(form, "float");
        if (regime.bits == of_double) return trial.entry(form, "double");
        return *find_entry(variable_precision_catalogue(), form,
                           variable_precision_catalogue().front().arithmetic->name);
    };
    Arithmetic const& arithmetic = *entry("ud").arithmetic;
    Problem<double> const problem = as_stored(
        {.size = Index(at.sigma.size()), .forgetting = regime.lambda, .prior = Prior<double>{.variance = at.c2}},
        arithmetic);
    Records const records =
        as_stored(rows_of(at, regime.rows, trial.seed({"regime", "size", "replicate"})), arithmetic);
    std::vector<Index> steps;
    for (double const part : {0.85, 0.9, 0.95, 1.0})
        if (problem.size < 32 || part == 0.9) steps.push_back(Index(std::lround(part * double(regime.rows))));
    std::vector<CertifiedSolution> const exact = certified(problem, records, steps, 22);
    std::vector<Cell> row;
    MapRun run{.at = at};
    for (std::string const& form : all_forms()) {
        auto const filter = entry(form).make(problem, Seed{1});
        std::vector<double> theta, worst, P;
        bool broken = false;
        Index done = 0;
        auto const look = [&](Index next) {
            process_rows(*filter, records, done, next);
            done = next;
            broken |= breakdown(*filter, arithmetic) != Health::sound;
        };
        for (CertifiedSolution const& e : exact) {
            for (Index next = 1; next < e.step() && !broken; next *= 2)
                if (next > done) look(next);
            if (broken) break;
            look(e.step());
            theta.push_back(e.theta_digits(filter->theta()));
            worst.push_back(e.theta_digits_worst(filter->theta()));
            P.push_back(e.covariance_digits(filter->stored()));
        }
        auto const middle_of = [&](std::vector<double> const& digits) {
            return broken ? std::nan("") : rounded(median(digits));
        };
        run.kept.push_back({middle_of(theta), middle_of(worst), middle_of(P)});
        for (double const digits : run.kept.back()) row.emplace_back(digits);
    }
    row.emplace_back(run.letters());
    row.emplace_back(run.foretold().letters());
    out(row);
}

// --- reading the table -----------------------------------------------------------------------------------------------

namespace {

double log_kappa(MapRun const& run) { return -correctly::log10(run.at.sigma.back()); }

/// What the forms that store P lose more than the plain factors; at most 6.
double deficit(MapRun const& run) {
    double const P = run.loss_of_family("stored", plain_forms()), factors = run.loss_of_family("factor", plain_forms());
    return std::min(P, 6.0) - std::min(factors, 6.0);
}

/// Where the deficit first reaches half a digit along a line of runs of rising condition; interpolated. The first or
/// a step behind the last where that is outside.
double boundary(std::vector<MapRun> const& line) {
    constexpr double half = 0.5;
    for (size_t i = 0; i < line.size(); ++i) {
        double const now = deficit(line[i]);
        if (now < half) continue;
        if (i == 0) return log_kappa(line[0]);
        double const before = deficit(line[i - 1]), part = (half - before) / (now - before);
        return log_kappa(line[i - 1]) + part * (log_kappa(line[i]) - log_kappa(line[i - 1]));
    }
    return 2 * log_kappa(line.back()) - log_kappa(line[line.size() - 2]);
}

/// Of those for which it says anything.
double share(std::vector<MapRun> const& runs, std::function<std::optional<bool>(MapRun const&)> const& holds) {
    double hits = 0, all = 0;
    for (MapRun const& run : runs)
        if (std::optional<bool> const one = holds(run)) hits += *one, ++all;
    return hits / all;
}

}  // namespace

std::vector<MapRun> runs_of(Table const& t) {
    std::vector<MapRun> out;
    size_t const first = t.index(map_measures().front());
    for (std::vector<Cell> const& row : t.rows()) {
        auto const value = [&](std::string_view column) -> Cell const& { return row[t.index(column)]; };
        MapRun run{
            .at = map_cell(value), .line = {}, .exponent = std::get<double>(value("kappa_exponent")), .kept = {}};
        for (size_t i = 0; i < first; ++i)
            if (t.columns()[i] != "kappa_exponent" && t.columns()[i] != "replicate") run.line += as_text(row[i]) + ' ';
        for (size_t i = first; i + 2 < row.size(); i += 3)
            run.kept.push_back({std::get<double>(row[i]), std::get<double>(row[i + 1]), std::get<double>(row[i + 2])});
        out.push_back(std::move(run));
    }
    return out;
}

std::vector<MapRun> medians_of(Table const& t) {
    std::map<std::pair<std::string, double>, std::vector<MapRun>> cells;
    for (MapRun& run : runs_of(t)) cells[{run.line, run.exponent}].push_back(std::move(run));
    std::vector<MapRun> out;
    for (auto const& [name, runs] : cells) {
        MapRun cell = runs.front();
        for (size_t f = 0; f < cell.kept.size(); ++f)
            for (size_t m = 0; m < 3; ++m) {
                std::vector<double> digits;
                for (MapRun const& run : runs) digits.push_back(is_broken(run.kept[f]) ? -INFINITY : run.kept[f][m]);
                double const of_half = median(digits);
                cell.kept[f][m] = std::isinf(of_half) && of_half < 0 ? NAN : of_half;
            }
        out.push_back(std::move(cell));
    }
    return out;
}

Statistic of_runs(std::function<std::optional<bool>(MapRun const&)> holds) {
    return [=](Table const& t) { return share(runs_of(t), holds); };
}
Statistic of_cells(std::function<std::optional<bool>(MapRun const&)> holds) {
    return {[=](Table const& t) { return share(medians_of(t), holds); }, Estimate::fixed};
}

Statistic family_foretold(std::vector<std::string> const& forms) {
    return of_runs([=](MapRun const& run) -> std::optional<bool> {
        return run.loss_of_family(run.foretold().winner(forms), forms) <= 0.5;
    });
}

Statistic family_within(std::string family, std::vector<std::string> const& forms, double most) {
    return of_runs([=](MapRun const& run) -> std::optional<bool> { return run.loss_of_family(family, forms) <= most; });
}

Statistic loss_foretold(std::string form, double most) {
    return of_runs([=](MapRun const& run) -> std::optional<bool> {
        double const measured = run.loss(form, all_forms()), law = run.foretold().loss(form, all_forms());
        if (std::isinf(measured) || std::isinf(law)) return {};
        return std::abs(measured - law) <= most;
    });
}

Statistic boundaries_foretold(double most) {
    return [=](Table const& t) {
        std::map<std::string, std::vector<MapRun>> lines;
        for (MapRun& run : runs_of(t)) lines[run.line].push_back(std::move(run));
        double hits = 0, all = 0;
        for (auto& [name, line] : lines) {
            if (line.size() < 2) continue;
            std::ranges::sort(line, {}, &MapRun::exponent);
            std::vector<MapRun> foretold;
            for (MapRun const& run : line) foretold.push_back(run.foretold());
            double const measured = boundary(line), law = boundary(foretold), first = log_kappa(line.front()),
                         last = log_kappa(line.back());
            auto const inside = [&](double x) { return first < x && x <= last; };
            if (!inside(measured) && !inside(law)) continue;
            hits += std::abs(measured - law) <= most, ++all;
        }
        return hits / all;
    };
}

Statistic cells_lost(std::string form, std::vector<std::string> const& forms, double least_loss) {
    return of_cells([=](MapRun const& cell) -> std::optional<bool> { return cell.loss(form, forms) >= least_loss; });
}

Statistic largest_loss(std::string form, std::vector<std::string> const& forms) {
    return [=](Table const& t) {
        double out = 0;
        for (MapRun const& cell : medians_of(t)) out = std::max(out, cell.loss(form, forms));
        return out;
    };
}

}  // namespace rlslab::studies
