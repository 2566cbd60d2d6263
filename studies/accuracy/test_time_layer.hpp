// A layer that solves least squares at each token: its keys, its exact answers, and what a stored state answers.
#pragma once

#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/core/stored.hpp>
#include <rlslab/linalg/storage.hpp>

namespace rlslab::studies {

/// H = sum_t g^(N-t) k_t k_t' and G = sum_t g^(N-t) v_t k_t' of N tokens; the layer answers G x with
/// x = (H + ridge I)^-1 q.
struct Layer {
    static constexpr double ridge = 0.25;
    static constexpr Index channels = 8, queries = 4;  // queries of each kind

    double gate;
    Matrix<double> keys;     ///< d x N, of norm 1 but for their rounding to bfloat16
    Matrix<double> H, G, Q;  ///< in double; Q: white queries, then as many that are drawn as the keys are
    double error_of_H;       ///< a bound of ||H - exact H||_2: 3 u N min(N, 1 / (1 - g)), since each row rounds three
                             ///< times and no partial sum has a larger norm

    /// Keys V diag(kappa^(-i/(d-1))) w, w white, V orthogonal and drawn; v = W k + noise of the same variance, W drawn.
    /// `stored` is how a word stores a number: keys are given to it in bfloat16, and a word that computes has its own.
    Layer(Index size, Index rows, double kappa, double gate, double (*stored)(double), Seed seed);
    /// The ridge of a prior I / ridge that fades with the gate.
    double faded_ridge() const;
    double norm_of_H() const;
};

/// The answers to all queries, and how far off they may be.
struct Answers {
    Matrix<double> X;
    bool definite = true;
    double bound = 0;  ///< of the relative error: see exact_answers
};
/// (H + ridge I)^-1 Q by factors in double. The bound is (||r|| + ||H - exact H|| ||x|| + rounding of r) / (m ||x||)
/// with m = `least`, a lower bound of the least eigenvalue: the ridge itself, which proves it; or, for least = 0, 1 /
/// ||(H + ridge I)^-1||_F as computed, an estimate.
Answers exact_answers(Layer const& layer, double ridge, double least);
/// What a stored state answers: a stored P by products, a stored H or its factor with the ridge by factors in double.
Answers answers_of(Stored<double> const& state, double ridge, Matrix<double> const& Q);

/// sum ||x_j - xhat_j||^2 / sum ||x_j||^2 over columns [first, first + n), its root; infinite for what is no number.
double relative_error(Matrix<double> const& exact, Matrix<double> const& found, Index first, Index n);

/// H = g H + k k', its upper triangle, each operation in T.
template <class T>
struct Gram {
    T gate;
    StateMatrix<T> H;
    static auto state(auto& f) { return std::tie(f.H); }

    Gram(double g, Index d) : gate(round_to<T>(g)), H(d) {}
    void update(Vector<T> const& k, T const&) {
        for (Index j = 0; j < k.size(); ++j)
            for (Index i = 0; i <= j; ++i) H(i, j) = gate * H(i, j) + k[i] * k[j];
    }
    Stored<T> stored() const {
        Matrix<T> full = H.view();
        for (Index j = 0; j < H.size(); ++j)
            for (Index i = 0; i < j; ++i) full(j, i) = full(i, j);
        return {Stored<T>::Quantity::information, Stored<T>::Form::plain, full};
    }
};

/// 30 steps of conjugate gradients, and of Chebyshev's iteration on [ridge, ridge + ||H||_F], each operation in T. The
/// first stop where a direction has no positive curvature.
template <class T>
class Solver {
    Matrix<T> F_;
    Vector<T> D_;
    bool factor_;
    Index d_;
    T ridge_;

    static T dot(Vector<T> const& a, Vector<T> const& b) {
        T sum(0);
        for (Index i = 0; i < a.size(); ++i) sum += a[i] * b[i];
        return sum;
    }
    static void add(Vector<T>& x, T const& a, Vector<T> const& y) {
        for (Index i = 0; i < x.size(); ++i) x[i] += a * y[i];
    }

public:
    static constexpr int steps = 30;

    Solver(Stored<double> const& state, double ridge)
        : F_(state.F.unaryExpr([](double x) { return T(x); })), D_(state.D.unaryExpr([](double x) { return T(x); })),
          factor_(state.form == Stored<double>::Form::factor), d_(F_.rows()), ridge_(T(ridge)) {}

    T norm() const {
        using std::sqrt;
        T sum(0);
        for (Index j = 0; j < d_; ++j)
            for (Index i = 0; i < d_; ++i) sum += F_(i, j) * F_(i, j);
        return sqrt(sum);
    }
    /// F p, or F diag(D) F'p, and the ridge times p.
    Vector<T> times(Vector<T> const& p, bool with_ridge = true) const {
        Vector<T> t = p, out(d_);
        if (factor_)
            for (Index j = 0; j < d_; ++j) {
                t[j] = T(0);
                for (Index i = 0; i < d_; ++i) t[j] += F_(i, j) * p[i];
                if (D_.size() > 0) t[j] *= D_[j];
            }
        for (Index i = 0; i < d_; ++i) out[i] = with_ridge ? ridge_ * p[i] : T(0);
        for (Index j = 0; j < d_; ++j) add_column(out, t[j], j);
        return out;
    }
    Vector<T> conjugate_gradients(Vector<T> const& q) const {
        Vector<T> x(d_), r = q, p = q;
        for (T& number : x) number = T(0);
        T rr = dot(r, r);
        for (int i = 0; i < steps; ++i) {
            Vector<T> const w = times(p);
            T const pw = dot(p, w);
            if (!(T(0) < pw)) break;
            T const a = rr / pw;
            add(x, a, p), add(r, -a, w);
            T const next = dot(r, r), b = next / rr;
            for (Index j = 0; j < d_; ++j) p[j] = r[j] + b * p[j];
            rr = next;
        }
        return x;
    }
    Vector<T> chebyshev(Vector<T> const& q) const {
        T const delta = norm() / T(2), theta = ridge_ + delta, sigma = theta / delta;
        T rho = T(1) / sigma;
        Vector<T> x(d_), r = q, step(d_);
        for (T& number : x) number = T(0);
        for (Index j = 0; j < d_; ++j) step[j] = r[j] / theta;
        for (int i = 0; i < steps; ++i) {
            add(x, T(1), step), add(r, T(-1), times(step));
            T const next = T(1) / (T(2) * sigma - rho), kept = next * rho, fresh = T(2) * next / delta;
            for (Index j = 0; j < d_; ++j) step[j] = kept * step[j] + fresh * r[j];
            rho = next;
        }
        return x;
    }
    /// Column by column of Q.
    template <class Solve>
    Answers all(Matrix<double> const& Q, Solve solve) const {
        Answers out{Matrix<double>(Q.rows(), Q.cols())};
        Vector<T> q(d_);
        for (Index c = 0; c < Q.cols(); ++c) {
            for (Index i = 0; i < d_; ++i) q[i] = T(Q(i, c));
            Vector<T> const x = solve(q);
            for (Index i = 0; i < d_; ++i) out.X(i, c) = static_cast<double>(x[i]);
        }
        return out;
    }

private:
    void add_column(Vector<T>& out, T const& a, Index j) const {
        for (Index i = 0; i < d_; ++i) out[i] += F_(i, j) * a;
    }
};

}  // namespace rlslab::studies
