// peer/NAME/ARITHMETIC/SIZE: the class Mine of the user's file RLSLAB_BENCH_MINE, which needs no header of ours.
#include "bench/rows.hpp"

#include <span>

#include RLSLAB_BENCH_MINE

namespace rlslab::bench {
namespace {

template <class F>
consteval std::string_view name_of_class() {
    if constexpr (requires { std::string_view(F::name); }) return F::name;
    else if constexpr (requires { std::string_view(F::name()); }) return F::name();
    else if constexpr (requires { &F::name; }) static_assert(sizeof(F) == 0, "Mine::name is a static constexpr text");
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

/// Mine(size, lambda, p0) or Mine(Problem); update(psi, y) of a pointer to the row, a span, a vector of Eigen or a row
/// of rlslab; theta() has numbers by [i]. Copies are independent.
template <class Mine>
class Own {
public:
    using scalar = typename ScalarOf<Mine>::type;
    static constexpr std::string_view name = name_of_class<Mine>();

private:
    static_assert(std::same_as<scalar, double> || std::same_as<scalar, float>, "Mine::scalar is double or float");
    static_assert(!name.empty() && name.size() <= 22 && name.find_first_of("/,\" \n") == name.npos,
                  "Mine::name has 1 to 22 characters, no space, comma, quote or slash");
    static_assert(std::copy_constructible<Mine>, "Mine is copied: each repetition starts from the same state");
    Index size_;
    mutable std::optional<Mine> mine_;  // for a theta() that is not const

    static Mine made(Problem<scalar> const& problem) {
        if constexpr (std::constructible_from<Mine, Problem<scalar> const&>) return Mine(problem);
        else return Mine(int(problem.size), problem.forgetting, problem.prior->variance);
    }

public:
    explicit Own(Problem<scalar> const& problem) : size_(problem.size), mine_(made(problem)) {}
    Own(Own const&) = default;
    Own& operator=(Own const& other) {
        if constexpr (std::is_copy_assignable_v<Mine>) *mine_ = *other.mine_;
        else mine_.emplace(*other.mine_);
        return *this;
    }
    void update(Regressor<scalar> psi, scalar y) {
        using Row = Eigen::Map<Vector<scalar> const>;
        using Span = std::span<scalar const>;
        if constexpr (requires(scalar const* row) { mine_->update(row, y); }) mine_->update(psi.data(), y);
        else if constexpr (requires(Row row) { mine_->update(row, y); }) mine_->update(Row(psi.data(), psi.size()), y);
        else if constexpr (requires(Span row) { mine_->update(row, y); }) mine_->update(Span(psi.data(), size_), y);
        else if constexpr (requires { mine_->update(psi, y); }) mine_->update(psi, y);
        else static_assert(sizeof(Mine) == 0, "Mine has no update(scalar const* psi, scalar y)");
    }
    Vector<scalar> theta() const {
        auto const& theta = mine_->theta();
        if constexpr (requires { theta.size(); })
            if (Index(theta.size()) != size_) throw std::runtime_error("theta() of Mine has another size");
        Vector<scalar> out(size_);
        for (Index i = 0; i < size_; ++i) out[i] = scalar(theta[i]);
        return out;
    }
};

Rows const added([] {
    has_mine = true;
    for (Index size : choice().sizes) add_filter_row<Own<::Mine>>("peer", size);
});

}  // namespace
}  // namespace rlslab::bench
