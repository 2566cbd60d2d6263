// peer/NAME/ARITHMETIC/SIZE: the class Mine of the user's file RLSLAB_BENCH_MINE, which needs no header of ours.
#include RLSLAB_BENCH_MINE

#include "bench/rows.hpp"

namespace rlslab::bench {
namespace {

template <class F>
constexpr std::string_view name_of_class() {
    if constexpr (requires { F::name; }) return F::name;
    else return "mine";
}
template <class F>
struct ScalarOf {
    using type = double;
};
template <class F>
    requires requires { typename F::scalar; }
struct ScalarOf<F> {
    using type = typename F::scalar;
};

/// Mine(size, lambda, p0) or Mine(Problem); update(psi, y) of a pointer to the row or of a row; theta() is a pointer,
/// or has data() and size().
template <class Mine>
class Own {
public:
    using scalar = typename ScalarOf<Mine>::type;
    static constexpr std::string_view name = name_of_class<Mine>();

private:
    static_assert(std::same_as<scalar, double> || std::same_as<scalar, float>, "Mine::scalar is double or float");
    Index size_;
    mutable Mine mine_;  // for a theta() that is not const

    static Mine made(Problem<scalar> const& problem) {
        if constexpr (std::constructible_from<Mine, Problem<scalar> const&>) return Mine(problem);
        else return Mine(int(problem.size), problem.forgetting, problem.prior->variance);
    }

public:
    explicit Own(Problem<scalar> const& problem) : size_(problem.size), mine_(made(problem)) {}
    void update(Regressor<scalar> psi, scalar y) {
        if constexpr (requires { mine_.update(psi.data(), y); }) mine_.update(psi.data(), y);
        else mine_.update(psi, y);
    }
    Vector<scalar> theta() const {
        auto const& theta = mine_.theta();
        scalar const* numbers;
        if constexpr (requires { theta.data(); }) {
            if (Index(theta.size()) != size_) throw std::runtime_error("theta() of Mine has another size");
            numbers = theta.data();
        } else numbers = &theta[0];
        return Eigen::Map<Vector<scalar> const>(numbers, size_);
    }
};

Rows const added([] {
    for (Index size : choice().sizes) add_filter_row<Own<::Mine>>("peer", size);
});

}  // namespace
}  // namespace rlslab::bench
