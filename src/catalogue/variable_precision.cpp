// Every variant in formats that are chosen at run time: p11, or p8:-126:127:stochastic.
#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/catalogue/instances.hpp>

#include <rlslab/arithmetic/arithmetics.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/input/text.hpp>

#include <charconv>
#include <fmt/format.h>
#include <map>
#include <mutex>

namespace rlslab {
namespace {

static_assert(std::tuple_size_v<Arithmetics> == RLSLAB_ARITHMETICS,
              "src/catalogue/CMakeLists.txt counts the arithmetics");

Instances any_length() {
    static Arithmetic arithmetic;  // entries point to it
    Instances out = instances<bits_index>();
    arithmetic = out.arithmetic;
    for (CatalogueEntry& entry : out.entries) entry.arithmetic = &arithmetic;
    return out;
}

constexpr std::pair<Rounding, std::string_view> roundings[] = {{Rounding::stochastic, "stochastic"},
                                                               {Rounding::toward_zero, "toward_zero"}};

/// A whole number of at most four digits; nullopt for anything else.
std::optional<int> whole(std::string_view text) {
    int value = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    bool const read = error == std::errc() && end == text.data() + text.size() && text.size() <= 5;
    return read ? std::optional(value) : std::nullopt;
}

/// nullopt where the text is not of the form.
std::optional<RunTimeFormat> parsed(std::string_view text) {
    std::vector<std::string_view> parts;
    for (text.remove_prefix(1);; text.remove_prefix(parts.back().size() + 1)) {
        parts.push_back(text.substr(0, text.find(':')));
        if (parts.back().size() == text.size()) break;
    }
    if (parts.size() == 2 || parts.size() > 4) return std::nullopt;
    RunTimeFormat out;
    int* const numbers[] = {&out.format.digits, &out.format.min_exp, &out.format.max_exp};
    for (size_t i = 0; i < std::min<size_t>(parts.size(), 3); ++i) {
        std::optional<int> const value = whole(parts[i]);
        if (!value) return std::nullopt;
        *numbers[i] = *value;
    }
    if (parts.size() == 4) {
        auto const* const known =
            std::ranges::find(roundings, parts[3], &std::pair<Rounding, std::string_view>::second);
        if (known == std::end(roundings)) return std::nullopt;
        out.rounding = known->first;
    }
    return out;
}

std::string name_of(RunTimeFormat const& f) {
    std::string out = fmt::format("p{}", f.format.digits);
    if (f.has_range()) out += fmt::format(":{}:{}", f.format.min_exp, f.format.max_exp);
    for (auto const& [rounding, name] : roundings)
        if (f.rounding == rounding) out += fmt::format(":{}", name);
    return out;
}

struct AtRunTime {
    std::string name;
    Arithmetic arithmetic;
    std::vector<CatalogueEntry> entries;  ///< they point to the arithmetic
};
void fill(AtRunTime& out, RunTimeFormat const& f) {
    out.arithmetic = {out.name,
                      f.format.digits,
                      f.format.min_exp,
                      f.format.max_exp,
                      f.rounding == Rounding::stochastic,
                      [f](double x) { return nearest_in(f, x); }};
    out.entries = variable_precision_catalogue();
    for (CatalogueEntry& entry : out.entries) {
        entry.arithmetic = &out.arithmetic;
        entry.make = [f, make = entry.make](Problem<double> const& problem, Seed seed) {
            PrecisionScope const precision(f);
            return make(problem, seed);
        };
        entry.time = [f, time = entry.time](Problem<double> const& problem, Records const& records, Seed seed) {
            PrecisionScope const precision(f);
            return time(problem, records, seed);
        };
    }
}

}  // namespace

std::vector<CatalogueEntry> const& variable_precision_catalogue() {
    static Instances const all = any_length();
    return all.entries;
}

std::vector<CatalogueEntry> const* entries_at_run_time(std::string_view name, std::string_view where) {
    static std::mutex one_at_a_time;
    static std::map<std::string, AtRunTime> known;  // never removed from: who asked may keep the address
    if (name.size() < 2 || name[0] != 'p' || !(name[1] == '-' || (name[1] >= '0' && name[1] <= '9'))) return nullptr;
    std::optional<RunTimeFormat> const format = parsed(name);
    if (!format)
        throw InputError(
            fmt::format("{}: expected pN, pN:EMIN:EMAX, or that with :stochastic or :toward_zero, found "
                        "\"{}\"",
                        where, printable(std::string(name))));
    if (!format->valid())
        throw InputError(fmt::format(
            "{}: double cannot emulate \"{}\": expected pN with N from 2 to 53, or pN:EMIN:EMAX with N to 25, EMIN <= "
            "EMAX, and products and quotients within double's exponents (EMIN from -400 and EMAX to 400 are)",
            where, printable(std::string(name))));
    std::lock_guard const lock(one_at_a_time);
    std::string const canonical = name_of(*format);
    auto const [place, fresh] = known.try_emplace(canonical);
    if (fresh) {
        place->second.name = canonical;
        fill(place->second, *format);
    }
    return &place->second.entries;
}

}  // namespace rlslab
