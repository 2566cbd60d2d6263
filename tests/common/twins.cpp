// Comparing twins, and their rows.
#include "tests/common/twins.hpp"
#include "tests/common/same.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rlslab::twins {

/// As doubles whose sum it is.
void Left::wide(Reference x) {
    for (int i = 0; i < 6; ++i) {
        double const head = static_cast<double>(x);
        numbers_.push_back(head);
        if (!std::isfinite(head)) return;
        x -= head;
    }
}
std::vector<double> Left::of(std::string_view name) const {
    for (std::size_t i = 0; i < parts_.size(); ++i)
        if (parts_[i].first == name) {
            std::size_t const end = i + 1 < parts_.size() ? parts_[i + 1].second : numbers_.size();
            return {numbers_.begin() + std::ptrdiff_t(parts_[i].second), numbers_.begin() + std::ptrdiff_t(end)};
        }
    return {};
}

std::string parted(Left const& a, Left const& b, std::string const& at) {
    auto const &x = a.numbers_, &y = b.numbers_;
    long const first = difference(x, y);
    if (first < 0) return "";
    std::size_t const i = std::size_t(first);
    if (i == std::min(x.size(), y.size())) return fmt::format("all{}: {} and {} numbers", at, x.size(), y.size());
    auto part = a.parts_.begin();
    while (part + 1 != a.parts_.end() && (part + 1)->second <= i) ++part;
    return fmt::format("{}[{}]{}: {:a} and {:a}", part->first, i - part->second, at, x[i], y[i]);
}
std::string parted(Trace const& a, Trace const& b) {
    if (a.size() != b.size()) return fmt::format("{} and {} rows", a.size(), b.size());
    for (std::size_t k = 0; k < a.size(); ++k)
        if (!parted(a[k], b[k]).empty()) return parted(a[k], b[k], fmt::format(" at row {}", k));
    return "";
}
void expect_one(std::string_view what, Left const& a, Left const& b) { EXPECT_EQ(parted(a, b), "") << what; }
void expect_one(std::string_view what, Trace const& a, Trace const& b) { EXPECT_EQ(parted(a, b), "") << what; }
void expect_one(std::string_view what, std::vector<Trace> const& a, std::vector<Trace> const& b) {
    ASSERT_EQ(a.size(), b.size()) << what;
    for (std::size_t i = 0; i < a.size(); ++i) EXPECT_EQ(parted(a[i], b[i]), "") << what << ", lane " << i;
}

Row<double> Lively::next() {
    Row<double> out{Vector<double>::Zero(d), 0.125 * seed.bell(), 1, k++};
    double const chance = seed.uniform();
    if (silent > 0) --silent;
    else if (chance < 0.004) silent = 250;
    else if (chance < 0.01) sign = -sign;
    for (Index j = 0; j < d; ++j) {
        double const x = seed.bell();
        if (silent == 0) out.psi[j] = x;
        out.y += sign * out.psi[j] * double(j + 1);
    }
    if (seed.uniform() < 0.02) out.y += 100;
    double const odd = seed.uniform();
    if (beyond != 0 && odd < 0.01) out.y = beyond;
    else if (beyond != 0 && odd < 0.02) out.psi[d / 2] = -beyond;
    else if (nan && odd < 0.03) out.psi[0] = std::numeric_limits<double>::quiet_NaN();
    else if (nan && odd < 0.04) out.y = std::numeric_limits<double>::infinity();
    return out;
}
Rows taken(Lively source, Index count) {
    Rows out;
    for (Index k = 0; k < count; ++k) out.push_back(source.next());
    return out;
}

}  // namespace rlslab::twins
