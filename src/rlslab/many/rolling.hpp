// Regressions over the last rows, of each row and group, in one pass and without taking a row back.
#pragma once

#include <rlslab/linalg/triangles.hpp>
#include <rlslab/many/rolled.hpp>
#include <rlslab/many/row_triangles.hpp>
#include <rlslab/many/threads.hpp>

#include <algorithm>
#include <vector>

namespace rlslab {
namespace detail {

/// What all rows of a rolling regression share.
template <class X>
struct RollingTask {
    RollingRows<X> given;
    RollingOptions options;
    Rolled out;
    Index window;               // 0: none; no longer than the longest group
    Index chunk;                // triangles of a window's end that are kept at once
    std::vector<Index> order;   // rows, a group after another
    std::vector<Index> column;  // place j of the triangle has X's column[j]; a constant one comes first
    double constant = 0;        // that number; 0: there is none
};
/// Some rows of one group; `from` is a multiple of the window.
struct RollingPiece {
    Index const* rows;  // of the group
    Index from, to;
};

/// A window that ends in row p of a block of W rows is the end of the block before it, from its row p + 1 on, and the
/// beginning of this one. The triangles of all ends of a block are made once, from its last row backwards.
template <int N, class X>
class RollingPass {
    RollingTask<X> const& task_;
    RowTriangles<N> of_;
    Index d_, W_;
    double lambda_, root_;
    std::vector<double> kept_, row_, older_, theta_, last_at_, error_;  // theta_: of the rows less window_'s at
    RowTriangle beginning_, spare_, window_, running_;
    std::vector<RowTriangle> ends_, marks_;  // of the chunk's rows; of the first row of each chunk
    Index chunk_at_ = -1;
    bool last_known_ = false;

    /// [psi y]; whether all of it is finite.
    bool read(Index row, std::vector<double>& to) const {
        X const* const psi = task_.given.psi + row * task_.given.stride;
        bool finite = true;
        for (Index j = 0; j <= d_; ++j) {
            double const x = j < d_ ? double(psi[task_.column[size_t(j)]]) : double(task_.given.y[row]);
            finite = finite && is_finite(x);
            to[size_t(j)] = x;
        }
        return finite;
    }
    void take_backwards(RowTriangle& t, Index row) {
        if (read(row, older_)) of_.take(t, older_.data(), t.wear);
        t.wear *= root_;
    }
    /// The marks of the block that begins at `block`.
    void mark(Index const* block) {
        chunk_at_ = -1;
        Index const last = (W_ - 1) / task_.chunk;
        if (last == 0) return;
        of_.clear(running_);
        for (Index s = W_ - 1; s >= task_.chunk; --s) {
            take_backwards(running_, block[s]);
            if (s % task_.chunk == 0) of_.copy(running_, marks_[size_t(s / task_.chunk)]);
        }
    }
    /// The block's rows from s on.
    RowTriangle const& end(Index const* block, Index s) {
        Index const at = s / task_.chunk, first = at * task_.chunk;
        if (at != chunk_at_) {
            chunk_at_ = at;
            if (first + task_.chunk < W_) of_.copy(marks_[size_t(at + 1)], running_);
            else of_.clear(running_);
            for (Index k = std::min(first + task_.chunk, W_) - 1; k >= first; --k) {
                take_backwards(running_, block[k]);
                of_.copy(running_, ends_[size_t(k - first)]);
            }
        }
        return ends_[size_t(s - first)];
    }
    double& R(Index i, Index j) { return window_.R[i * (d_ + 1) + j]; }

    bool determined() {
        double const share = rounding_of_a_pivot<double>() * std::max(1.0, window_.weights / 8192);
        for (Index j = 0; j < d_; ++j) {
            double largest = j > 0 ? absolute(of_.unmoved(window_, j)) : 0;
            for (Index i = 1; i < j; ++i) largest = std::max(largest, absolute(R(i, j)));
            if (!(share * largest < absolute(R(j, j)))) return false;
        }
        return true;
    }
    /// sqrt(P_jj) of each, P^-1 = R_x'R_x; a column of the inverse at a time.
    void find_errors() {
        std::fill(error_.begin(), error_.end(), 0.0);
        double* const x = spare_.R;
        for (Index k = 0; k < d_; ++k) {
            x[k] = 1 / R(k, k);
            for (Index i = k - 1; i >= 0; --i) {
                double sum = 0;
                for (Index j = i + 1; j <= k; ++j) sum += (i == 0 ? of_.unmoved(window_, j) : R(i, j)) * x[j];
                x[i] = -sum / R(i, i);
            }
            for (Index i = 0; i <= k; ++i) error_[size_t(i)] += x[i] * x[i];
        }
        for (double& e : error_) e = square_root(e);
    }
    double r_squared() {
        double explained = 0;
        for (Index i = task_.constant != 0; i < d_; ++i) explained += R(i, d_) * R(i, d_);
        double const all = explained + R(d_, d_) * R(d_, d_), mean = task_.constant != 0 ? R(0, d_) : 0;
        double const nothing = rounding_of_a_pivot<double>() * mean;
        return nothing * nothing < all ? explained / all : undefined<double>();
    }
    /// y - psi'theta of the row that was read, theta of rows less `at`.
    double error_of_row(double const* at) const {
        double e = row_[size_t(d_)] - at[d_];
        for (Index j = 0; j < d_; ++j) e -= (row_[size_t(j)] - at[j]) * theta_[size_t(j)];
        return e;
    }
    void answer(Index row, Index place, bool finite, bool wanted) {
        Rolled const& out = task_.out;
        Index const least = std::max<Index>(task_.options.min_periods, d_);
        bool const full = task_.options.min_periods >= 0 || place + 1 >= task_.options.window;
        bool const known = full && window_.taken >= least && determined();
        double residual = undefined<double>(), innovation = residual;
        if (finite && last_known_ && wanted) innovation = error_of_row(last_at_.data());
        if (known)
            for (Index i = d_ - 1; i >= 0; --i) {
                double sum = R(i, d_);
                for (Index j = i + 1; j < d_; ++j) sum -= R(i, j) * theta_[size_t(j)];
                theta_[size_t(i)] = sum / R(i, i);
            }
        last_known_ = known;
        std::copy_n(window_.at, d_ + 1, last_at_.data());
        if (!wanted) return;
        if (known && finite) residual = error_of_row(window_.at);
        double const r = window_.share, freedom = window_.weights - double(d_) * r;
        double const sigma = known && window_.taken > d_ && 0 < freedom && 0x1p-1000 < window_.weights
                                 ? absolute(R(d_, d_)) / square_root(freedom)
                                 : undefined<double>();
        if (known && (out.t || out.error)) find_errors();
        double moved = window_.at[d_];  // what theta of the constant column owes to `at`
        for (Index j = 1; j < d_; ++j) moved -= window_.at[j] * theta_[size_t(j)];
        for (Index i = 0; i < d_; ++i) {
            double const theta = i == 0 && task_.constant != 0 ? theta_[0] + moved / task_.constant : theta_[size_t(i)];
            Index const at = row * d_ + task_.column[size_t(i)];
            double const error = known ? sigma * square_root(r) * error_[size_t(i)] : undefined<double>();
            if (out.theta) out.theta[at] = known ? theta : undefined<double>();
            if (out.error) out.error[at] = error;
            if (out.t) out.t[at] = known ? theta / error : undefined<double>();
        }
        if (out.residual) out.residual[row] = residual;
        if (out.innovation) out.innovation[row] = innovation;
        if (out.sigma) out.sigma[row] = sigma;
        if (out.r2) out.r2[row] = known ? r_squared() : undefined<double>();
        if (out.rows) out.rows[row] = double(window_.taken);
    }

public:
    explicit RollingPass(RollingTask<X> const& task)
        : task_(task), of_(task.given.size + 1, task.constant), d_(task.given.size), W_(task.window),
          lambda_(task.options.forgetting), root_(square_root(lambda_)), row_(size_t(d_ + 1)), older_(row_),
          theta_(size_t(d_)), last_at_(row_), error_(theta_) {
        Index const ends = W_ > 0 ? std::min(task.chunk, W_) : 0, marks = W_ > 0 ? (W_ - 1) / task.chunk + 1 : 0;
        kept_.resize(size_t((4 + ends + marks) * of_.numbers()));
        ends_.resize(size_t(ends));
        marks_.resize(size_t(marks));
        double* next = kept_.data();
        auto const place = [&](RowTriangle& t) {
            of_.place(t, next);
            next += of_.numbers();
        };
        for (RowTriangle* const t : {&beginning_, &spare_, &window_, &running_}) place(*t);
        for (RowTriangle& t : ends_) place(t);
        for (RowTriangle& t : marks_) place(t);
    }
    void operator()(RollingPiece const& piece) {
        // The theta before the piece's first row, for its innovation, is that of the block before.
        Index const first = piece.from > 0 && task_.out.innovation ? piece.from - W_ : piece.from;
        double root = 1, lambda = 1;  // what the end of the block before has worn down by
        last_known_ = false;
        of_.clear(beginning_);
        for (Index k = first, p = 0; k < piece.to; ++k, ++p) {
            Index const row = piece.rows[k];
            bool const wanted = k >= piece.from;
            if (p == W_ && W_ > 0) {
                of_.clear(beginning_);
                p = 0;
            }
            if (p == 0) {
                root = lambda = 1;
                if (wanted && k > 0) mark(piece.rows + k - W_);
            }
            root *= root_;
            lambda *= lambda_;
            if (lambda_ != 1 && p > 0) of_.scale(beginning_, root_, lambda_);
            bool const finite = read(row, row_);
            if (finite) of_.take(beginning_, row_.data(), 1);
            if (W_ == 0 && k % 16 == 15) of_.centre(beginning_);
            if (!wanted && p + 1 < W_) continue;
            RowTriangle const* const before = k > p && p + 1 < W_ ? &end(piece.rows + k - p - W_, p + 1) : nullptr;
            if (before && before->taken > 0) {
                of_.copy(*before, window_);
                if (lambda_ != 1) of_.scale(window_, root, lambda);
                of_.copy(beginning_, spare_);
                if (spare_.taken > 0) of_.merge(window_, spare_);
            } else {
                of_.copy(beginning_, window_);
            }
            answer(row, k, finite, wanted);
        }
    }
};

/// The pieces, a group's after another's; none is of less than some thousand rows where a window lets a group be cut.
inline std::vector<RollingPiece> rolling_pieces(std::vector<Index> const& order, std::vector<Index> const& ends,
                                                Index window) {
    Index const length = window > 0 ? (std::max<Index>(window, 8192) + window - 1) / window * window : 0;
    std::vector<RollingPiece> out;
    Index begin = 0;
    for (Index const end : ends) {
        Index const rows = end - begin, step = length > 0 ? length : std::max<Index>(rows, 1);
        for (Index from = 0; from < rows; from += step)
            out.push_back({order.data() + begin, from, std::min(from + step, rows)});
        begin = end;
    }
    return out;
}

template <int N, class X>
void run_rolling(RollingTask<X> const& task, std::vector<RollingPiece> const& pieces) {
    std::vector<RollingPass<N, X>> passes;  // what allocates is here: threads must not throw
    Index const threads = std::min(task.options.threads, Index(pieces.size()));
    passes.reserve(size_t(threads));
    for (Index i = 0; i < threads; ++i) passes.emplace_back(task);
    std::atomic<size_t> next{0};
    among_threads(threads, [&](Index thread) {
        for (size_t i = next++; i < pieces.size(); i = next++) passes[size_t(thread)](pieces[i]);
    });
}

}  // namespace detail

/// For each row the least squares of the rows of its group that end with it, in the order given: the last
/// `options.window` of them, or all, each weighing w = lambda^(rows of the group after it). No prior. A row with a
/// number that is not finite takes its place and is left out: it has theta of the others and no residual.
///
///   (1) [psi y] of the window = Q R,   R = [R_x z; 0 rho],   R_x theta = z,   P = (R_x'R_x)^-1
///   (2) N = sum w,  r = sum w^2 / N,   sigma^2 = rho^2 / (N - r d):  RSS / (n - d) where lambda = 1
///   (3) error_j = sigma sqrt(r P_jj),   t_j = theta_j / error_j
///   (4) residual = y - psi'theta,   innovation = y - psi'theta of the group's row before
///   (5) r2 = |z|^2 / (|z|^2 + rho^2); where a column is the same number, not 0, in all rows that count, it is taken
///       first, and z's first is left out: y's mean does not count as explained. In [0, 1], whatever the rounding
///   (6) beside such a column all others and y are taken less a row of the window, so that offsets cost no digits
///
/// **No row is ever taken back, and no sum is a difference**: a window is the end of one block of W rows and the
/// beginning of the next, whose triangles are made by adding rows, backwards and forwards, and merged. So a row that is
/// not in a window has no effect on any bit of its answers, whatever its size (but whether a column is constant is
/// asked of all rows that are not left out), and their errors are those of a QR factorisation of its rows alone.
///
/// NaN where a window has fewer than `min_periods` rows, or is not full (-1), or does not determine theta: a pivot of R
/// is not above its rounding, linalg/triangles.hpp, at more than 8192 rows in proportion. sigma, error, t are NaN where
/// N <= r d, and where N has worn down to 2^-1000; `rows` is how many were not left out. r2 is NaN where y is 0, or
/// constant beside a constant column. What is of no group is NaN.
///
/// Computes in binary64; X is float or double. Cost a row: 4 d^2 operations in two rows added, 4/3 d^3 of a merging,
/// d^3/3 where `error` or `t` are wanted; memory W d^2 numbers up to a megabyte, then sqrt(W) d^2, a thread, and rows
/// numbers of order. Groups, and windows of one, are shared among threads; each row's bits are the same. Where squares
/// leave binary64's range theta, sigma and residuals stay, the other answers may not. Throws std::invalid_argument for
/// options and shapes that are none, before anything is written. Sources: Golub 1965; the two stacks of a queue, for
/// sums without an inverse: Tangwongsan, Hirzel & Schneider 2017.
template <class X>
void rolling(RollingRows<X> const& given, RollingOptions const& options, Rolled const& out) {
    Index const rows = given.rows, d = given.size;
    expects(rows >= 0, "0 rows or more");
    expects(d >= 1, "a regressor at least");
    expects(given.stride >= d, "rows that do not overlap");
    expects(options.window >= 0, "window >= 0 rows");
    expects(is_forgetting_factor(options.forgetting), "0 < forgetting <= 1");
    expects(options.min_periods >= -1, "min_periods >= 0");
    expects(options.window == 0 || options.min_periods <= options.window, "min_periods <= window");
    expects(1 <= options.threads && options.threads <= 1024, "1 to 1024 threads");

    // The rows of each group, by counting.
    std::vector<Index> ends(1, rows);
    Index taken = rows;
    if (given.group) {
        taken = 0;
        Index groups = 0;
        for (Index k = 0; k < rows; ++k) {
            expects(given.group[k] < rows, "a group's number below the rows");
            groups = std::max(groups, Index(given.group[k]) + 1);
            taken += given.group[k] >= 0;
        }
        ends.assign(size_t(groups) + 1, 0);
        for (Index k = 0; k < rows; ++k)
            if (given.group[k] >= 0) ++ends[size_t(given.group[k]) + 1];
        for (size_t g = 0; g < size_t(groups); ++g) ends[g + 1] += ends[g];
    }
    detail::RollingTask<X> task{given, options, out, 0, 1, std::vector<Index>(size_t(taken)), {}};
    for (Index k = 0; k < rows; ++k)
        if (Index const g = given.group ? Index(given.group[k]) : -2; g == -2) task.order[size_t(k)] = k;
        else if (g >= 0) task.order[size_t(ends[size_t(g)]++)] = k;
    if (given.group) ends.pop_back();  // each has become its group's end
    Index longest = 0;
    for (size_t g = 0; g < ends.size(); ++g) longest = std::max(longest, ends[g] - (g > 0 ? ends[g - 1] : 0));

    auto const counts = [&](Index row) {
        bool finite = is_finite(given.y[row]);
        for (Index j = 0; j < d; ++j) finite = finite && is_finite(given.psi[row * given.stride + j]);
        return finite;
    };
    for (Index j = 0; j < d; ++j) {
        X first(0);
        bool constant = task.constant == 0;
        for (size_t i = 0; constant && i < task.order.size(); ++i)
            if (X const x = given.psi[task.order[i] * given.stride + j]; !(x == first && !(x == X(0))))  // seldom
                if (counts(task.order[i])) {
                    constant = first == X(0) && !(x == X(0));
                    first = x;
                }
        if (constant) task.constant = double(first);
        bool const leads = constant && !(first == X(0));
        task.column.insert(leads ? task.column.begin() : task.column.end(), j);
    }
    if (options.window > 0) task.window = std::max<Index>(std::min(options.window, longest), 1);
    Index const numbers = (d + 1) * (d + 2);
    task.chunk = std::max<Index>(task.window, 1);
    if (task.chunk > (Index(1) << 17) / numbers)
        for (task.chunk = 1; task.chunk < task.window / task.chunk;) ++task.chunk;

    if (taken < rows) {
        auto const nothing = [&](double* to, Index numbers_a_row) {
            for (Index k = 0; to && k < rows; ++k)
                if (given.group[k] < 0) std::fill_n(to + k * numbers_a_row, numbers_a_row, undefined<double>());
        };
        for (double* const to : {out.theta, out.t, out.error}) nothing(to, d);
        for (double* const to : {out.residual, out.innovation, out.sigma, out.r2, out.rows}) nothing(to, 1);
    }
    std::vector<detail::RollingPiece> const pieces = detail::rolling_pieces(task.order, ends, task.window);
    switch (d) {
        case 1: return detail::run_rolling<2>(task, pieces);
        case 2: return detail::run_rolling<3>(task, pieces);
        case 3: return detail::run_rolling<4>(task, pieces);
        case 4: return detail::run_rolling<5>(task, pieces);
        case 5: return detail::run_rolling<6>(task, pieces);
        case 6: return detail::run_rolling<7>(task, pieces);
        case 7: return detail::run_rolling<8>(task, pieces);
        default: return detail::run_rolling<0>(task, pieces);
    }
}

}  // namespace rlslab
