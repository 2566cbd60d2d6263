// CHOLMOD's sparse L D L' as a value: copied, scaled, updated by one row, solved with. GPL-2+ (its Modify module).
#pragma once

#include <rlslab/problem.hpp>

#include <cholmod.h>

#include <memory>
#include <utility>

namespace rlslab {

/// X = L D L' of a sparse symmetric positive definite X of order d, columns in their given order.
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

public:
    /// Factors the lower triangle of X.
    explicit SparseLdl(Matrix<double> const& X) : work_(std::make_unique<Workspace>()) {
        Index const d = X.rows();
        size_t entries = 0;
        for (Index j = 0; j < d; ++j)
            for (Index i = j; i < d; ++i) entries += X(i, j) != 0;
        cholmod_sparse* A = cholmod_allocate_sparse(size_t(d), size_t(d), entries, 1, 1, -1, CHOLMOD_REAL, &work_->c);
        auto* const column = static_cast<int*>(A->p);
        auto* const row = static_cast<int*>(A->i);
        auto* const value = static_cast<double*>(A->x);
        int next = 0;
        for (Index j = 0; j < d; ++j) {
            column[j] = next;
            for (Index i = j; i < d; ++i)
                if (X(i, j) != 0) {
                    row[next] = int(i);
                    value[next++] = X(i, j);
                }
        }
        column[d] = next;
        factor_ = cholmod_analyze(A, &work_->c);
        cholmod_factorize(A, factor_, &work_->c);
        cholmod_free_sparse(&A, &work_->c);
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

    /// X = lambda X: the diagonal D, which CHOLMOD stores first in each column.
    void scale(double lambda) {
        auto* const value = static_cast<double*>(factor_->x);
        auto const* const column = static_cast<int const*>(factor_->p);
        for (size_t j = 0; j < factor_->n; ++j) value[column[j]] *= lambda;
    }

    /// X = X + psi psi', touching only the columns on psi's path in the elimination tree. False on breakdown.
    bool update(Vector<double> const& psi) {
        size_t const entries = size_t((psi.array() != 0).count());
        if (entries == 0) return true;
        cholmod_sparse* row = cholmod_allocate_sparse(size_t(psi.size()), 1, entries, 1, 1, 0, CHOLMOD_REAL, &work_->c);
        int next = 0;
        for (Index i = 0; i < psi.size(); ++i)
            if (psi[i] != 0) {
                static_cast<int*>(row->i)[next] = int(i);
                static_cast<double*>(row->x)[next++] = psi[i];
            }
        static_cast<int*>(row->p)[0] = 0;
        static_cast<int*>(row->p)[1] = next;
        bool const good = cholmod_updown(1, row, factor_, &work_->c) && factor_->minor == factor_->n;
        cholmod_free_sparse(&row, &work_->c);
        return good;
    }

    /// X^-1 b.
    Vector<double> solve(Vector<double> const& b) const {
        cholmod_dense view{};
        view.nrow = view.nzmax = view.d = size_t(b.size());
        view.ncol = 1;
        view.x = const_cast<double*>(b.data());
        view.xtype = CHOLMOD_REAL;
        view.dtype = CHOLMOD_DOUBLE;
        cholmod_dense* x = cholmod_solve(CHOLMOD_A, factor_, &view, &work_->c);
        Vector<double> out = Eigen::Map<Vector<double> const>(static_cast<double const*>(x->x), b.size());
        cholmod_free_dense(&x, &work_->c);
        return out;
    }

    /// Dense copies of L and D.
    void factors(Matrix<double>& L, Vector<double>& D) const {
        L = Matrix<double>::Identity(size(), size());
        D.resize(size());
        auto const* const value = static_cast<double const*>(factor_->x);
        auto const* const column = static_cast<int const*>(factor_->p);
        auto const* const row = static_cast<int const*>(factor_->i);
        auto const* const count = static_cast<int const*>(factor_->nz);
        for (Index j = 0; j < size(); ++j) {
            D[j] = value[column[j]];
            for (int k = 1; k < count[j]; ++k) L(row[column[j] + k], j) = value[column[j] + k];
        }
    }
};

}  // namespace rlslab
