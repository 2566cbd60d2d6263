// The operation counts: each variant's own text, run on the Counted scalar.
#include <rlslab/catalogue/catalogue.hpp>

#include <rlslab/arithmetic/counted.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab {
namespace {

/// One update, or a block, after 2d + 1 rows of noise: past the zeros of the start; then theta().
template <class F>
Cost counted_cost(Index d) {
    using T = typename F::scalar;
    F filter(Problem<T>{.size = d, .forgetting = T(0.99)});
    Seed seed{1};
    auto const noise = [&seed](Index n) {
        return Vector<T>(Vector<T>::NullaryExpr(n, [&seed] { return T(seed.bell()); }));
    };
    for (Index k = 0; k < 2 * d + 1; ++k) filter.update(noise(d), T(seed.bell()));
    auto const per_row = [](Tally const& t, long rows) {
        return Operations{t.additions / rows, t.multiplications / rows, t.divisions / rows, t.square_roots / rows};
    };
    Cost cost;
    long rows = 1;
    if constexpr (TakesBlocks<F>) {
        rows = F::block;
        Matrix<T> psi(d, F::block);
        for (Index k = 0; k < F::block; ++k) psi.col(k) = noise(d);
        Vector<T> const y = noise(F::block);
        cost.update = per_row(counted([&] { filter.update_block(psi, y); }), rows);
    } else {
        Vector<T> const psi = noise(d);
        T const y(seed.bell());
        cost.update = per_row(counted([&] { filter.update(psi, y); }), rows);
    }
    cost.theta = per_row(counted([&] { Vector<T> const theta = filter.theta(); }), rows);
    return cost;
}

}  // namespace

std::optional<Cost> cost(std::string_view variant, Index size) {
    std::optional<Cost> out;
    for_each(Variants<Counted<double>>{}, [&]<class F>() {
        if (F::name == variant) out = counted_cost<F>(size);
    });
    return out;
}

}  // namespace rlslab
