// The only place where windows are compiled for studies.
#include "studies/adapt/windows.hpp"

#include "studies/adapt/corrected_downdate.hpp"

#include <rlslab/adapt/window.hpp>
#include <rlslab/core/input_error.hpp>
#include <rlslab/core/type_list.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/qr.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>

#include <cmath>
#include <fmt/format.h>
#include <stdexcept>

namespace rlslab::studies {
namespace {

template <class T>
Reference widened(T const& x) {
    return widen(x);
}

template <class F>
class SlidingAs : public SlidingFilter {
    using T = typename F::scalar;
    Windowed<F> window_;
    std::vector<T> psi_;

public:
    SlidingAs(Problem<double> const& problem, Index rows, Refactoring const& refactoring)
        : window_(problem.mapped<T>([](double x) { return T(x); }),
                  {.rows = rows, .worse = T(refactoring.worse), .refactor_every = refactoring.every}),
          psi_(size_t(problem.size)) {}
    void update(double const* psi, double y) override {
        for (size_t i = 0; i < psi_.size(); ++i) psi_[i] = T(psi[i]);
        window_.update(psi_, T(y));
    }
    Vector<Reference> theta() const override { return window_.theta().unaryExpr(&widened<T>); }
    Stored<Reference> stored() const override { return window_.stored().template mapped<Reference>(&widened<T>); }
    Index refactored() const override { return window_.refactored(); }
    double predicted() const override { return std::sqrt(double(window_.grown())); }
};

template <class T>
class SlidingCorrected : public SlidingFilter {
    CorrectedDowndate<T> downdate_;
    std::vector<T> psi_;

public:
    SlidingCorrected(Problem<double> const& problem, Index rows)
        : downdate_(problem.size, rows, T(problem.prior->variance)), psi_(size_t(problem.size)) {}
    void update(double const* psi, double) override {
        for (size_t i = 0; i < psi_.size(); ++i) psi_[i] = T(psi[i]);
        downdate_.update(psi_);
    }
    Vector<Reference> theta() const override { return Vector<Reference>::Constant(Index(psi_.size()), Reference(NAN)); }
    Stored<Reference> stored() const override { return downdate_.stored().template mapped<Reference>(&widened<T>); }
    Index refactored() const override { return 0; }
    double predicted() const override { return NAN; }
};

template <class T>
std::unique_ptr<SlidingFilter> sliding_in(std::string_view variant, Problem<double> const& problem, Index rows,
                                          Refactoring const& refactoring) {
    std::unique_ptr<SlidingFilter> out;
    for_each(TypeList<Conventional<T>, Symmetric<T>, Potter<T>, Carlson<T>, Ud<T>, Qr<T>, Gentleman<T>>{},
             [&]<class F>() {
                 if (F::name == variant) out = std::make_unique<SlidingAs<F>>(problem, rows, refactoring);
             });
    if (variant == "corrected") out = std::make_unique<SlidingCorrected<T>>(problem, rows);
    if (!out) throw std::logic_error("no such window");
    return out;
}

}  // namespace

std::vector<std::string> const& windowed_variants() {
    static std::vector<std::string> const names{"conventional", "symmetric", "potter",   "carlson",
                                                "ud",           "qr",        "gentleman"};
    return names;
}
std::unique_ptr<SlidingFilter> sliding(std::string_view variant, std::string_view arithmetic,
                                       Problem<double> const& problem, Index rows, Refactoring const& refactoring) {
    if (arithmetic == "float") return sliding_in<float>(variant, problem, rows, refactoring);
    if (arithmetic != "double")
        throw InputError(fmt::format("windows exist here in float and double, not in {}", arithmetic));
    return sliding_in<double>(variant, problem, rows, refactoring);
}

}  // namespace rlslab::studies
