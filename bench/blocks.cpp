// Blocks of rows, many outputs: our forms beside OpenBLAS and LAPACK, in turns.
//   rlslab_bench_blocks [--outputs M] [--blocks B] [--rounds N] [--gamma G] [--threads T] [SIZE...]
//       a table for each size: microseconds a row, the median over the rounds and the range; beside that of P -= K G'
//       in double; the share of OpenBLAS' rate of the products d x d by d x 256 that it reaches; digits of the first
//       theta, beside double's Cholesky refined in long double
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/many/threads.hpp>
#include <rlslab/variants/variants.hpp>

#include <Eigen/src/misc/blas.h>
#include <Eigen/src/misc/lapacke.h>
#include <Eigen/Cholesky>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

extern "C" {
char* openblas_get_corename();
void openblas_set_num_threads(int threads);
void stpqrt_(int* m, int* n, int* l, int* nb, float* a, int* lda, float* b, int* ldb, float* t, int* ldt, float* work,
             int* info);  // which Eigen's lapacke.h leaves out
}

namespace rlslab::bench {
namespace {

constexpr int k = 256, panel = 32;  // rows of a block; columns that LAPACK's tpqrt reflects together
int outputs = 100, blocks = 8, rounds = 5;
double regularisation = 1;  // gamma: P0 = I / gamma

template <class T>
struct Library;
template <>
struct Library<double> {
    static constexpr auto gemm = dgemm_;
    static constexpr auto trsm = dtrsm_;
    static constexpr auto potrf = LAPACK_dpotrf;
    static constexpr auto tpqrt = LAPACK_dtpqrt;
    static constexpr auto tpmqrt = LAPACK_dtpmqrt;
};
template <>
struct Library<float> {
    static constexpr auto gemm = sgemm_;
    static constexpr auto trsm = strsm_;
    static constexpr auto potrf = LAPACK_spotrf;
    static constexpr auto tpqrt = stpqrt_;
    static constexpr auto tpmqrt = LAPACK_stpmqrt;
};
/// C = a A B + c C, A and B turned (T) or not (N).
template <class T>
void gemm(char A_as, char B_as, T a, Matrix<T> const& A, Matrix<T> const& B, T c, Matrix<T>& C) {
    int const depth = int(A_as == 'N' ? A.cols() : A.rows()), rows = int(C.rows()), columns = int(C.cols());
    int const lda = int(A.rows()), ldb = int(B.rows());
    Library<T>::gemm(&A_as, &B_as, &rows, &columns, &depth, &a, A.data(), &lda, B.data(), &ldb, &c, C.data(), &rows);
}
template <class T>
void trsm(char side, char triangle, char as, Matrix<T> const& A, Matrix<T>& B) {
    int const rows = int(B.rows()), columns = int(B.cols()), lda = int(A.rows());
    T const one = 1;
    Library<T>::trsm(&side, &triangle, &as, "N", &rows, &columns, &one, A.data(), &lda, B.data(), &rows);
}
template <class T>
void cholesky(Matrix<T>& A) {
    int n = int(A.rows()), info = 0;
    char lower = 'L';
    Library<T>::potrf(&lower, &n, A.data(), &n, &info);
    if (info != 0) A.setConstant(std::numeric_limits<T>::quiet_NaN());
}

/// What people run: P -= K G'.
template <class T>
struct Subtract {
    Matrix<T> P, theta, G, K, S, E;
    explicit Subtract(int d)
        : P(T(1 / regularisation) * Matrix<T>::Identity(d, d)), theta(Matrix<T>::Zero(d, outputs)), G(d, k) {}
    void take(Matrix<T> const& X, Matrix<T> const& Y) {
        gemm<T>('N', 'N', 1, P, X, 0, G);
        S = Matrix<T>::Identity(k, k);
        gemm<T>('T', 'N', 1, X, G, 1, S);
        cholesky(S);
        K = G;
        trsm('R', 'L', 'T', S, K);
        trsm('R', 'L', 'N', S, K);
        gemm<T>('N', 'T', -1, K, G, 1, P);
        E = Y;
        gemm<T>('T', 'N', -1, X, theta, 1, E);
        gemm<T>('N', 'N', 1, K, E, 1, theta);
    }
    Matrix<T> solved() const { return theta; }
};
/// X X' and Cholesky in double, once or after each block.
template <bool each>
struct Gram {
    Matrix<double> H, b, L, theta;
    explicit Gram(int d) : H(regularisation * Matrix<double>::Identity(d, d)), b(Matrix<double>::Zero(d, outputs)) {}
    void take(Matrix<double> const& X, Matrix<double> const& Y) {
        int const d = int(X.rows()), rows = k;
        double const one = 1;
        dsyrk_("L", "N", &d, &rows, &one, X.data(), &d, &one, H.data(), &d);
        gemm<double>('N', 'N', 1, X, Y, 1, b);
        if (each) solved();
    }
    Matrix<double> solved() {
        L = H, theta = b;
        cholesky(L);
        trsm('L', 'L', 'N', L, theta);
        trsm('L', 'L', 'T', L, theta);
        return theta;
    }
};
/// LAPACK's QR of a triangle and k rows below it.
template <class T>
struct Tpqrt {
    Matrix<T> R, z, B, Y_, W, work;
    explicit Tpqrt(int d)
        : R(T(std::sqrt(regularisation)) * Matrix<T>::Identity(d, d)), z(Matrix<T>::Zero(d, outputs)), W(panel, d),
          work(panel, std::max(d, outputs)) {}
    void take(Matrix<T> const& X, Matrix<T> const& Y) {
        int d = int(X.rows()), rows = k, none = 0, nb = panel, m = outputs, info = 0;
        char left = 'L', turned = 'T';
        B = X.transpose(), Y_ = Y;
        Library<T>::tpqrt(&rows, &d, &none, &nb, R.data(), &d, B.data(), &rows, W.data(), &nb, work.data(), &info);
        Library<T>::tpmqrt(&left, &turned, &rows, &m, &d, &none, &nb, B.data(), &rows, W.data(), &nb, z.data(), &d,
                           Y_.data(), &rows, work.data(), &info);
    }
    Matrix<T> solved() const {
        Matrix<T> theta = z;
        trsm('L', 'U', 'N', R, theta);
        return theta;
    }
};
/// LAPACK's QR of [R; X'], the zeros of R included.
struct Geqrf {
    Matrix<double> A, z, tau, work;
    explicit Geqrf(int d)
        : A(Matrix<double>::Zero(d + k, d)), z(Matrix<double>::Zero(d + k, outputs)), tau(d, 1),
          work(64 * std::max(d, outputs), 1) {
        A.diagonal().setConstant(std::sqrt(regularisation));
    }
    void take(Matrix<double> const& X, Matrix<double> const& Y) {
        int d = int(X.rows()), rows = d + k, m = outputs, room = int(work.size()), info = 0;
        char left = 'L', turned = 'T';
        for (int j = 0; j < d; ++j) A.col(j).segment(j + 1, d - j - 1).setZero();
        A.bottomRows(k) = X.transpose(), z.bottomRows(k) = Y;
        LAPACK_dgeqrf(&rows, &d, A.data(), &rows, tau.data(), work.data(), &room, &info);
        LAPACK_dormqr(&left, &turned, &rows, &m, &d, A.data(), &rows, tau.data(), z.data(), &rows, work.data(), &room,
                      &info);
    }
    Matrix<double> solved() const {
        Matrix<double> const R = A.topRows(A.cols());
        Matrix<double> theta = z.topRows(A.cols());
        trsm('L', 'U', 'N', R, theta);
        return theta;
    }
};
template <class F>
struct Ours {
    using T = typename F::scalar;
    MultiOutput<F> f;
    explicit Ours(int d)
        : f(Problem<T>{.size = d, .prior = Prior<T>{.variance = T(1 / regularisation)}}, Index(outputs)) {}
    void take(Matrix<T> const& X, Matrix<T> const& Y) { f.update_block(X, Y); }
    Matrix<T> solved() const { return f.theta(); }
};

/// Random features max(0, W z + noise) of 64 inputs; y is linear in z, plus noise. All numbers are floats.
struct Data {
    Matrix<float> X, Y;
    Vector<double> theta;  // of the first output
    explicit Data(int d) : X(d, blocks * k), Y(X.cols(), outputs) {
        Seed seed{47};
        auto const bells = [&](Index rows, Index columns) {
            Matrix<float> out(rows, columns);
            for (Index i = 0; i < out.size(); ++i) out.data()[i] = float(seed.bell());
            return out;
        };
        Matrix<float> const W = bells(d, 64) / 8, z = bells(64, X.cols()), C = bells(64, outputs);
        X = (W * z + 0.3f * bells(d, X.cols())).cwiseMax(0.0f);
        Y = z.transpose() * C + 0.7f * bells(X.cols(), outputs);
        Gram<false> gram(d);
        for (int b = 0; b < blocks; ++b) gram.take(rows<double>(b), of_outputs<double>(b));
        theta = gram.solved().col(0);
        Eigen::Matrix<long double, Eigen::Dynamic, 1> r(d);
        for (int step = 0; step < 3; ++step) {
            r = -(long double)(regularisation)*theta.cast<long double>();
            for (Index i = 0; i < X.cols(); ++i) {
                long double left = Y(i, 0);
                for (Index j = 0; j < d; ++j) left -= (long double)(X(j, i)) * theta[j];
                for (Index j = 0; j < d; ++j) r[j] += left * X(j, i);
            }
            theta += gram.L.triangularView<Eigen::Lower>().transpose().solve(
                gram.L.triangularView<Eigen::Lower>().solve(r.cast<double>()));
        }
    }
    template <class T>
    Matrix<T> rows(int b) const {
        return X.middleCols(b * k, k).cast<T>();
    }
    template <class T>
    Matrix<T> of_outputs(int b) const {
        return Y.middleRows(b * k, k).cast<T>();
    }
};

double seconds() { return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count(); }

struct Row {
    std::string name, word, when;
    double products;  // a row of the data, in d^2
    std::function<void(Row&)> run;
    std::vector<double> times = {};
    double digits = 0;
};
template <class F, class T>
Row row(std::string name, std::string when, double products, Data const& data) {
    return {std::move(name), sizeof(T) == 4 ? "float" : "double", std::move(when), products, [&data](Row& mine) {
                F f(int(data.X.rows()));
                double spent = 0;
                for (int b = 0; b < blocks; ++b) {
                    Matrix<T> const X = data.rows<T>(b), Y = data.of_outputs<T>(b);
                    double const start = seconds();
                    f.take(X, Y);
                    spent += seconds() - start;
                }
                double const start = seconds();
                Vector<double> const theta = f.solved().col(0).template cast<double>();
                mine.times.push_back((spent + seconds() - start) / (blocks * k));
                double const error = (theta - data.theta).norm() / data.theta.norm();
                mine.digits = std::isfinite(error) ? -std::log10(error) : -99;
            }};
}
/// Flops a second of the product d x d by d x k.
template <class T>
double rate(int d) {
    Matrix<T> const A = Matrix<T>::Constant(d, d, T(1)), B = Matrix<T>::Constant(d, k, T(1));
    Matrix<T> C(d, k);
    double const start = seconds();
    for (int i = 0; i < 4; ++i) gemm<T>('N', 'N', 1, A, B, 0, C);
    return 4 * 2.0 * d * d * k / (seconds() - start);
}
double median(std::vector<double> x) {
    std::ranges::sort(x);
    return x[x.size() / 2];
}

void table(int d) {
    Data const data(d);
    double const m = 2.0 * outputs / d;  // psi'theta or its like, in d^2
    std::vector<Row> rows{
        row<Subtract<double>, double>("P -= K G'", "each block", 4 + 2 * m, data),
        row<Subtract<float>, float>("P -= K G'", "each block", 4 + 2 * m, data),
        row<Gram<false>, double>("Gram, dpotrf", "once", 1 + m, data),
        row<Gram<true>, double>("Gram, dpotrf", "each block", 1 + m + d / 3.0 / k, data),
        row<Tpqrt<double>, double>("tpqrt", "once", 2 + 2 * m, data),
        row<Tpqrt<float>, float>("tpqrt", "once", 2 + 2 * m, data),
        row<Geqrf, double>("geqrf of [R; X]", "once", 2 + 4.0 / 3 * d / k + 2 * m, data),
        row<Ours<QrBlock<double>>, double>("qr_block", "once", 2 + 2 * m, data),
        row<Ours<QrBlock<float>>, float>("qr_block", "once", 2 + 2 * m, data),
        row<Ours<JosephRankTwo<double>>, double>("joseph_rank_two", "each block", 4 + 2 * m, data),
        row<Ours<JosephRankTwo<float>>, float>("joseph_rank_two", "each block", 4 + 2 * m, data),
    };
    std::vector<double> in_double, in_float;
    for (int round = 0; round < rounds; ++round) {
        in_double.push_back(rate<double>(d)), in_float.push_back(rate<float>(d));
        for (Row& one : rows) one.run(one);
    }
    std::printf(
        "\nd = %d, k = %d, m = %d, %d blocks, gamma = %g, %d rounds; products: double %.1f, float %.1f Gflop/s\n\n", d,
        k, outputs, blocks, regularisation, rounds, median(in_double) / 1e9, median(in_float) / 1e9);
    std::printf(
        "| form | word | theta | us a row | range | ratio | of products' rate | digits |\n"
        "|---|---|---|---|---|---|---|---|\n");
    for (Row const& one : rows) {
        auto const [least, most] = std::ranges::minmax(one.times);
        std::vector<double> ratio;  // of neighbours in time
        for (size_t i = 0; i < one.times.size(); ++i) ratio.push_back(one.times[i] / rows[0].times[i]);
        double const share =
            one.products * d * d / median(one.times) / median(one.word == "float" ? in_float : in_double);
        std::printf("| %s | %s | %s | %.2f | %.2f to %.2f | %.2f | %.2f | ", one.name.c_str(), one.word.c_str(),
                    one.when.c_str(), 1e6 * median(one.times), 1e6 * least, 1e6 * most, median(ratio), share);
        if (one.digits == -99) std::printf("broke |\n");
        else std::printf("%.1f |\n", one.digits);
    }
    std::fflush(stdout);
}

}  // namespace
}  // namespace rlslab::bench

int main(int argc, char** argv) {
    using namespace rlslab::bench;
    std::vector<int> sizes;
    int threads = 1;
    for (int i = 1; i < argc; ++i) {
        std::string const word = argv[i];
        auto const next = [&] { return ++i < argc ? std::atof(argv[i]) : 0; };
        if (word == "--outputs") outputs = int(next());
        else if (word == "--blocks") blocks = int(next());
        else if (word == "--rounds") rounds = int(next());
        else if (word == "--gamma") regularisation = next();
        else if (word == "--threads") threads = int(next());
        else sizes.push_back(std::atoi(word.c_str()));
    }
    if (sizes.empty()) sizes = {512, 1024, 2048, 4096};
    if (outputs < 1 || blocks < 1 || rounds < 1 || threads < 1 || !(regularisation > 0) ||
        *std::ranges::min_element(sizes) < 1) {
        std::fprintf(stderr, "rlslab_bench_blocks: expected numbers of at least one\n");
        return 2;
    }
    openblas_set_num_threads(threads);
    rlslab::use_threads(threads);
    std::ifstream file("/proc/cpuinfo");
    std::string machine;
    while (std::getline(file, machine) && machine.rfind("model name", 0) != 0) {}
    std::printf("%s; OpenBLAS for %s; threads: %d\n", machine.substr(machine.find(':') + 1).c_str() + 1,
                openblas_get_corename(), threads);
    for (int const d : sizes) table(d);
}
