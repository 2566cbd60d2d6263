// Ticks at 1, 2, 5 times powers of ten; at decades on a logarithmic axis, and between them where there are few.
#include "src/lab/report/axis.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace rlslab::report {
namespace {

/// digits * 10^power, rounded once.
double scaled(long long digits, int power) {
    std::string const text = fmt::format("{}e{}", digits, power);
    double out = 0;
    auto const result = std::from_chars(text.data(), text.data() + text.size(), out);
    if (result.ec == std::errc::result_out_of_range) return power < 0 ? 0 : std::copysign(HUGE_VAL, double(digits));
    return out;
}

struct Step {
    int digit, power;
    double value() const { return scaled(digit, power); }
};
/// The least 1, 2 or 5 times a power of ten that is not below x (but for rounding).
Step step_from(double x) {
    int const near = int(std::floor(decades(x)));
    for (int const power : {near - 1, near, near + 1})
        for (int const digit : {1, 2, 5})
            if (Step const step{digit, power}; step.value() >= x * (1 - 1e-9)) return step;
    return {1, near + 2};
}

/// 10^x, by the series of exp: like decades(), the same bits everywhere.
double power_of_ten(double x) {
    int const whole = int(std::floor(x));
    double const z = (x - whole) * 2.30258509299404568402;  // in [0, ln 10): after 30 terms less than 1e-21 is left
    double sum = 1;
    for (int k = 30; k >= 1; --k) sum = 1 + sum * z / k;
    return sum * scaled(1, whole);
}

}  // namespace

double decades(double x) {
    int exponent = 0;
    double m = std::frexp(x, &exponent);
    if (m < 0.70710678118654752) m *= 2, --exponent;
    // ln m = 2 artanh s = 2 s (1 + s^2/3 + s^4/5 + ...), |s| < 0.172: twelve terms leave less than 1e-19 of it.
    double const s = (m - 1) / (m + 1), q = s * s;
    double sum = 0;
    for (int k = 11; k >= 0; --k) sum = sum * q + 1.0 / (2 * k + 1);
    constexpr double log10_2 = 0.30102999566398119521, log10_e = 0.43429448190325182765;
    return exponent * log10_2 + 2 * s * sum * log10_e;
}

Axis::Axis(Range range, bool logarithmic, double padding) : logarithmic_(logarithmic) {
    if (range.empty()) range = logarithmic ? Range{1, 10} : Range{0, 1};
    double const largest = std::max(std::abs(range.low), std::abs(range.high));
    if (!logarithmic && largest > 0) std::frexp(largest, &exponent_);
    low_ = coordinate(range.low), high_ = coordinate(range.high);
    // Between numbers that agree to twelve digits no two ticks would have different labels: they are drawn as one.
    double const middle = (low_ + high_) / 2;
    if (high_ - low_ < (logarithmic ? 1e-9 : 1e-12 * std::abs(middle)) || low_ == high_) {
        double const around = logarithmic ? 0.5 : middle == 0 ? 1 : 0.1 * std::abs(middle);
        low_ = middle - around, high_ = middle + around;
    }
    lengthen(1 + 2 * padding);
}

void Axis::lengthen(double times) {
    double const more = (times - 1) / 2 * (high_ - low_);
    low_ -= more, high_ += more;
}

double Axis::coordinate(double value) const { return logarithmic_ ? decades(value) : std::ldexp(value, -exponent_); }

bool Axis::shows(double value, bool logarithmic) { return std::isfinite(value) && (!logarithmic || value > 0); }

Ticks Axis::ticks(int about) const {
    return logarithmic_ ? logarithmic(std::max(about, 2)) : linear(std::max(about, 2));
}

Ticks Axis::linear(int about) const {
    Ticks out;
    double const wished = std::ldexp((high_ - low_) / about, exponent_);
    if (!(wished > 1e-300)) return out;  // a step among subnormal numbers has too few digits
    Step const step = step_from(wished);
    double const unit = std::ldexp(step.value(), -exponent_);
    constexpr double slack = 1e-9;  // of a step: an end that equals a tick except for rounding gets that tick
    auto const first = static_cast<long long>(std::ceil(low_ / unit - slack)),
               last = static_cast<long long>(std::floor(high_ / unit + slack));
    long long const most = std::max(std::abs(first), std::abs(last));
    int const order =
        most == 0 ? 0 : step.power + int(std::to_string(most * step.digit).size()) - 1;  // of the largest label
    if (order > 5 || order < -3) out.left_out = order;
    int const decimals = std::max(0, out.left_out - step.power);
    for (long long i = first; i <= last; ++i) {
        double const value = scaled(i * step.digit, step.power);
        if (std::isfinite(value))
            out.all.push_back({value, tick_text(fmt::format(
                                          "{:.{}f}", scaled(i * step.digit, step.power - out.left_out), decimals))});
    }
    return out;
}

/// Less than a decade between the ends: 1 ... 9 times a power of ten if three are inside, else as on a linear axis.
Ticks Axis::within_a_decade(int about) const {
    Ticks out;
    std::vector<int> digits;
    for (int power = int(std::floor(low_)); power <= int(std::floor(high_)); ++power)
        for (int digit = 1; digit <= 9; ++digit) {
            double const value = scaled(digit, power), at = std::isfinite(value) && value > 0 ? decades(value) : -400;
            if (at < low_ - 1e-9 || at > high_ + 1e-9 || (!out.all.empty() && value <= out.all.back().value)) continue;
            digits.push_back(digit);
            if (power >= -3 && power <= 4)
                out.all.push_back({value, tick_text(fmt::format("{:.{}f}", value, std::max(0, -power)))});
            else
                out.all.push_back(
                    {value, digit == 1 ? "10" : fmt::format("{}·10", digit), tick_text(fmt::format("{}", power))});
        }
    if (out.all.size() >= 3) {
        // The largest of these sets of digits that gives no more labels than wished for.
        for (std::string_view const labelled : {"123456789", "123468", "12357", "125", "13"}) {
            auto const is_kept = [&](size_t i) {
                return labelled.find(char('0' + digits[i])) != std::string_view::npos;
            };
            int labels = 0;
            for (size_t i = 0; i < digits.size(); ++i) labels += is_kept(i);
            if (labels > about && labelled != "13") continue;
            for (size_t i = 0; i < digits.size(); ++i)
                if (!is_kept(i)) out.all[i].text.clear(), out.all[i].power.clear();
            break;
        }
        return out;
    }
    return Axis({power_of_ten(low_), power_of_ten(high_)}, false, 0).linear(about);
}

Ticks Axis::logarithmic(int about) const {
    constexpr double slack = 1e-9;
    int const first = int(std::ceil(low_ - slack)), last = int(std::floor(high_ + slack)), count = last - first + 1;
    if (count < 2) return within_a_decade(about);
    int stride = 1;
    for (int const wider : {2, 3, 5, 10, 20, 50, 100, 200})
        if (count > about * stride) stride = wider;
    bool const plain = first >= -2 && last <= 4;
    Ticks out;
    for (int power = first - 1; power <= last; ++power) {
        double const decade = scaled(1, power);
        if (power >= first && decade > 0 && std::isfinite(decade)) {
            Tick tick{decade};
            bool const labelled = ((power % stride) + stride) % stride == 0;
            if (!labelled && count > 40) continue;
            if (labelled)
                plain ? tick.text = tick_text(fmt::format("{:.{}f}", decade, std::max(0, -power)))
                      : (tick.text = "10", tick.power = tick_text(fmt::format("{}", power)));
            out.all.push_back(tick);
        }
        for (int digit = 2; stride == 1 && count <= 7 && digit <= 9; ++digit) {
            double const value = scaled(digit, power);
            if (!std::isfinite(value) || value <= 0 || decades(value) < low_ || decades(value) > high_) continue;
            bool const labelled = plain && 4 * count <= about && (digit == 2 || digit == 5);
            out.all.push_back({value, labelled ? tick_text(fmt::format("{:.{}f}", value, std::max(0, -power))) : ""});
        }
    }
    return out;
}

std::string tick_text(std::string plain) {
    bool const negative = plain.starts_with('-');
    if (negative) plain.erase(0, 1);
    if (plain.find_first_not_of("0.") == std::string::npos) return plain;  // no minus before a zero
    size_t const whole = std::min(plain.find('.'), plain.size());
    if (whole > 4)
        for (size_t at = whole; at > 3; at -= 3) plain.insert(at - 3, "\u2009");
    return negative ? "\u2212" + plain : plain;
}

double text_width(std::string_view text) {
    double out = 0;
    for (char const c : text) {
        if ((static_cast<unsigned char>(c) & 0xc0) == 0x80) continue;  // goes on with a character of UTF-8
        constexpr std::string_view slim = "iljtfrI.,:;'|!()[] /", wide = "mwMW%@";
        out += slim.find(c) != std::string_view::npos   ? 0.37
               : wide.find(c) != std::string_view::npos ? 0.95
               : c >= 'A' && c <= 'Z'                   ? 0.7
                                                        : 0.62;
    }
    return out;
}

}  // namespace rlslab::report
