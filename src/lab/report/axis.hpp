// One axis: from numbers to places in a drawing, and readable ticks.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace rlslab::report {

/// log10 of a positive number by +, *, / and exact scalings alone: within a few units in the last place, and the same
/// bits on every machine (libm's may differ between processors).
double decades(double x);

/// The least and the largest of some numbers.
struct Range {
    double low = std::numeric_limits<double>::infinity(), high = -std::numeric_limits<double>::infinity();
    bool empty() const { return !(low <= high); }
    void add(double x) { low = x < low ? x : low, high = x > high ? x : high; }
};

struct Tick {
    double value;
    std::string text = {}, power = {};  ///< "0.5"; or "2·10" and its power "-7"; no text: a minor tick
    bool strong = false;
};
struct Ticks {
    std::vector<Tick> all;  ///< ascending, inside the range
    int left_out = 0;       ///< the power of ten that all labels leave out
};

class Axis {
    bool logarithmic_;
    int exponent_ = 0;   // numbers are taken as so many times 2^exponent, so that no difference overflows
    double low_, high_;  // the ends as coordinates: log10, or so scaled
    double begin_ = 0, end_ = 1;

    double coordinate(double value) const;
    Ticks linear(int about) const;
    Ticks within_a_decade(int about) const;
    Ticks logarithmic(int about) const;

public:
    /// Shows the range and `padding` of its length at either end; [0, 1] or [1, 10] if there is none.
    Axis(Range range, bool logarithmic, double padding);
    void place(double begin, double end) { begin_ = begin, end_ = end; }
    /// So many times as long, from the middle.
    void lengthen(double times);

    static bool shows(double value, bool logarithmic);
    bool shows(double value) const { return shows(value, logarithmic_); }
    /// Where it stands in the drawing.
    double operator()(double value) const {
        return begin_ + (end_ - begin_) * ((coordinate(value) - low_) / (high_ - low_));
    }
    double length() const { return high_ - low_; }
    /// The exponent of two of the unit of length(); logarithmic: 0.
    int exponent() const { return exponent_; }
    /// At 1, 2 or 5 times a power of ten, or at powers of ten; about as many with labels, or fewer.
    Ticks ticks(int about) const;
};

/// "-3.2" with a minus sign, long integers in groups of three.
std::string tick_text(std::string plain);

/// An estimate of the width of a text, in units of the size of its font; rather too large than too small.
double text_width(std::string_view text);

}  // namespace rlslab::report
