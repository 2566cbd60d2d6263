// Puts a filter of any type behind the type-erased interface, and makes its entry for the catalogue.
#pragma once

#include <rlslab/state/state_file.hpp>
#include <rlslab/core/process.hpp>
#include <rlslab/catalogue/any_filter.hpp>
#include <rlslab/catalogue/relative_errors.hpp>
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/catalogue/timing.hpp>

namespace rlslab {

template <class T>
Reference widened(T const& x) {
    return widen(x);
}
template <class T>
double in_double(T const& x) {
    return static_cast<double>(x);
}
/// psi as T stores it.
template <class T>
Vector<T> rounded(Regressor<double> psi) {
    return Eigen::Map<Vector<double> const>(psi.data(), psi.size()).unaryExpr(&round_to<T>);
}
/// The stored numbers rounded to binary64, except that a nonzero number never becomes zero: the zeros of a factor
/// decide whether it is a triangle, and whether it is singular.
template <class T>
Stored<double> in_double(Stored<T> const& stored) {
    return stored.template mapped<double>([](T const& x) {
        double const y = static_cast<double>(x);
        double const least = std::numeric_limits<double>::denorm_min();
        return y != 0 || x == T(0) ? y : x < T(0) ? -least : least;
    });
}

/// The state of f as bytes, and back. Throws InputError in one line for other bytes.
template <NamesItsState F>
std::vector<std::byte> saved_bytes(F const& f) {
    std::vector<std::byte> out(state_size(f));
    save(f, std::span(out));
    return out;
}
template <NamesItsState F>
void load_bytes(F& f, std::span<std::byte const> from) {
    if (StateFault const fault = load(f, from); fault != StateFault::none)
        throw InputError(refusal(fault, state_header(f), state_entries(f), from));
}

/// F is a variant, or what is composed around one (composed.cpp).
template <class F, class Interface = AnyFilter>
class Erased : public Interface {
    using T = typename F::scalar;
    static constexpr bool at_run_time = std::same_as<T, VariablePrecision>;
    static constexpr bool keeps_more = at_run_time || DataRounding<T>::stochastic;  // than the filter

protected:
    F filter_;

private:
    Seed seed_;
    [[no_unique_address]] ArithmeticOfNow<T> arithmetic_;

    /// While it exists, this thread computes as the filter does; random bits come from `seed`.
    class Within {
        typename ArithmeticOfNow<T>::In arithmetic_;
        RoundingSeedScope<T> draws_;

    public:
        Within(Erased const& filter, Seed& seed) : arithmetic_(filter.arithmetic_), draws_(seed) {}
    };

    static Step<double> step_in_double(Step<T> const& s) {
        return {in_double(s.innovation), in_double(s.residual), in_double(s.gamma), s.health};
    }

public:
    using scalar = T;
    static constexpr std::string_view name = F::name;
    static constexpr std::string_view layer = at_run_time ? "format" : "stream";
    static constexpr int edition = detail::edition_of<F>();
    /// Where it keeps more: the filter, and its stream.
    static auto state(auto& e) { return std::tie(e.filter_, e.seed_); }
    /// Length and range stand in the state's header.
    static auto options(auto const& e)
        requires at_run_time
    {
        return std::array{StateOption{"rounding", double(int(e.arithmetic_.format.rounding))}};
    }

    /// The seed is in use already here: the start from a prior rounds too.
    static std::unique_ptr<AnyFilter> make(Problem<double> const& problem, Seed seed) {
        RoundingSeedScope<T> const draws(seed);
        return std::make_unique<Erased>(F(problem_as<T>(problem)), seed);
    }
    Erased(F filter, Seed seed) : filter_(std::move(filter)), seed_(seed) {}

    Step<double> take(Regressor<double> psi, double y, Matrix<double> const* relative) override {
        Within const within(*this, seed_);
        if (!relative) return step_in_double(filter_.update(rounded<T>(psi), round_to<T>(y)));
        if constexpr (GainPerturbable<F>) {
            Index const columns = relative->cols();
            expects(relative->rows() == psi.size() && (columns == 1 || columns == psi.size()),
                    "an error for each number of the gain");
            return step_in_double(filter_.update(rounded<T>(psi), round_to<T>(y),
                                                 RelativeErrors<T>{*relative, std::vector<T>(size_t(psi.size()))}));
        } else {
            throw std::invalid_argument("expected a variant that uses its gain in the update of P, not " +
                                        std::string(F::name));
        }
    }
    Step<double> update_block(Records const& records, Index first, Index last) override {
        Within const within(*this, seed_);
        Matrix<T> const psi = records.psi.middleCols(first, last - first).unaryExpr(&round_to<T>);
        Vector<T> const y = records.y.segment(first, last - first).unaryExpr(&round_to<T>);
        return step_in_double(process(filter_, psi, y));
    }
    // Reports draw from a copy of the seed, so that they do not change later results.
    typename Interface::Report report(typename Interface::Number what) const override {
        if (what == Interface::Number::stored) return filter_.stored().template mapped<Reference>(&widened<T>);
        if (what == Interface::Number::stored_in_double) return in_double(filter_.stored());
        Seed copy = seed_;
        Within const within(*this, copy);
        Vector<T> const numbers =
            what == Interface::Number::theta ? Vector<T>(filter_.theta()) : Vector<T>(filter_.gain());
        return Vector<Reference>(numbers.unaryExpr(&widened<T>));
    }
    std::unique_ptr<AnyFilter> clone() const override {
        if constexpr (std::is_abstract_v<Erased>) throw std::logic_error("what has more to say copies itself");
        else return std::make_unique<Erased>(*this);
    }
    std::vector<std::byte> saved() const override {
        typename ArithmeticOfNow<T>::In const arithmetic(arithmetic_);
        if constexpr (keeps_more) return saved_bytes(*this);
        else return saved_bytes(filter_);
    }
    void load(std::span<std::byte const> from) override {
        typename ArithmeticOfNow<T>::In const arithmetic(arithmetic_);
        if constexpr (keeps_more) load_bytes(*this, from);
        else load_bytes(filter_, from);
    }
};

/// The least time per row over stretches of the records, each measured as in the benchmarks.
template <class F>
double nanoseconds(Problem<double> const& problem, Records const& records, Seed seed) {
    using T = typename F::scalar;
    constexpr double enough = 5e5;  // ns of undisturbed timing in all
    constexpr int at_least = 8;     // stretches: other processes disturb some of them
    Matrix<T> const psi = records.psi.unaryExpr(&round_to<T>);
    Vector<T> const y = records.y.unaryExpr(&round_to<T>);
    Index rows = std::min<Index>(records.rows(), 16);
    if constexpr (TakesBlocks<F>) rows = std::min<Index>(records.rows(), F::block);
    RoundingSeedScope<T> const draws(seed);
    double least = std::numeric_limits<double>::infinity();
    int stretches = 0;
    auto const unsettled = [&] { return stretches < at_least || least * double(stretches * rows) < enough; };
    do {
        F filter(problem_as<T>(problem));
        for (Index k = 0; k + rows <= records.rows() && unsettled(); k += rows, ++stretches) {
            double took;
            if constexpr (TakesBlocks<F>) {
                Matrix<T> const block = psi.middleCols(k, rows);
                Vector<T> const outputs = y.segment(k, rows);
                took = nanoseconds_of([&] {
                    process(filter, block, outputs);
                    do_not_optimize(Vector<T>(filter.theta()));
                });
            } else {
                took = stretch<Theta::asked>(filter, psi, y, k, k + rows);
            }
            least = std::min(least, took / double(rows));
        }
    } while (unsettled());
    return least;
}

/// F's entry in a list whose filters nobody times.
template <RecursiveLeastSquares F>
CatalogueEntry untimed_entry_of(Arithmetic const* arithmetic) {
    Index block = 1;
    if constexpr (TakesBlocks<F>) block = F::block;
    return {F::name,
            arithmetic,
            StartsWithoutPrior<F>,
            block,
            ReportsCovariance<F> ? "covariance" : "information",
            GainPerturbable<F>,
            F::family,
            &Erased<F>::make,
            nullptr};
}
/// F's entry in the catalogue.
template <RecursiveLeastSquares F>
CatalogueEntry entry_of(Arithmetic const* arithmetic) {
    CatalogueEntry entry = untimed_entry_of<F>(arithmetic);
    entry.time = &nanoseconds<F>;
    return entry;
}

/// The properties of T as data.
template <class T>
Arithmetic arithmetic_of() {
    using Traits = ArithmeticTraits<T>;
    return {Traits::name,           Traits::digits, Traits::min_exp, Traits::max_exp, DataRounding<T>::stochastic,
            &DataRounding<T>::round};
}

}  // namespace rlslab
