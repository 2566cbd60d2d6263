// An exact result rounded once to a format, by a search among the format's numbers and exact rationals: no rounding of
// the library is asked.
#pragma once

#include "tests/common/same.hpp"

#include <rlslab/arithmetic/multiprecision.hpp>
#include <rlslab/arithmetic/rounded.hpp>

#include <algorithm>
#include <functional>

namespace rlslab::rounding {

inline constexpr double infinity = std::numeric_limits<double>::infinity(),
                        nan = std::numeric_limits<double>::quiet_NaN();

using rlslab::same;

/// The numbers >= 0 of a format have places 0, 1, 2...; odd ones hold odd significands; the last is the first power of
/// two that the format lacks.
using Place = std::uint64_t;
inline Place binade(Format f) { return Place{1} << (f.digits - 1); }
inline Place last_place(Format f) { return binade(f) * Place(f.max_exp - f.min_exp + 2); }
inline double number(Format f, Place place) {
    Place const m = place % binade(f), row = place / binade(f);  // row 0 has the subnormals
    return std::ldexp(double(row == 0 ? m : binade(f) + m), f.min_exp - f.digits + (row == 0 ? 1 : int(row)));
}

/// |exact| lies in [number(i), number(i + 1)) and is rounded; u is the stochastic rounding's draw. against(g, more):
/// the sign of |exact| - (g + more).
template <class Against>
double rounded(Format f, Rounding rounding, Place i, Against const& against, double u) {
    Place const last = last_place(f);
    if (rounding == Rounding::toward_zero) return number(f, std::min(i, last - 1));
    auto const outward = [&](bool up) { return i + up >= last ? infinity : number(f, i + up); };
    double const here = number(f, i);
    if (i >= last || against(here, 0) == 0) return outward(false);
    double const gap = number(f, i + 1) - here;
    if (rounding == Rounding::stochastic) return outward(against(here, u * gap) > 0);
    int const side = against(here, gap / 2);
    return outward(side > 0 || (side == 0 && i % 2 == 1));
}
/// The place i that rounded() asks for; `near` says where to begin.
template <class Against>
Place place_of(Format f, double near, Against const& against) {
    int const e = near == 0 ? f.min_exp : std::max(std::ilogb(near), f.min_exp);
    Place i = e > f.max_exp ? last_place(f)
                            : Place(e - f.min_exp) * binade(f) + Place(std::ldexp(std::abs(near), f.digits - 1 - e));
    while (i > 0 && against(number(f, i), 0) < 0) --i;
    while (i < last_place(f) && against(number(f, i + 1), 0) >= 0) ++i;
    return i;
}

/// One of + - * / and r, the root of the first.
template <class C>
double operate(char op, double x, double y) {
    using std::sqrt;
    C a(static_cast<C>(x));
    C const b(static_cast<C>(y));
    switch (op) {
        case '+': return double(a += b);
        case '-': return double(a -= b);
        case '*': return double(a *= b);
        case '/': return double(a /= b);
        default: return double(C(sqrt(a)));
    }
}
inline constexpr char operations[] = {'+', '-', '*', '/', 'r'};
/// The sign of |a op b| - (g + more), for finite a op b.
inline std::function<int(double, double)> exactly(char op, double a, double b) {
    Rational const x(std::abs(a)), y(std::abs(b));
    return [op, x, y, s = op == '*' ? Rational(x * y) : abs(Rational(a) + Rational(op == '-' ? -b : b))](double inner,
                                                                                                         double more) {
        Rational const g = Rational(inner) + Rational(more);
        return op == 'r' ? Rational(x - g * g).sign() : op == '/' ? Rational(x - g * y).sign() : Rational(s - g).sign();
    };
}
/// Specials, and signs of exact zeros, are double's.
inline double oracle(Format f, Rounding rounding, char op, double a, double b, double u = 0) {
    double const head = operate<double>(op, a, b);
    if (!std::isfinite(head) || head == 0 || !std::isfinite(b)) return head;
    auto const against = exactly(op, a, b);
    return std::copysign(rounded(f, rounding, place_of(f, head, against), against, u), head);
}

using Operation = std::function<double(char op, double a, double b)>;
/// One operation under a stream of its own: the value, and that a draw is taken if and only if the result is inexact.
/// (What overflows may draw or not: no draw can change it.)
inline bool rounds_once(Operation const& f, Format format, Rounding rounding, char op, double a, double b, Seed seed) {
    Seed copy = seed, used = seed;
    double const u = copy.uniform();
    StochasticStream const stream(used);
    if (!same(f(op, a, b), oracle(format, rounding, op, a, b, u))) return false;
    if (rounding != Rounding::stochastic) return used == seed;
    double const high = oracle(format, rounding, op, a, b, 0), low = oracle(format, rounding, op, a, b, 1);
    return used == (same(low, high) ? seed : copy) || (used == copy && std::isinf(low));
}

/// Operands drawn from all numbers of a format, every second pair of neighbouring places (cancellation, quotients close
/// to 1), every third with one of few bits.
using Check = std::function<bool(char op, double a, double b, Seed)>;
inline bool random_pairs(Format f, int count, Check const& check) {
    bool good = true;
    Seed seed{7};
    Place const n = last_place(f);
    for (int k = 0; k < count && good; ++k) {
        Place const i = seed.next() % n;
        Place j = k % 2 ? seed.next() % n : std::min(n - 1, i + seed.next() % 4096);
        if (k % 3 == 0) j -= j % std::max(binade(f) / 4, Place{1});
        double const a = (seed.next() % 2 ? 1 : -1) * number(f, i), b = (seed.next() % 2 ? 1 : -1) * number(f, j);
        for (char const op : operations) good = good && check(op, a, b, Seed{seed.next()});
    }
    return good;
}

}  // namespace rlslab::rounding
