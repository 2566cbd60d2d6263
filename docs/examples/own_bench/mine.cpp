// The update that one writes in an afternoon. A file for the benchmarks has a class Mine and needs nothing of rlslab.
#include <vector>

class Mine {
    int d_;
    double lambda_;
    std::vector<double> theta_, P_, f_;

public:
    using scalar = double;
    static constexpr char const* name = "textbook";

    /// d parameters, theta0 = 0 and P0 = p0 I
    Mine(int d, double lambda, double p0) : d_(d), lambda_(lambda), theta_(d), P_(d * d), f_(d) {
        for (int i = 0; i < d; ++i) P_[i * d + i] = p0;
    }
    /// f = P psi, s = lambda + psi'f, theta += f (y - psi'theta) / s, P = (P - f f' / s) / lambda
    void update(double const* psi, double y) {
        double s = lambda_, e = y;
        for (int i = 0; i < d_; ++i) {
            f_[i] = 0;
            for (int j = 0; j < d_; ++j) f_[i] += P_[i * d_ + j] * psi[j];
            s += psi[i] * f_[i];
            e -= psi[i] * theta_[i];
        }
        for (int i = 0; i < d_; ++i) {
            theta_[i] += f_[i] / s * e;
            for (int j = 0; j < d_; ++j) P_[i * d_ + j] = (P_[i * d_ + j] - f_[i] * f_[j] / s) / lambda_;
        }
    }
    double const* theta() const { return theta_.data(); }
};
