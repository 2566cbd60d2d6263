// Reads the table: losses to the best form, and the condition at which they reach half a digit.
#include "studies/maps/winner_map.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>
#include <map>

namespace rlslab::studies {
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
        MapRun middle = runs.front();
        for (size_t f = 0; f < middle.kept.size(); ++f)
            for (size_t m = 0; m < 3; ++m) {
                std::vector<double> digits;
                for (MapRun const& run : runs) digits.push_back(is_broken(run.kept[f]) ? -INFINITY : run.kept[f][m]);
                double const of_half = median(digits);
                middle.kept[f][m] = std::isinf(of_half) && of_half < 0 ? NAN : of_half;
            }
        out.push_back(std::move(middle));
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
