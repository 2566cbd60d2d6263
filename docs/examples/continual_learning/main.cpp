// Classes that come in tasks, a linear readout of random features: the update that is published, in float and double,
// beside Joseph's form by blocks and QR of blocks in float.
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <Eigen/LU>

#include <chrono>
#include <cstdio>
#include <string>
#include <vector>

namespace {

using rlslab::Index, rlslab::Matrix;
constexpr Index d = 768, k = 256, inputs = 64, classes = 20, tasks = 5, blocks_of_task = 5, tested = 2000;
constexpr double gamma_ = 0.1;  // ridge: P0 = I / gamma

/// As it is published: R -= R X (I + X'R X)^-1 X'R, W += R X (Y - X'W) with the new R.
template <class T>
struct Published {
    using scalar = T;
    Matrix<T> R = Matrix<T>::Identity(d, d) / T(gamma_), W = Matrix<T>::Zero(d, classes);
    void update_block(Matrix<T> const& X, Matrix<T> const& Y) {
        Matrix<T> const S = X.transpose() * R * X + Matrix<T>::Identity(k, k);
        R -= R * X * S.inverse() * (X.transpose() * R).eval();
        W += R * X * (Y - X.transpose() * W);
    }
    Matrix<T> theta() const { return W; }
};
/// All classes are columns from the start: one that has not come yet has targets of 0, and its column stays 0.
template <class F>
struct Ours {
    using scalar = typename F::scalar;
    rlslab::MultiOutput<F> f{rlslab::Problem<scalar>{.size = d, .prior = rlslab::Prior<scalar>{.variance = 1 / gamma_}},
                             classes};
    void update_block(Matrix<scalar> const& X, Matrix<scalar> const& Y) { f.update_block(X, Y); }
    Matrix<scalar> theta() const { return f.theta(); }
};

struct Rows {
    Matrix<float> X, Y;  // d x rows, rows x classes
    std::vector<Index> label;
};
/// A class is a centre among 64 inputs; the features are max(0, W z) with a fixed random W.
struct World {
    rlslab::Seed seed{5};
    Matrix<float> centres = bells(inputs, classes), W = bells(d, inputs) / 8;
    Matrix<float> bells(Index rows, Index columns) {
        Matrix<float> out(rows, columns);
        for (Index i = 0; i < out.size(); ++i) out.data()[i] = float(seed.bell());
        return out;
    }
    Rows rows(Index count, Index first, Index last) {
        Rows out{Matrix<float>(d, count), Matrix<float>::Zero(count, classes), {}};
        for (Index i = 0; i < count; ++i) {
            Index const c = first + Index(seed.next() % std::uint64_t(last - first));
            Matrix<float> const z = centres.col(c) + 1.6f * bells(inputs, 1);
            out.X.col(i) = (W * z).cwiseMax(0.0f);
            out.Y(i, c) = 1;
            out.label.push_back(c);
        }
        return out;
    }
};

struct Result {
    std::string name, word;
    Matrix<double> theta;
    double percent[tasks];  // right, of the classes seen so far, after each task
    double seconds = 0;     // of the updates
};
template <class F>
Result learn(std::string name, std::vector<Rows> const& blocks, Rows const& test) {
    using T = typename F::scalar;
    F f;
    Result out{std::move(name), sizeof(T) == 4 ? "float" : "double", {}, {}, 0};
    for (Index task = 0; task < tasks; ++task) {
        for (Index b = 0; b < blocks_of_task; ++b) {
            Rows const& rows = blocks[size_t(task * blocks_of_task + b)];
            Matrix<T> const X = rows.X.cast<T>(), Y = rows.Y.cast<T>();
            auto const start = std::chrono::steady_clock::now();
            f.update_block(X, Y);
            out.seconds += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        }
        out.theta = f.theta().template cast<double>();
        Index const seen = (task + 1) * classes / tasks;
        Matrix<double> const score = out.theta.transpose() * test.X.cast<double>();
        Index right = 0, all = 0;
        for (Index i = 0; i < tested; ++i) {
            if (test.label[size_t(i)] >= seen) continue;
            Index best = 0;
            score.col(i).head(seen).maxCoeff(&best);
            right += best == test.label[size_t(i)], ++all;
        }
        out.percent[task] = 100.0 * double(right) / double(all);
    }
    return out;
}

}  // namespace

/// With an argument: times, too.
int main(int count, char**) {
    bool const times = count > 1;
    Eigen::setCpuCacheSizes(32768, 262144, 2097152);  // else the order of its sums is the processor's
    World world;
    std::vector<Rows> blocks;
    for (Index task = 0; task < tasks; ++task)
        for (Index b = 0; b < blocks_of_task; ++b)
            blocks.push_back(world.rows(k, task * classes / tasks, (task + 1) * classes / tasks));
    Rows const test = world.rows(tested, 0, classes);

    std::vector<Result> const results{
        learn<Ours<rlslab::QrBlock<double>>>("qr_block", blocks, test),
        learn<Ours<rlslab::QrBlock<float>>>("qr_block", blocks, test),
        learn<Ours<rlslab::JosephRankTwo<float>>>("joseph_rank_two", blocks, test),
        learn<Published<float>>("published", blocks, test),
        learn<Published<double>>("published", blocks, test),
    };
    Matrix<double> const& exact = results[0].theta;  // 14 digits
    std::printf("%-24sright after each task, %%        error   MB of state%s\n", "", times ? "   seconds" : "");
    bool right = true;
    for (Result const& one : results) {
        std::printf("%-16s %-7s", one.name.c_str(), one.word.c_str());
        for (double const percent : one.percent) std::printf(" %5.1f", percent);
        double const error = (one.theta - exact).norm() / exact.norm();
        if (error < 1e-12) std::printf("   < 1e-12");
        else std::printf("     %.0e", error);
        std::printf("  %8.1f", double(d * (d + classes)) * (one.word == "float" ? 4e-6 : 8e-6));  // R and z, or P and W
        if (times) std::printf("  %12.2f", one.seconds);
        std::printf("\n");
        if (one.name == "qr_block") right = right && error < 1e-5 && one.percent[4] == results[0].percent[4];
    }
    return right ? 0 : 1;
}
