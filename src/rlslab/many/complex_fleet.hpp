// Many filters of complex numbers, of several outputs each: the bins of a spectrum, as many in lockstep as a Pack has
// lanes.
#pragma once

#include <rlslab/core/complex.hpp>
#include <rlslab/many/threads.hpp>
#include <rlslab/state/lanes.hpp>

#include <tuple>
#include <vector>

namespace rlslab {

/// A variant over complex packs whose lanes have nothing in common but options.
template <class F>
concept ComplexInLockstep = ComplexScalar<typename F::scalar> && requires { RealOf<typename F::scalar>::lanes; } &&
                            NamesItsState<F> && !detail::counts_all_lanes_at_once<F>();

/// M filters of m outputs each, F a variant over Complex<Pack<T, L>>, such as Ud<Complex<Pack<float, 8>>>. With psi and
/// theta complex and psi' the conjugate transpose each filter is F of the number Complex<T>, bit for bit:
///
///   (1) e_j = y_j - psi'theta_j        (2) F's row: P, and K        (3) theta_j += K e_j,  residual gamma e_j
///
/// Output 1 is F's own theta; the others need d products for (1) and d for (3), and a form that reports P. A row with a
/// number that is not finite is missing: its filter stays as it was, its time does not pass, and no other filter
/// notices. Who holds a filter through silence passes NaN. Several outputs of forms that solve for theta, a prior but
/// c^2 I, and sizes that are no filter throw std::invalid_argument. An update allocates when it first meets a missing
/// row. Source: as MultiOutput and Fleet.
template <ComplexInLockstep F>
class ComplexFleet {
    using C = typename F::scalar;
    using pack = RealOf<C>;

public:
    using scalar = C;
    using real = typename pack::lane_type;
    using number = Complex<real>;
    static constexpr int lanes = pack::lanes;
    static constexpr std::string_view name = F::name;
    /// What a row did to M filters; each array has room, or is null. NaN, and nonfinite, where the row was missing.
    struct Steps {
        number *innovation = nullptr, *residual = nullptr;  ///< M x m: those of a filter side by side
        real* gamma = nullptr;                              ///< M
        Health* health = nullptr;                           ///< M: the worst of its outputs
    };

    ComplexFleet(Index filters, Problem<number> const& problem, Index outputs = 1)
        : size_(checked(problem, filters, outputs).size), filters_(filters), outputs_(outputs),
          fresh_(in_packs(problem)), packs_(size_t((filters + lanes - 1) / lanes), fresh_),
          further_(size_t(outputs - 1) * packs_.size() * size_t(size_), C(0)),
          health_(packs_.size(), problem.prior ? Health::sound : Health::undetermined) {}

    Index filters() const { return filters_; }  ///< M
    Index size() const { return size_; }        ///< d
    Index outputs() const { return outputs_; }  ///< m

    /// One row for each filter: psi is M x d and y M x m, those of a filter side by side. Returns how many rows were
    /// missing. threads: over how many the filters are divided; no bit depends on it.
    Index update(number const* psi, number const* y, Steps const& steps = {}, unsigned threads = 1) {
        Index const groups = Index(packs_.size()), shares = std::clamp<Index>(Index(threads), 1, groups);
        std::vector<Index> missing(size_t(shares), 0);
        detail::among_threads(shares, [&](Index share) {
            std::vector<C> row(size_t(size_ + 2 * outputs_));
            for (Index g = groups * share / shares; g < groups * (share + 1) / shares; ++g)
                missing[size_t(share)] += update_group(g, psi, y, steps, row.data());
        });
        Index sum = 0;
        for (Index const n : missing) sum += n;
        return sum;
    }

    /// Parameter k of output j of filter i; throws std::invalid_argument where there is none.
    number theta(Index i, Index k, Index j = 0) const {
        expects(0 <= i && i < filters_ && 0 <= k && k < size_ && 0 <= j && j < outputs_,
                "a filter, a parameter and an output that are there");
        size_t const g = size_t(i / lanes);
        C const x = j == 0 ? C(packs_[g].theta()[k]) : theta_of(g, j)[k];
        return {x.re[int(i % lanes)], x.im[int(i % lanes)]};
    }
    /// P of filter i, or P^-1, as F reports it.
    Matrix<number> matrix(Index i) const {
        expects(0 <= i && i < filters_, "the number of a filter that is there");
        F const& f = packs_[size_t(i / lanes)];
        auto const of_lane = [lane = int(i % lanes)](C const& x) { return number(x.re[lane], x.im[lane]); };
        if constexpr (ReportsCovariance<F>) return f.covariance().unaryExpr(of_lane);
        else return f.information().unaryExpr(of_lane);
    }
    /// Undetermined until its rows determine theta, then the worst of its steps.
    Health health(Index i) const {
        expects(0 <= i && i < filters_, "the number of a filter that is there");
        return health_[size_t(i / lanes)][int(i % lanes)];
    }
    /// Filter i, with its first output, as a filter of its own; only the gain of the last row is lost.
    auto filter(Index i) const {
        expects(0 <= i && i < filters_, "the number of a filter that is there");
        detail::LaneRead numbers(int(i % lanes));
        detail::walk(numbers, packs_[size_t(i / lanes)]);
        detail::OneLaneOf<F> out(Problem<number>{.size = size_});
        detail::LaneWritten written(0, true, numbers.values);
        detail::walk(written, out);
        return out;
    }

    static constexpr std::string_view layer = "complex fleet";
    static std::array<StateOption, 2> options(auto const& f) {
        return {{{"filters", double(f.filters_)}, {"outputs", double(f.outputs_)}}};
    }
    static auto state(auto& f) { return std::tie(f.fresh_, f.packs_, f.further_, f.health_); }

private:
    Index size_, filters_, outputs_;
    F fresh_;  // so that a state begins with d
    std::vector<F> packs_;
    std::vector<C> further_;  // theta of output j > 0 of group g: d numbers from ((m - 1) g + j - 1) d on
    std::vector<Lanes<Health, lanes>> health_;

    static Problem<number> const& checked(Problem<number> const& problem, Index filters, Index outputs) {
        expects(1 <= filters && filters <= std::numeric_limits<Index>::max() / (2 * lanes) && outputs >= 1,
                "a number of filters and of outputs, at least one");
        expects(outputs == 1 || ReportsCovariance<F>, "one output of a form that solves for theta");
        expects(!problem.prior || (!problem.prior->theta && !problem.prior->covariance), "theta0 = 0 and P0 = c^2 I");
        return problem;
    }
    static Problem<C> in_packs(Problem<number> const& problem) {
        Problem<C> out{.size = problem.size, .forgetting = pack(problem.forgetting)};
        if (problem.prior) out.prior->variance = pack(problem.prior->variance);
        else out.prior.reset();
        return out;
    }
    C* theta_of(size_t g, Index j) { return further_.data() + (Index(g) * (outputs_ - 1) + j - 1) * size_; }
    C const* theta_of(size_t g, Index j) const { return const_cast<ComplexFleet*>(this)->theta_of(g, j); }

    /// Number i of each filter's `count`, in lanes: behind the last filter as in its lane.
    C gathered(number const* from, Index first, Index count, Index i) const {
        real re[lanes], im[lanes];
        for (int lane = 0; lane < lanes; ++lane) {
            number const& x = from[std::min(first + lane, filters_ - 1) * count + i];
            re[lane] = x.re, im[lane] = x.im;
        }
        return {pack::loaded(re), pack::loaded(im)};
    }
    Index update_group(Index g, number const* psi, number const* y, Steps const& steps, C* row) {
        Index const first = g * lanes, here = std::min<Index>(lanes, filters_ - first);
        F& filter = packs_[size_t(g)];
        C *const y_of = row + size_, *const e_of = y_of + outputs_;
        Truth<C> present(true);
        for (Index i = 0; i < size_; ++i)
            row[i] = gathered(psi, first, size_, i), present = present && is_finite(row[i]);
        for (Index j = 0; j < outputs_; ++j)
            y_of[j] = gathered(y, first, outputs_, j), present = present && is_finite(y_of[j]);
        bool const whole = all(present);
        if (!whole) {
            for (Index i = 0; i < size_ + outputs_; ++i) row[i] = select(present, row[i], C(0));
        }
        Regressor<C> const regressor(row, size_);
        for (Index j = 1; j < outputs_; ++j) e_of[j] = y_of[j] - dot(row, theta_of(size_t(g), j), size_);  // (1)
        Step<C> step{undefined<C>(), undefined<C>(), undefined<pack>(), Health::nonfinite};
        if (any(present))
            step = detail::on_lanes<pack>(filter, present, [&] { return filter.update(regressor, y_of[0]); });  // (2)
        PerLane<C, Health> health = step.health;
        if constexpr (ReportsCovariance<F>)
            if (outputs_ > 1 && any(present)) {
                auto const& K = filter.gain();
                for (Index j = 1; j < outputs_; ++j) {  // (3)
                    C* const theta = theta_of(size_t(g), j);
                    for (Index k = 0; k < size_; ++k) {
                        C const more = e_of[j] * K[k];
                        theta[k] = select(present, theta[k] + more, theta[k]);
                    }
                    Step<C> const own = step_of(e_of[j], step.gamma);
                    for (int lane = 0; lane < lanes; ++lane)
                        health.value[size_t(lane)] = worse(health[lane], own.health[lane]);
                }
            }
        Index missing = 0;
        for (int lane = 0; lane < here; ++lane) {
            Health& mine = health_[size_t(g)].value[size_t(lane)];
            bool const taken = present[lane];
            missing += !taken;
            if (taken) mine = mine == Health::undetermined ? health[lane] : worse(mine, health[lane]);
            if (steps.health) steps.health[first + lane] = taken ? health[lane] : Health::nonfinite;
            if (steps.gamma) steps.gamma[first + lane] = taken ? step.gamma[lane] : undefined<real>();
        }
        e_of[0] = step.innovation;
        for (Index j = 0; j < outputs_; ++j) {
            C const residual = j == 0 ? step.residual : step.gamma * e_of[j];
            report(steps.innovation, e_of[j], first, here, j, present);
            report(steps.residual, residual, first, here, j, present);
        }
        return missing;
    }
    void report(number* to, C const& x, Index first, Index here, Index j, Truth<C> const& present) const {
        if (!to) return;
        for (int lane = 0; lane < here; ++lane)
            to[(first + lane) * outputs_ + j] =
                present[lane] ? number(x.re[lane], x.im[lane]) : number(undefined<real>(), undefined<real>());
    }
};

}  // namespace rlslab
