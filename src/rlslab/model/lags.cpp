// One word at a time: the last pair of brackets is the lag, what stands before them the column.
#include <rlslab/model/lags.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>

namespace rlslab {
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
