// Each regressor is written to its column. If a value is missing, it contains a NaN and the next row overwrites it.
// Words with lags are read (lags.hpp).
#include <rlslab/model/regression.hpp>

#include <rlslab/model/lags.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace rlslab {
namespace {

[[noreturn]] void fail(std::string const& file, std::string const& message) {
    throw InputError(file.empty() ? message : file + ": " + message);
}

std::string counted(Index n, std::string_view what) { return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s"); }

void expect_rows(std::string const& file, Index size, Index rows) {
    if (rows < size)
        fail(file, fmt::format("{} need{} at least {}, found {}", counted(size, "parameter"), size == 1 ? "s" : "",
                               counted(size, "row"), rows));
}

/// The rows from `first` on of y = psi'theta. write(k, psi) writes the regressor of row k, with NaN for a missing
/// value. used_rows: unless null, the k of each row is appended to it.
template <class Write>
Records collected(std::string const& file, std::span<double const> y, std::vector<std::string> names, Index first,
                  std::vector<Index>* used_rows, Write const& write) {
    Index const size = Index(names.size()), rows = Index(y.size());
    expect_rows(file, size, rows);
    Index const most = std::max(Index(0), rows - first);
    Records records{.psi = Matrix<double>(size, most), .y = Vector<double>(most), .names = std::move(names)};
    Index used = 0;
    for (Index k = first; k < rows; ++k) {
        write(k, std::span(records.psi.col(used).data(), std::size_t(size)));
        records.y[used] = y[std::size_t(k)];
        if (records.psi.col(used).hasNaN() || std::isnan(records.y[used])) continue;
        if (used_rows) used_rows->push_back(k);
        ++used;
    }
    records.skipped = most - used;
    records.presample = rows - most;
    if (used < size) {
        std::string const history =
            records.presample > 0 ? fmt::format(" a presample of {} and", records.presample) : "";
        fail(file, fmt::format("{} need{} at least {}, found {} after{} skipping {} with missing values",
                               counted(size, "parameter"), size == 1 ? "s" : "", counted(size, "row"), used, history,
                               records.skipped));
    }
    if (used < most) {
        records.psi.conservativeResize(Eigen::NoChange, used);
        records.y.conservativeResize(used);
    }
    return records;
}

}  // namespace

Arx arx_of_order(int order) {
    if (order < 1) fail("", fmt::format("order: expected at least 1, found {}", order));
    return {.na = order, .nb = order};
}

Records linear_records(Columns const& data, std::vector<std::string> const& regressors, std::string const& output,
                       bool intercept) {
    if (regressors.empty()) fail(data.file, "expected the name of a regressor at least");
    std::vector<Lagged> now;
    for (auto const& name : regressors) {
        if (name == output) fail(data.file, fmt::format("column \"{}\" is both regressor and output", printable(name)));
        if (std::ranges::count(regressors, name) > 1)
            fail(data.file, fmt::format("column \"{}\" is twice among the regressors", printable(name)));
        now.push_back({name, 0, true});
    }
    return lagged_records(data, now, output, intercept);
}

Records lagged_records(Columns const& data, std::vector<Lagged> const& regressors, std::string const& output,
                       bool intercept, std::vector<Index>* used) {
    expects(!regressors.empty(), "at least one regressor");
    struct Source {
        double const* column;
        Index lag;
    };
    std::vector<std::string> names;
    if (intercept) names.push_back("1");
    std::vector<Source> sources;
    Index first = 0;
    for (Lagged const& r : regressors) {
        expects(0 <= r.lag && (r.column != output || r.lag > 0),
                "regressors of the present and the past, outputs of the past");
        std::string const name = r.plain ? r.column : text_of(r);
        names.push_back(data.header ? name : "column " + name);  // a column "1" is not the intercept
        sources.push_back({data[r.column].data(), r.lag});
        first = std::max(first, Index(r.lag));
    }
    return collected(data.file, data[output], std::move(names), first, used, [&](Index k, std::span<double> psi) {
        psi[0] = 1;
        std::ranges::transform(sources, psi.begin() + intercept, [k](Source const& s) { return s.column[k - s.lag]; });
    });
}

Records arx_records(std::vector<std::span<double const>> const& inputs, std::vector<std::string> const& input_names,
                    std::span<double const> y, Arx const& model, std::string const& file, std::vector<Index>* used) {
    expects(Index(inputs.size()) == model.inputs && inputs.size() == input_names.size(),
            "as many inputs, and names of them, as the model has");
    for (auto const& u : inputs) expects(u.size() == y.size(), "input and output of equal length");
    if (model.na < 0) fail("", fmt::format("na: expected at least 0, found {}", model.na));
    if (model.nb < 0) fail("", fmt::format("nb: expected at least 0, found {}", model.nb));
    if (model.delay < 0) fail("", fmt::format("delay: expected at least 0, found {}", model.delay));
    expect_rows(file, model.size(), Index(y.size()));  // before names are made: a mistyped order may be huge
    std::vector<std::string> names;
    for (int i = 1; i <= model.na; ++i) names.push_back(fmt::format("a{}", i));
    for (std::string const& input : input_names)
        for (int i = 0; i <= model.nb; ++i)
            names.push_back(input_names.size() == 1 ? fmt::format("b{}", i) : fmt::format("b{}[{}]", i, input));
    if (model.intercept) names.push_back("c");
    return collected(file, y, std::move(names), model.presample(), used, [&](Index k, std::span<double> psi) {
        auto next = psi.begin();
        for (Index i = 1; i <= model.na; ++i) *next++ = -y[std::size_t(k - i)];
        for (auto const& u : inputs)
            for (Index i = 0; i <= model.nb; ++i) *next++ = u[std::size_t(k - model.delay - i)];
        if (model.intercept) *next = 1;
    });
}

Records arx_records(std::span<double const> u, std::span<double const> y, Arx const& model, std::string const& file) {
    return arx_records({u}, {"u"}, y, model, file);
}

Records arx_records(Columns const& data, std::string const& input, std::string const& output, Arx const& model) {
    if (input == output) fail(data.file, fmt::format("column \"{}\" is both input and output", printable(input)));
    return arx_records(data[input], data[output], model, data.file);
}

// --- words with lags: the last pair of brackets is the lag, what stands before them the column -----------------------

namespace {

std::string_view trimmed(std::string_view text) {
    auto const first = text.find_first_not_of(" \t");
    return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// "k-3" as 3, "k+1" as -1; nothing for what is neither.
std::optional<long> lag_of(std::string_view text) {
    text = trimmed(text);
    if (!text.starts_with('k')) return {};
    text = trimmed(text.substr(1));
    if (text.empty()) return 0;
    long const sign = text[0] == '-' ? 1 : text[0] == '+' ? -1 : 0;
    text = trimmed(text.substr(1));
    long value = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc::result_out_of_range) value = largest_lag + 1L;
    else if (error != std::errc()) return {};
    if (sign == 0 || end != text.data() + text.size() || value < 0) return {};
    return sign * value;
}

}  // namespace

std::string text_of(Lagged const& r) {
    return r.lag == 0 ? fmt::format("{}[k]", printable(r.column)) : fmt::format("{}[k-{}]", printable(r.column), r.lag);
}

std::vector<Lagged> lagged_of(std::string const& option, std::vector<std::string> const& words,
                              std::string const& output) {
    std::vector<Lagged> out;
    for (std::string const& raw : words) {
        std::string_view const word = trimmed(raw);
        auto const refuse = [&](std::string const& why) {
            throw InputError(fmt::format("{}: {}: {}", option, printable(word), why));
        };
        auto const unclear = [&] {
            throw InputError(
                fmt::format("{}: expected columns with lags, as in y[k-1],y[k-2],u[k-3..k-5], found \"{}\"", option,
                            printable(word)));
        };
        if (word.empty()) unclear();
        if (!word.ends_with(']')) {
            if (word == output)
                refuse(fmt::format("the output needs a lag: {}[k-1] or further back", printable(output)));
            out.push_back({std::string(word), 0, true});
        } else {
            auto const open = word.rfind('[');
            if (open == word.npos) unclear();
            std::string const column(trimmed(word.substr(0, open)));
            std::string_view const inside = word.substr(open + 1, word.size() - open - 2);
            auto const dots = inside.find("..");
            auto const from = lag_of(inside.substr(0, dots)),
                       to = dots == inside.npos ? from : lag_of(inside.substr(dots + 2));
            if (column.empty() || !from || !to) unclear();
            if (*from < 0 || *to < 0) refuse("lies in the future: expected k, or k-1 and further back");
            if (*from > largest_lag || *to > largest_lag)
                refuse(fmt::format("expected a lag of at most {}", largest_lag));
            if (*from > *to)
                refuse(
                    fmt::format("expected the nearer lag first, as in {}[k-{}..k-{}]", printable(column), *to, *from));
            if (column == output && *from == 0)
                refuse(
                    fmt::format("is what the model is to give: expected {}[k-1] or further back", printable(output)));
            if (*to - *from >= most_regressors) refuse(fmt::format("expected at most {} regressors", most_regressors));
            for (long lag = *from; lag <= *to; ++lag) out.push_back({column, int(lag)});
        }
        if (out.size() > size_t(most_regressors))
            refuse(fmt::format("expected at most {} regressors", most_regressors));
    }
    if (out.empty()) throw InputError(fmt::format("{}: expected one regressor at least", option));
    std::vector<Lagged> sorted = out;
    auto const before = [](Lagged const& a, Lagged const& b) {
        return std::tie(a.column, a.lag) < std::tie(b.column, b.lag);
    };
    std::ranges::sort(sorted, before);
    auto const twice =
        std::ranges::adjacent_find(sorted, [&](Lagged const& a, Lagged const& b) { return !before(a, b); });
    if (twice != sorted.end()) throw InputError(fmt::format("{}: {} is named twice", option, text_of(*twice)));
    return out;
}

}  // namespace rlslab
