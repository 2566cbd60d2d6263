// What a rule of forgetting says of its numbers, once: for saved states, the command line, its messages and printed
// C++.
#pragma once

#include <limits>
#include <string_view>
#include <tuple>

namespace rlslab {

/// What stands for a number that is not given: the member's own value, none, or a variance that follows from the data.
enum class RuleDefault : unsigned char { member, none, noise_variance, prior_variance };

struct RuleRange {
    double least = 0, most = std::numeric_limits<double>::max();  ///< both included, but `least` where `positive`
    bool positive = false;
    RuleDefault otherwise = RuleDefault::member;
    bool inverted = false;  ///< the rule divides by it: 1/x must be finite in the arithmetic
};

/// One number of a rule: its member, by name and address, and its name on a command line ("": it has none there).
template <class Rule, class X>
struct RuleNumber {
    std::string_view member;
    X Rule::*at;
    std::string_view name = {};
    RuleRange range = {};
};
template <class Rule, class X>
RuleNumber(std::string_view, X Rule::*, std::string_view = {}, RuleRange = {}) -> RuleNumber<Rule, X>;

namespace detail {
template <class Rule>
constexpr auto numbers_of() {
    if constexpr (requires { Rule::numbers(); }) return Rule::numbers();
    else return std::tuple<>{};
}
/// Calls visit(RuleNumber) for each number of the rule, in their order.
template <class Rule>
constexpr void for_each_number(auto visit) {
    std::apply([&](auto const&... number) { (visit(number), ...); }, numbers_of<Rule>());
}
}  // namespace detail

}  // namespace rlslab
