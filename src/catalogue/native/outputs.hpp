// Several outputs with one regressor, of any dense variant in float or double, by name: plain numbers in and out.
#pragma once

#include <rlslab/catalogue/native/filter.hpp>

namespace rlslab::native {

/// m outputs of one regressor: one P for all (rlslab::MultiOutput). Of several threads one at a time may use it, also
/// to read. Where an argument is refused std::invalid_argument is thrown, in one line, and it is as it was.
class Outputs {
protected:
    struct Shape {
        Index size, outputs;
        std::string_view variant, arithmetic;
        bool covariance;
    } shape_;
    std::int32_t health_;
    std::int64_t left_out_ = 0;

    Outputs(Shape const& shape, std::int32_t health) : shape_(shape), health_(health) {}
    enum class Part { theta, matrix, factor };

public:
    virtual ~Outputs() = default;
    Index size() const { return shape_.size; }  ///< d
    std::string_view variant() const { return shape_.variant; }
    std::string_view arithmetic() const { return shape_.arithmetic; }
    Index outputs() const { return shape_.outputs; }  ///< m

    using Numbers = Fleet::Numbers;
    /// One row: psi of d numbers, y of m. A y that is not finite: the row is lost for all outputs, and its time passes;
    /// a psi that is not spoils all. steps: room for m, or null. Returns the worst health of the m steps. Numbers of
    /// the other arithmetic are rounded once; psi and y are of one.
    virtual std::int32_t update(Numbers psi, Numbers y, Step* steps) = 0;
    /// Rows, the oldest first: row k of X is d contiguous numbers, that of Y m, `stride` numbers behind row k - 1 (0:
    /// without a gap). qr_block takes 256 at a time and joseph_rank_two 64, X where it stands if it is of the filter's
    /// arithmetic (a block of Y is copied); the others row by row. A number that is not finite: nothing is taken, and
    /// std::invalid_argument names the row. With leave_out such rows are left out, as if they had never come, bit for
    /// bit. Returns the health of the last row or block.
    struct Rows {
        Numbers X, Y;
        Index count, X_stride = 0, Y_stride = 0;
    };
    virtual std::int32_t update_many(Rows const& rows, bool leave_out = false) = 0;
    /// The outputs behind the last one are those of y = 0 in all rows so far, exactly. Throws where theta0 is not 0.
    virtual void add_outputs(Index more) = 0;
    /// The rows of `newer`, made without a prior, behind those taken. Of qr_block.
    virtual void merge(Outputs const& newer) = 0;

    /// d x m, by rows: parameter i of output j is out[i m + j]. NaN until the rows determine it.
    void theta(double* out) const { copy(Part::theta, out); }
    bool reports_covariance() const { return shape_.covariance; }
    /// P, or P^-1, whichever is reported: d x d, by columns.
    void matrix(double* out) const { copy(Part::matrix, out); }
    /// F, d x d, by columns, F F' = matrix(): of the variants that store a root (of qr_block F = R').
    void factor(double* out) const { copy(Part::factor, out); }
    std::int32_t health() const { return health_; }      ///< of the last row or block
    std::int64_t left_out() const { return left_out_; }  ///< rows, since it was made, reset or loaded

    virtual void reset() = 0;  ///< as it was made, with as many outputs as now
    std::size_t state_size() const { return save({}); }
    /// Returns state_size(); into an empty span it writes nothing.
    virtual std::size_t save(std::span<std::byte> to) const = 0;
    /// Of the same variant, arithmetic, size and number of outputs.
    virtual void load(std::span<std::byte const> from) = 0;
    virtual std::unique_ptr<Outputs> clone() const = 0;

private:
    virtual void copy(Part part, double* to) const = 0;
};

/// As `make`; of plain variants, all but extended_qr and kalman.
std::unique_ptr<Outputs> make_outputs(std::string_view variant, std::string_view arithmetic, Index outputs,
                                      Options const& options);

/// How many threads share the work on one block of rows, in all filters of the process; 1 at the start. The bits do not
/// depend on it.
void use_threads(Index threads);

}  // namespace rlslab::native
