// A comparison as a table for people, as JSON and CSV for programs.
#include "compare.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace rlslab {
namespace {

using Json = nlohmann::ordered_json;

/// Three decimals of a digit count are far more than it means, and few enough that every machine prints the same.
double rounded_to(double x, double unit) { return std::round(x / unit) * unit; }
Json digits_json(std::optional<double> const& digits) {
    if (!digits || !std::isfinite(*digits)) return nullptr;
    return Json::parse(fmt::format("{:.3f}", rounded_to(*digits, 1e-3) + 0.0));
}
Json short_json(double x) {
    if (!std::isfinite(x)) return nullptr;
    return Json::parse(fmt::format("{:.5g}", x));
}

std::string digits_text(std::optional<double> const& digits) {
    return digits && std::isfinite(*digits) ? fmt::format("{:.1f}", *digits) : "-";
}
std::string breakdown_text(std::optional<Breakdown> const& breakdown) {
    return breakdown ? fmt::format("{} at {}", breakdown->kind, breakdown->step) : "none";
}
std::string asymmetry_text(std::optional<double> const& asymmetry) {
    if (!asymmetry) return "-";
    return *asymmetry == 0 ? "0" : fmt::format("{:.0e}", *asymmetry);
}
std::string nanoseconds_text(std::optional<double> const& ns) { return ns ? fmt::format("{:.0f}", *ns) : "-"; }
std::string operations_text(std::optional<long> const& operations) {
    return operations ? fmt::format("{}", *operations) : "-";
}

/// "stored: lambda 0.9906, rank 5 of 5; exact theta keeps 2.3 digits of binary64's"
std::string storage_text(Storage const& s, Comparison const& c) {
    return fmt::format("as stored: lambda {:.6g}, rank {} of {}; {}", s.forgetting, s.rank, c.size,
                       s.theta_digits ? fmt::format("rounding the data leaves {:.1f} digits of the exact theta", *s.theta_digits)
                                      : "no exact theta: the problem leaves the range");
}

/// "warning ..." when the prior, not the data, decides theta; or nothing.
std::string prior_warning(Comparison const& c) {
    if (!(c.prior_bias > most_prior_bias)) return "";
    return fmt::format("warning     the prior P0 = {:g} I moves theta by {:.2g} of itself: {}\n", c.options.p0, c.prior_bias,
                       c.better_p0 ? fmt::format("try --p0 {:.0e}, which moves it by 1e-3 at most", *c.better_p0)
                                   : "no --p0 in range will do; rescale the columns");
}

/// Text broken at spaces before column 114, the width of the table; it begins at column `at`, later lines at `indent`.
std::string wrapped(std::string const& text, size_t indent, size_t at) {
    constexpr size_t width = 114;
    std::string out;
    for (size_t begin = 0, end; begin < text.size(); begin = end + 1) {
        end = std::min(text.find(' ', begin), text.size());
        if (at + end - begin > width) {
            out += '\n' + std::string(indent, ' ');
            at = indent;
        } else if (!out.empty()) {
            out += ' ';
        }
        out += text.substr(begin, end - begin);
        at += end - begin + 1;
    }
    return out;
}

/// Colours as in a terminal, or nothing.
struct Paint {
    bool on;
    std::string operator()(char const* code, std::string const& text) const {
        return on ? fmt::format("\033[{}m{}\033[0m", code, text) : text;
    }
};

}  // namespace

std::string as_table(Comparison const& c, bool colour) {
    Paint const paint{colour};
    std::string out;
    out += fmt::format("data        {} rows, {} skipped; {} parameter{}, condition {}\n", c.rows, c.skipped, c.size,
                       c.size == 1 ? "" : "s", std::isinf(c.condition) ? "beyond 1e308" : fmt::format("{:.2g}", c.condition));
    out += fmt::format("reference   exact for the data in binary64, proven to {:.0e} relative at {} bits; prior bias {:.1e}\n",
                       c.radius, c.bits, c.prior_bias);
    size_t width = 0;
    for (std::string const& name : c.names) width = std::max(width, name.size());
    for (size_t i = 0; i < c.theta.size(); ++i)
        out += fmt::format("{}{:<{}}  {:>37}\n", i == 0 ? "theta       " : "            ", c.names[i], width,
                           c.theta[i].ends_with("e0") ? c.theta[i].substr(0, c.theta[i].size() - 2) + "  " : c.theta[i]);
    out += paint("31", prior_warning(c));

    std::string_view arithmetic;
    for (Result const& r : c.results) {
        Arithmetic const& a = *r.entry->arithmetic;
        if (a.name != arithmetic) {
            arithmetic = a.name;
            std::string const title = fmt::format("{} ({} bits, {:.1f} digits)", a.name, a.digits, a.decimal_digits());
            out += '\n' + paint("1", fmt::format("{:<42}", title)) +
                   paint("2", fmt::format(" {:>6} {:>6} {:>6}   {:<20}{:>10} {:>7} {:>9}", "theta", "worst", "P",
                                          "breakdown", "asymmetry", "ops", "ns")) + '\n';
            for (Storage const& s : c.storage)
                if (s.arithmetic == a.name) out += paint("2", "  " + storage_text(s, c)) + '\n';
        }
        bool const best = std::any_of(c.recommendations.begin(), c.recommendations.end(), [&](Recommendation const& rec) {
            return rec.arithmetic == a.name && rec.variant == r.entry->variant;
        });
        std::string const line =
            fmt::format("{} {:<40} {:>6} {:>6} {:>6}   {:<20}{:>10} {:>7} {:>9}", best ? '*' : ' ', r.entry->variant,
                        digits_text(r.theta_digits), digits_text(r.theta_digits_worst), digits_text(r.covariance_digits),
                        breakdown_text(r.breakdown), asymmetry_text(r.asymmetry), operations_text(r.operations),
                        nanoseconds_text(r.ns_per_update));
        out += paint(best ? "32" : r.breakdown ? "31" : "0", line) + '\n';
    }
    out += "\ntheta, worst, P: digits kept at the last row, of theta in norm, of its worst component, of the covariance in norm;\n"
           "at most the arithmetic's own, against the exact answer for the data as stored.\n"
           "breakdown: first step at which the stored P was not positive definite (decided exactly) or not finite.\n"
           "ops, ns: operations and nanoseconds a row, solving for theta included. qr_block and the sparse forms take rows in blocks:\n"
           "their breakdown is known to the block, their cost is spread over it, and they are not recommended for single rows.\n\n";
    size_t longest = 0;
    for (Recommendation const& r : c.recommendations) longest = std::max(longest, r.arithmetic.size());
    for (Recommendation const& r : c.recommendations) {
        std::string const variant = r.variant.empty() ? "none" : r.variant;
        out += fmt::format("use in {:<{}}  ", r.arithmetic, longest) + paint(r.variant.empty() ? "31" : "32", variant) + ": " +
               wrapped(r.why, longest + 9, longest + 11 + variant.size()) + '\n';
    }
    return out;
}

std::string as_json(Comparison const& c) {
    Json out;
    out["version"] = RLSLAB_VERSION;
    out["options"] = {{"forgetting", c.options.forgetting}, {"p0", c.options.p0}, {"seed", c.options.seed}};
    out["data"] = {{"rows", c.rows}, {"skipped", c.skipped}, {"size", c.size}, {"parameters", c.names}};
    out["reference"] = {{"theta", c.theta},
                        {"radius", short_json(c.radius)},
                        {"bits", c.bits},
                        {"condition", short_json(c.condition)},
                        {"prior_bias", short_json(c.prior_bias)},
                        {"better_p0", c.better_p0 ? Json(*c.better_p0) : Json(nullptr)}};
    out["storage"] = Json::array();
    for (Storage const& s : c.storage)
        out["storage"].push_back({{"arithmetic", s.arithmetic},
                                  {"forgetting", s.forgetting},
                                  {"rank", s.rank},
                                  {"theta_digits", digits_json(s.theta_digits)},
                                  {"prior_bias", short_json(s.prior_bias)}});
    out["results"] = Json::array();
    for (Result const& r : c.results)
        out["results"].push_back(
            {{"variant", r.entry->variant},
             {"arithmetic", r.entry->arithmetic->name},
             {"theta_digits", digits_json(r.theta_digits)},
             {"theta_digits_worst", digits_json(r.theta_digits_worst)},
             {"covariance_digits", digits_json(r.covariance_digits)},
             {"breakdown", r.breakdown ? Json{{"step", r.breakdown->step}, {"kind", r.breakdown->kind}} : Json(nullptr)},
             {"asymmetry", r.asymmetry ? short_json(*r.asymmetry) : Json(nullptr)},
             {"operations", r.operations ? Json(*r.operations) : Json(nullptr)},
             {"ns_per_update", r.ns_per_update ? short_json(*r.ns_per_update) : Json(nullptr)}});
    out["recommendation"] = Json::array();
    for (Recommendation const& r : c.recommendations)
        out["recommendation"].push_back({{"arithmetic", r.arithmetic},
                                         {"variant", r.variant.empty() ? Json(nullptr) : Json(r.variant)},
                                         {"why", r.why}});
    return out.dump(2) + '\n';
}

std::string as_csv(Comparison const& c) {
    std::string out = "variant,arithmetic,theta_digits,theta_digits_worst,covariance_digits,breakdown_step,breakdown_kind,"
                      "asymmetry,operations,ns_per_update\n";
    auto const cell = [](Json const& value) { return value.is_null() ? std::string() : value.dump(); };
    for (Result const& r : c.results)
        out += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", r.entry->variant, r.entry->arithmetic->name,
                           cell(digits_json(r.theta_digits)), cell(digits_json(r.theta_digits_worst)),
                           cell(digits_json(r.covariance_digits)), r.breakdown ? fmt::format("{}", r.breakdown->step) : "",
                           r.breakdown ? r.breakdown->kind : "", r.asymmetry ? cell(short_json(*r.asymmetry)) : "",
                           r.operations ? fmt::format("{}", *r.operations) : "",
                           r.ns_per_update ? cell(short_json(*r.ns_per_update)) : "");
    return out;
}

}  // namespace rlslab
