// Looks at the checkpoints; the last of them is nearest to the end.
#include "src/lab/compare/foretold.hpp"

#include <rlslab/arithmetic/elementary.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::compare {

void Foretold::look(Index row, Stored<Reference> const& stored) {
    ++seen_;
    if (2 * seen_ < looks_ || !(forgetting_ < 1) || !grows_) return;
    grows_ = stored.form == Stored<Reference>::Form::plain;
    double largest = 0, share = 0;
    for (Index j = 0; j < stored.F.cols() && grows_; ++j)
        for (Index i = 0; i < j; ++i) {
            double const apart = std::abs(static_cast<double>(Reference(stored.F(i, j) - stored.F(j, i)))),
                         size = std::sqrt(static_cast<double>(stored.F(i, i))) *
                                std::sqrt(static_cast<double>(stored.F(j, j)));
            largest = std::max(largest, apart), share = std::max(share, apart / size);
        }
    double const growth = correctly::exp(-double(row - last_) * correctly::log(forgetting_));
    grows_ = grows_ && share > 0 && std::isfinite(share) && (largest_ == 0 || largest > 0.97 * growth * largest_);
    last_ = row, largest_ = largest, share_ = share;
}

std::optional<double> Foretold::row() const {
    if (!(forgetting_ < 1) || seen_ < 2 || !grows_ || !(share_ > 0)) return {};
    return double(last_) + std::max(0.0, correctly::log(share_) / correctly::log(forgetting_));
}

double rounded_row(double row) {
    double unit = 1;
    while (row >= 100 * unit) unit *= 10;
    return std::round(row / unit) * unit;
}

}  // namespace rlslab::compare
