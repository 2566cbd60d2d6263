// SLICOT's FD01AD, a fast QR filter of a delay line, dressed as a fast form.
#pragma once

#include <rlslab/fast/fast_form.hpp>

#include <cmath>
#include <vector>

extern "C" void fd01ad_(char const* jp, int const* l, double const* root_lambda, double const* xin, double const* yin,
                        double* efor, double* xf, double* epsbck, double* cteta, double* steta, double* yq,
                        double* epos, double* eout, double* salph, int* iwarn, int* info, long jp_length);

namespace rlslab::bench {

/// It takes the root of lambda and of delta, starts with XF = 0, and reports the a posteriori error; the root of gamma
/// stands behind EPSBCK.
class Fd01ad {
    int size_;
    double root_lambda_, efor_;
    std::vector<double> xf_, epsbck_, cteta_, steta_, yq_, salph_;

public:
    using scalar = double;
    static constexpr std::string_view name = "fd01ad";
    explicit Fd01ad(FastProblem<double> const& problem)
        : size_(int(problem.size)), root_lambda_(std::sqrt(problem.forgetting)), efor_(std::sqrt(problem.energy)),
          xf_(size_t(size_)), epsbck_(size_t(size_) + 1), cteta_(size_t(size_), 1.0), steta_(size_t(size_)),
          yq_(size_t(size_)), salph_(size_t(size_)) {
        epsbck_.back() = 1;
    }
    Step<double> update(double const& u, double const& y) {
        double epos = 0, eout = 0;
        int warning = 0, info = 0;
        fd01ad_("B", &size_, &root_lambda_, &u, &y, &efor_, xf_.data(), epsbck_.data(), cteta_.data(), steta_.data(),
                yq_.data(), &epos, &eout, salph_.data(), &warning, &info, 1);
        double const gamma = epsbck_.back() * epsbck_.back();
        Step<double> step = step_of(eout / gamma, gamma);
        step.residual = eout;
        return step;
    }
    Index size() const { return size_; }
};
static_assert(FastForm<Fd01ad>);

}  // namespace rlslab::bench
