// What people write with Eigen: peer/eigen_textbook/double/SIZE, fixed/eigen_textbook_fixed/double/SIZE,
// peer/eigen_householder/ROWSxSIZE, and the normal equations, peer/normal_equations/ROWSxSIZE.
#include "bench/rows.hpp"

#include <Eigen/Dense>
#include <rlslab/core/type_list.hpp>

namespace rlslab::bench {
namespace {

using Eigen::MatrixXd, Eigen::VectorXd;

template <int N>
class EigenTextbook {
    using Vec = Eigen::Matrix<double, N, 1>;
    using Mat = Eigen::Matrix<double, N, N>;
    double lambda_;
    Vec theta_;
    Mat P_;

public:
    using scalar = double;
    static constexpr Index size = N;
    static constexpr std::string_view name = N == Dynamic ? "eigen_textbook" : "eigen_textbook_fixed";

    explicit EigenTextbook(Problem<double> const& problem)
        : lambda_(problem.forgetting), theta_(Vec::Zero(problem.size)),
          P_(problem.prior->variance * Mat::Identity(problem.size, problem.size)) {}
    void update(Regressor<double> row, double y) {
        Eigen::Map<Vec const> const psi(row.data(), row.size());
        Vec const K = P_ * psi / (lambda_ + psi.dot(P_ * psi));
        theta_ += K * (y - psi.dot(theta_));
        P_ = (P_ - K * psi.transpose() * P_) / lambda_;  // (K psi') P: cubic, as it stands in many a repository
    }
    Vec const& theta() const { return theta_; }
};

/// In place, on a tall matrix by columns: the fastest it offers. What is destroyed is copied outside the time.
void add_householder() {
    add_batch_rows(
        "peer/eigen_householder",
        [](Records const& records) { return std::pair(MatrixXd(records.psi.transpose()), &records.y); },
        [](auto& input) -> VectorXd {
            Eigen::HouseholderQR<Eigen::Ref<MatrixXd>> const qr(input.first);
            return qr.solve(*input.second);
        });
}

void add_normal_equations() {
    add_batch_rows(
        "peer/normal_equations", [](Records const& records) { return &records; },
        [](Records const* records) -> VectorXd {
            MatrixXd M = MatrixXd::Zero(records->parameters(), records->parameters());
            M.selfadjointView<Eigen::Lower>().rankUpdate(records->psi);
            return M.selfadjointView<Eigen::Lower>().llt().solve(records->psi * records->y);
        });
}

Rows const added([] {
    for (Index size : choice().sizes) add_filter_row<EigenTextbook<Dynamic>>("peer", size);
    for_each(TypeList<EigenTextbook<2>, EigenTextbook<3>, EigenTextbook<4>, EigenTextbook<6>, EigenTextbook<8>>{},
             []<class F>() { add_filter_row<F>("fixed", F::size); });
    add_householder();
    add_normal_equations();
});

}  // namespace
}  // namespace rlslab::bench
