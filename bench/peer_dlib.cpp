// peer/dlib/double/SIZE and large/dlib/double/SIZE: dlib::rls, P0 = C I.
#include "bench/large.hpp"

#include <dlib/svm/rls.h>

namespace rlslab::bench {
namespace {

/// Its cheap mode: with the forgetting applied to C as well it does what everybody else does; without, it adds d
/// rank-one updates to each row.
class Dlib {
    dlib::rls rls_;
    dlib::matrix<double, 0, 1> psi_;  // what its users hold; the copy is d of its 5 d^2 moves

public:
    using scalar = double;
    static constexpr std::string_view name = "dlib";

    explicit Dlib(Problem<double> const& problem)
        : rls_(problem.forgetting, problem.prior->variance, true), psi_(problem.size) {}
    void update(Regressor<double> psi, double y) {
        for (Index i = 0; i < psi.size(); ++i) psi_(i) = psi[i];
        rls_.train(psi_, y);
    }
    auto theta() const { return Eigen::Map<Vector<double> const>(&rls_.get_w()(0), rls_.get_w().size()); }
};

Rows const added([] {
    for (Index size : choice().sizes) add_filter_row<Dlib>("peer", size);
    add_large_rows<Dlib>();
});

}  // namespace
}  // namespace rlslab::bench
