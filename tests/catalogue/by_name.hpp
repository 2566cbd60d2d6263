// A filter by its C++ type, behind numbers: what filters by name are compared with. One class a type, and the laws are
// compiled once (by_name.cpp).
#pragma once

#include <rlslab/catalogue/native/filter.hpp>
#include "tests/common/files.hpp"
#include "tests/common/twins.hpp"

#include <rlslab/core/process.hpp>
#include <rlslab/state/state.hpp>

#include <memory>

namespace rlslab::by_name {

using twins::Left;
using Bytes = std::vector<std::byte>;
inline constexpr Index d = 4;

struct Typed {
    std::string_view variant, arithmetic;
    virtual ~Typed() = default;
    virtual std::unique_ptr<Typed> clone() const = 0;
    virtual Left update(Vector<double> const& psi, double y) = 0;  ///< what is left: the step, theta, gain, the signal
    virtual Left process(Matrix<double> const& psi, Vector<double> const& y) = 0;
    virtual Left pass_time() = 0;
    virtual Left stored() const = 0;                ///< theta and what it propagates
    virtual Left reported() const = 0;              ///< P or its inverse, of a variant that is alone
    virtual std::vector<Index> counts() const = 0;  ///< of a guard
    virtual Bytes saved() const = 0;
    virtual StateFault load(Bytes const& bytes) = 0;
};
template <class F>
class TypedAs final : public Typed {
    F filter_;
    using T = typename F::scalar;
    Left left(Step<T> const& s) const {
        Left out;
        out.add("innovation", s.innovation).add("residual", s.residual).add("gamma", s.gamma).add("health", s.health);
        out.add("theta", filter_.theta()).add("gain", filter_.gain());
        if constexpr (requires { filter_.signal(); }) out.add("signal", filter_.signal());
        else out.add("signal", 0);
        return out;
    }

public:
    explicit TypedAs(F const& filter) : filter_(filter) { variant = F::name, arithmetic = ArithmeticTraits<T>::name; }
    std::unique_ptr<Typed> clone() const override { return std::make_unique<TypedAs>(*this); }
    Left update(Vector<double> const& psi, double y) override {
        Vector<T> const row = psi.cast<T>();
        return left(filter_.update(row, T(y)));
    }
    Left process(Matrix<double> const& psi, Vector<double> const& y) override {
        return left(rlslab::process(filter_, psi, y));
    }
    Left pass_time() override {
        if constexpr (requires { filter_.pass_time(); }) return left(filter_.pass_time());
        else return left(filter_.update(Vector<T>(Vector<T>::Zero(d)), T(0)));
    }
    Left stored() const override {
        auto const stored = filter_.stored();
        return Left().add("theta", filter_.theta()).add("F", stored.F).add("D", stored.D);
    }
    Left reported() const override {
        Left out;
        if constexpr (ReportsCovariance<F>) out.add("P", filter_.covariance());
        else if constexpr (ReportsInformation<F>) out.add("P", filter_.information());
        return out;
    }
    std::vector<Index> counts() const override {
        if constexpr (requires { filter_.counts().outliers; }) return twins::numbers_of(filter_.counts());
        else return {};
    }
    Bytes saved() const override {
        Bytes out(state_size(filter_));
        save(filter_, std::span(out));
        return out;
    }
    StateFault load(Bytes const& bytes) override { return rlslab::load(filter_, std::span(bytes)); }
};

/// Outliers, a change, a stretch of silence in which P winds up, and a NaN.
Records const& records();
Problem<double> problem_of(native::Options const& options);
Bytes saved(native::Filter const& f);
/// What the native layer says of a call that it refuses, or "no error".
std::string refusal(auto const& call) { return files::message_of<std::invalid_argument>(call); }
/// The filter that the options name is the typed one: in each row, many rows, rows of either arithmetic and rows apart
/// in memory; in what it says, its state, copies, reset and time that passes; in the lab's interface, too. What has a
/// window, a guard or a rule differs from the variant alone.
void expect_alike(Typed const& typed, native::Options options);

template <class T>
Problem<T> problem(double forgetting) {
    return {.size = d, .forgetting = T(forgetting), .prior = Prior<T>{.variance = T(64)}};
}
template <class T>
std::unique_ptr<native::Filter> made(std::string_view variant, native::Options options) {
    options.size = d;
    options.prior_variance = 64;
    return native::make(variant, ArithmeticTraits<T>::name, options);
}
template <class F>
    requires(!std::derived_from<F, Typed>)
void expect_alike(F const& filter, native::Options options) {
    expect_alike(static_cast<Typed const&>(TypedAs<F>(filter)), options);
}

}  // namespace rlslab::by_name
