// The variants that the page runs, and its state.
#include "docs/site/live/page.hpp"

#include "docs/site/live/running.hpp"
#include "docs/site/live/source.hpp"

#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/information.hpp>
#include <rlslab/variants/inverse_qr.hpp>
#include <rlslab/variants/joseph.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <optional>

namespace rlslab::live {
namespace {

using T = VariablePrecision;
/// THE list of the page's variants.
using Shown = TypeList<Conventional<T>, Symmetric<T>, Joseph<T>, JosephRankTwo<T>, Potter<T>, Ud<T>, UdDelta<T>,
                       InverseQr<T>, Information<T>, Qr<T>>;
constexpr int variants = Shown::size, most_at_once = 128, in_measure = 1 + (variants + 1) * (1 + most_parameters);

struct Entry {
    char const* name;
    bool gain_error_applies;
    Running (*run)(Problem<T> const&, double gain_error, int guard, Seed);
};
Entry const* entries() {
    static std::array<Entry, variants> const all = [] {
        std::array<Entry, variants> out;
        size_t v = 0;
        for_each(Shown{}, [&]<class V>() { out[v++] = {V::name.data(), GainPerturbable<V>, &run<V>}; });
        return out;
    }();
    return all.data();
}

struct Page {
    Settings now = starting_settings();
    double values[std::size(settings)];
    std::string text, message;
    Table table;
    std::vector<size_t> inputs;  // of the next rows
    Rows rows;
    std::optional<Source> source;
    std::optional<Qr<Pair>> reference;
    Exact exact;
    std::array<std::optional<Running>, variants> running;
    double forgetting = 1, prior = 1;
    long taken = 0;
    double digits[variants][most_at_once];
    std::vector<double> measures;
    double summary[12], theta[2 * most_parameters];

    Page() {
        for (size_t i = 0; i < std::size(settings); ++i) values[i] = settings[i].start;
    }
    int refuse(std::string why) {
        message = std::move(why);
        return -1;
    }
    int start(std::uint32_t chosen) {
        source.reset();
        for (size_t i = 0; i < std::size(settings); ++i) {
            Setting const& s = settings[i];
            if (!(values[i] >= s.least && values[i] <= s.most))
                return refuse(std::string(s.name) + ": expected a number between the slider's ends");
            now.*s.number = values[i];
        }
        RunTimeFormat const format = format_of(now);
        if (!format.valid())
            return refuse(
                "expected double's exponents and rounding to nearest for more than 25 bits, and a range of "
                "exponents for other roundings");
        if (now.table != 0 && rows.rows() == 0) return refuse("expected a table");
        source.emplace(now, rows);
        PrecisionScope const scope(format);
        Problem<double> problem{.size = source->d(), .forgetting = nearest_in(format, now.forgetting)};
        problem.prior->variance = nearest_in(format, std::ldexp(1.0, int(now.prior)));
        forgetting = problem.forgetting, prior = problem.prior->variance;
        if (!std::isfinite(prior)) {
            source.reset();
            return refuse("expected a P0 within the range of exponents");
        }
        reference.emplace(problem.mapped<Pair>([](double x) { return Pair(x); }));
        for (int v = 0; v < variants; ++v) {
            running[size_t(v)].reset();
            if (chosen >> v & 1)
                running[size_t(v)] = entries()[v].run(problem.mapped<T>([](double x) { return T(x); }),
                                                      gain_error_of(now), int(now.guard), Seed{7});
        }
        taken = 0;
        measures.clear();
        return source->d();
    }
    int advance(int n) {
        measures.clear();
        if (!source) return 0;
        PrecisionScope const scope(format_of(now));
        int const d = source->d();
        long const every = std::max(1L, source->rows() / 40);
        double psi[most_parameters], y;
        int i = 0;
        for (; i < std::min(n, most_at_once) && source->next(psi, y); ++i) {
            ++taken;
            bool const measured = taken % every == 0 || taken == source->rows();
            Vector<Pair> exact_psi(d);
            for (int j = 0; j < d; ++j) exact_psi[j] = Pair(psi[j]);
            // What a guard is there for is skipped: then digits say what it missed.
            if (now.guard == 0 || !source->at_outlier()) reference->update(exact_psi, Pair(y));
            exact.theta = reference->theta();
            if (measured) exact.P = covariance_of_stored(reference->stored());
            for (size_t v = 0; v < variants; ++v) {
                digits[v][i] = std::numeric_limits<double>::quiet_NaN();
                if (!running[v]) continue;
                running[v]->update({psi, d}, y, exact, measured);
                digits[v][i] = running[v]->digits;
            }
            if (measured) measure(d);
        }
        return i;
    }
    void measure(int d) {
        measures.push_back(double(taken));
        auto const add = [&](double p_digits, std::array<double, most_parameters> const& spectrum) {
            measures.push_back(p_digits);
            measures.insert(measures.end(), spectrum.begin(), spectrum.end());
        };
        double const none = std::numeric_limits<double>::quiet_NaN();
        std::array<double, most_parameters> nothing;
        nothing.fill(none);
        for (auto const& r : running)
            if (r) add(r->covariance_digits, r->spectrum);
            else add(none, nothing);
        add(none, eigenvalues(exact.P, d));
    }
    double const* summarise(int v) {
        std::fill(std::begin(summary), std::end(summary), 0.0);
        summary[0] = double(taken);
        if (v < 0 || v >= variants || !running[size_t(v)]) return summary;
        Running const& r = *running[size_t(v)];
        double const all[] = {double(r.rows),
                              r.digits,
                              r.covariance_digits,
                              double(r.first_indefinite),
                              double(r.first_unsound),
                              double(r.counts.unusable),
                              double(r.counts.outliers),
                              double(r.counts.changes),
                              double(r.counts.windups),
                              double(r.counts.breakdowns),
                              double(r.hash & 0xffffffff),
                              double(r.hash >> 32)};
        std::copy(std::begin(all), std::end(all), summary);
        return summary;
    }
    double const* theta_of(int v) {
        std::fill(std::begin(theta), std::end(theta), 0.0);
        bool const is_reference = v == variants;
        for (int i = 0; source && taken > 0 && i < source->d(); ++i)
            if (is_reference) theta[i] = double(exact.theta[i]), theta[source->d() + i] = exact.theta[i].low();
            else if (v >= 0 && v < variants && running[size_t(v)]) theta[i] = running[size_t(v)]->theta[size_t(i)];
        return theta;
    }
};
Page& page() {
    static Page the;
    return the;
}

}  // namespace
}  // namespace rlslab::live

using rlslab::live::page;

int live_settings() { return int(std::size(rlslab::live::settings)); }
char const* live_setting_name(int i) { return rlslab::live::settings[i].name; }
double const* live_setting_range(int i) { return &rlslab::live::settings[i].least; }
int live_variants() { return rlslab::live::variants; }
char const* live_variant_name(int v) { return rlslab::live::entries()[v].name; }
int live_guards() { return int(std::size(rlslab::live::guards)); }
char const* live_guard_text(int i, int what) {
    rlslab::NamedPolicy const& guard = rlslab::live::guards[i];
    return (what == 0 ? guard.name : what == 1 ? guard.constant : guard.what).data();
}
int live_gain_error_applies(int v) { return rlslab::live::entries()[v].gain_error_applies; }

char* live_text(int n) {
    page().text.resize(size_t(n));
    return page().text.data();
}
int live_read_table(int n) {
    page().rows = {};
    page().inputs.clear();
    page().source.reset();
    page().table = rlslab::live::read_table(std::string_view(page().text).substr(0, size_t(n)));
    if (std::string const error = page().table.error; !error.empty()) {
        page().table = {};
        return page().refuse(error);
    }
    return int(page().table.columns.size());
}
int live_table_rows() { return int(page().table.rows()); }
char const* live_column_name(int j) { return page().table.columns[size_t(j)].name.c_str(); }
int live_column_missing(int j) {
    auto const& column = page().table.columns[size_t(j)];
    return column.not_a_number > 0 ? -1 : int(column.missing);
}
void live_add_input(int column) { page().inputs.push_back(size_t(column)); }
int live_make_rows(int output, int past, int delays, int constant) {
    rlslab::live::Model model{size_t(output), std::move(page().inputs), past, delays, constant != 0};
    page().inputs.clear();
    page().source.reset();
    page().rows = rows_of(page().table, model);
    if (page().rows.error.empty()) return page().rows.d();
    page().refuse(page().rows.error);
    page().rows = {};
    return -1;
}
int live_rows_made() { return int(page().rows.rows()); }
int live_rows_skipped() { return int(page().rows.skipped); }
char const* live_regressor_name(int i) { return page().rows.names[size_t(i)].c_str(); }
double const* live_made_row(int k) {
    auto const& rows = page().rows;
    size_t const d = size_t(rows.d());
    std::copy_n(rows.psi.begin() + std::ptrdiff_t(d * size_t(k)), d, page().theta);
    page().theta[d] = rows.y[size_t(k)];
    return page().theta;
}
double live_scale(int i) { return i < page().rows.d() ? page().rows.scales[size_t(i)] : page().rows.y_scale; }

double* live_values() { return page().values; }
int live_start(std::uint32_t chosen) { return page().start(chosen); }
char const* live_message() { return page().message.c_str(); }
double live_stored_forgetting() { return page().forgetting; }
double live_stored_prior() { return page().prior; }
int live_advance(int n) { return page().advance(n); }
double const* live_digits(int v) { return page().digits[v]; }
int live_measured() { return int(page().measures.size() / rlslab::live::in_measure); }
double const* live_measures() { return page().measures.data(); }
int live_parameters_most() { return rlslab::live::most_parameters; }
double const* live_summary(int v) { return page().summarise(v); }
double const* live_theta(int v) { return page().theta_of(v); }
