// Sentences, and lines of a certain width.
#include "compare/words.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace rlslab {

constexpr size_t width = 114;

std::string wrapped(std::string const& text, size_t indent) {
    std::string out;
    for (size_t begin = 0, end, at = indent; begin < text.size(); begin = end + 1) {
        end = std::min(text.find(' ', begin), text.size());
        if (at + end - begin > width) {
            out += '\n' + std::string(indent, ' ');
            at = indent;
        } else if (begin > 0) {
            out += ' ';
        }
        out += text.substr(begin, end - begin);
        at += end - begin + 1;
    }
    return out;
}

std::string listed(std::vector<std::string> const& items, std::string const& indent, size_t at) {
    std::string out;
    for (size_t i = 0; i < items.size(); ++i) {
        std::string const item = items[i] + (i + 1 < items.size() ? "," : "");
        if (i > 0 && at + 1 + item.size() > width) {
            out += '\n' + indent;
            at = indent.size();
        } else if (i > 0) {
            out += ' ';
            ++at;
        }
        out += item;
        at += item.size();
    }
    return out;
}

std::string breakdown_text(Result const& r) {
    if (r.breakdown) return fmt::format("{} at {}", r.breakdown->kind, r.breakdown->step);
    return r.broken == 0 ? "none" : fmt::format("in {} of {} {}", r.broken, r.runs, r.entry->arithmetic->stochastic ? "draws" : "orders");
}
std::string prior_text(Comparison const& c) {
    std::string out = "theta0 = 0, P0 = ";
    if (c.scaled_prior) {
        auto const [least, largest] = std::minmax_element(c.scaled_prior->s.begin(), c.scaled_prior->s.end());
        out += fmt::format("diag((c / s_i)^2), c = {}, s_i = {} to {}: root mean squares of the regressors, rounded to powers of two; ", c.scaled_prior->c, *least,
                           *largest);
    } else {
        out += fmt::format("{} I: ", *c.options.p0);
    }
    out += fmt::format("moves theta by {:.1e} of itself", c.prior_bias);
    if (c.scaled_prior && c.scaled_prior->reached) out += " (c is the least power of two that leaves 1e-3 at most)";
    return out;
}

}  // namespace rlslab
