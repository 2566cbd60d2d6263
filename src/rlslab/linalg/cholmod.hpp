// CHOLMOD's sparse L D L' as a value that can be copied, scaled, updated by one row, and solved with. GPL-2+ (CHOLMOD's
// Modify module).
#pragma once

#include <rlslab/linalg/sparse.hpp>

#include <cholmod.h>

#include <memory>
#include <utility>
#include <vector>

namespace rlslab {

/// X = L D L' of a sparse symmetric positive definite X of order d, columns in their given order. L is unit lower
/// triangular.
class SparseLdl {
    /// CHOLMOD keeps its workspace and settings in one structure; each factor owns its own.
    struct Workspace {
        cholmod_common c;
        Workspace() {
            cholmod_start(&c);
            c.supernodal = CHOLMOD_SIMPLICIAL;
            c.final_ll = 0;
            c.nmethods = 1;
            c.method[0].ordering = CHOLMOD_NATURAL;
            c.postorder = 0;
            c.print = 0;
        }
        ~Workspace() { cholmod_finish(&c); }
        Workspace(Workspace const&) = delete;
        Workspace& operator=(Workspace const&) = delete;
    };
    std::unique_ptr<Workspace> work_;
    cholmod_factor* factor_ = nullptr;

    /// CHOLMOD's view of columns that Eigen stores, without a copy. stype 0: any matrix; -1: the lower triangle of a
    /// symmetric one.
    static cholmod_sparse view(size_t rows, size_t columns, int const* starts, int const* indices, double const* values,
                               int stype) {
        cholmod_sparse A{};
        A.nrow = rows;
        A.ncol = columns;
        A.nzmax = size_t(starts[columns]);
        A.p = const_cast<int*>(starts);
        A.i = const_cast<int*>(indices);
        A.x = const_cast<double*>(values);
        A.stype = stype;
        A.itype = CHOLMOD_INT;
        A.xtype = CHOLMOD_REAL;
        A.dtype = CHOLMOD_DOUBLE;
        A.sorted = A.packed = 1;
        return A;
    }
    /// Column j: D_j, and the `count` numbers of L below its unit diagonal.
    struct ColumnOfL {
        double const& pivot;
        int const* row;
        double const* value;
        int count;
    };
    ColumnOfL column(Index j) const {
        int const start = static_cast<int const*>(factor_->p)[j];
        auto const* const value = static_cast<double const*>(factor_->x) + start;
        return {*value, static_cast<int const*>(factor_->i) + start + 1, value + 1,
                static_cast<int const*>(factor_->nz)[j] - 1};
    }
    void solve_lower(Vector<double>& x) const {  // zeros are skipped: for a sparse x = psi only its path is visited
        for (Index j = 0; j < size(); ++j) {
            if (x[j] == 0) continue;
            ColumnOfL const L = column(j);
            for (int k = 0; k < L.count; ++k) x[L.row[k]] -= L.value[k] * x[j];
        }
    }

    friend struct IrregularState<SparseLdl>;
    /// Puts D_j and what is below the diagonal into column j, rows ascending.
    void put_column(Index j, double pivot, std::vector<std::pair<Index, double>> const& below) {
        cholmod_reallocate_column(size_t(j), below.size() + 1, factor_, &work_->c);
        int const start = static_cast<int const*>(factor_->p)[j];
        auto* const row = static_cast<int*>(factor_->i) + start;
        auto* const value = static_cast<double*>(factor_->x) + start;
        static_cast<int*>(factor_->nz)[j] = int(below.size()) + 1;
        row[0] = int(j);
        value[0] = pivot;
        for (size_t k = 0; k < below.size(); ++k) {
            row[k + 1] = int(below[k].first);
            value[k + 1] = below[k].second;
        }
    }

public:
    /// Factors X, given by its lower triangle. X must be positive definite; that is not checked.
    explicit SparseLdl(SparseRows const& lower) : work_(std::make_unique<Workspace>()) {
        cholmod_sparse X = view(size_t(lower.rows()), size_t(lower.cols()), lower.outerIndexPtr(),
                                lower.innerIndexPtr(), lower.valuePtr(), -1);
        factor_ = cholmod_analyze(&X, &work_->c);
        cholmod_factorize(&X, factor_, &work_->c);
    }
    SparseLdl(SparseLdl const& other) : work_(std::make_unique<Workspace>()) {
        factor_ = cholmod_copy_factor(other.factor_, &work_->c);
    }
    SparseLdl(SparseLdl&& other) noexcept { swap(other); }
    SparseLdl& operator=(SparseLdl other) noexcept {
        swap(other);
        return *this;
    }
    ~SparseLdl() {
        if (work_) cholmod_free_factor(&factor_, &work_->c);
    }
    void swap(SparseLdl& other) noexcept {
        std::swap(work_, other.work_);
        std::swap(factor_, other.factor_);
    }

    Index size() const { return Index(factor_->n); }

    /// X = lambda X, lambda > 0: multiplies D, which CHOLMOD stores first in each column.
    void scale(double lambda) {
        auto* const value = static_cast<double*>(factor_->x);
        auto const* const start = static_cast<int const*>(factor_->p);
        for (size_t j = 0; j < factor_->n; ++j) value[start[j]] *= lambda;
    }

    /// X = X + psi psi', psi of d numbers. Changes only the columns on psi's path in the elimination tree. False on
    /// breakdown: CHOLMOD failed or met a pivot that it could not use.
    bool update(SparseRow const& psi) {
        if (psi.nonZeros() == 0) return true;
        int const starts[] = {0, int(psi.nonZeros())};
        cholmod_sparse row = view(size_t(psi.size()), 1, starts, psi.innerIndexPtr(), psi.valuePtr(), 0);
        return cholmod_updown(1, &row, factor_, &work_->c) && factor_->minor == factor_->n;
    }

    /// psi' X^-1 psi = f' D^-1 f, f = L^-1 psi, summed from the first column to the last. f (d) is overwritten.
    double inverse_form(SparseRow const& psi, Vector<double>& f) const {
        f.setZero();
        for (SparseRow::InnerIterator it(psi); it; ++it) f[it.index()] = it.value();
        solve_lower(f);
        double sum = 0;
        for (Index j = 0; j < size(); ++j)
            if (f[j] != 0) sum += f[j] * f[j] / column(j).pivot;
        return sum;
    }

    /// a = X^-1 a and b = X^-1 b, d numbers each, by the columns of L from the first and those of L' from the last,
    /// each sum from its diagonal downwards. False if a pivot is not finite.
    bool solve(Vector<double>& a, Vector<double>& b) const {
        solve_lower(a);
        solve_lower(b);
        bool finite = true;
        for (Index j = size() - 1; j >= 0; --j) {
            ColumnOfL const L = column(j);
            finite = finite && std::isfinite(L.pivot);
            double aj = a[j] / L.pivot, bj = b[j] / L.pivot;
            for (int k = 0; k < L.count; ++k) {
                aj -= L.value[k] * a[L.row[k]];
                bj -= L.value[k] * b[L.row[k]];
            }
            a[j] = aj;
            b[j] = bj;
        }
        return finite;
    }

    /// Dense copies of L and D.
    void factors(Matrix<double>& L, Vector<double>& D) const {
        L = Matrix<double>::Identity(size(), size());
        D.resize(size());
        for (Index j = 0; j < size(); ++j) {
            ColumnOfL const from = column(j);
            D[j] = from.pivot;
            for (int k = 0; k < from.count; ++k) L(from.row[k], j) = from.value[k];
        }
    }
};

/// Column by column: D_j, then what is below the diagonal. Where CHOLMOD keeps a column decides no bit.
template <>
struct IrregularState<SparseLdl> {
    struct Below {
        SparseLdl::ColumnOfL const& column;
        int k = 0;
        explicit operator bool() const { return k < column.count; }
        Below& operator++() {
            ++k;
            return *this;
        }
        int index() const { return column.row[k]; }
        double value() const { return column.value[k]; }
    };
    static void put(SparseLdl const& x, auto number) {
        for (Index j = 0; j < x.size(); ++j) {
            SparseLdl::ColumnOfL const column = x.column(j);
            number(column.pivot);
            detail::put_column(Below{column}, number);
        }
    }
    static bool get(SparseLdl& x, auto number, bool keep) {
        SparseLdl read = x;
        std::vector<std::pair<Index, double>> below;
        for (Index j = 0; j < x.size(); ++j) {
            double pivot = 0;
            below.clear();
            auto const insert = [&](Index i, double value) { below.emplace_back(i, value); };
            if (!number(pivot) || !detail::get_column(j + 1, x.size(), number, insert)) return false;
            read.put_column(j, pivot, below);
        }
        if (keep) x = std::move(read);
        return true;
    }
};

}  // namespace rlslab
