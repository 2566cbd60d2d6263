// The Gram matrix of [psi y]: exactly in integers, or with forgetting in balls.
#include <rlslab/reference/gram.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace rlslab::balls {

namespace {

double entry_of(Records const& data, Index j, Index k) { return j < data.parameters() ? data.psi(j, k) : data.y(k); }

}  // namespace

Dyadic dyadic(double x) {
    if (x == 0) return {};
    int exponent = 0;
    auto const wide = std::int64_t(std::ldexp(std::frexp(x, &exponent), 53));
    int const zeros = std::countr_zero(std::uint64_t(wide));
    return {wide >> zeros, exponent - 53 + zeros};
}

IntegerGram::IntegerGram(Records const& data, Index last)
    : data_(data), unit_(size_t(data.parameters() + 1), std::numeric_limits<int>::max()),
      sum_(data.parameters() + 1, data.parameters() + 1) {
    for (Index k = 0; k < last; ++k)
        for (Index j = 0; j <= data.parameters(); ++j)
            if (auto const x = dyadic(entry_of(data, j, k)); x.mantissa != 0)
                unit_[size_t(j)] = std::min(unit_[size_t(j)], x.exponent);
    for (int& e : unit_)
        if (e == std::numeric_limits<int>::max()) e = 0;  // a column of zeros
}

void IntegerGram::advance(Index k, std::function<void()> const& pause) {
    // FLINT's products have a fixed cost per call and copy the block: some hundreds of rows are enough.
    constexpr Index block = 256;
    for (; rows_ < k; rows_ = std::min(k, rows_ + block)) {
        add(rows_, std::min(block, k - rows_));
        if (pause) pause();
    }
}

void IntegerGram::add(Index first, Index count) {
    Index const m = data_.parameters() + 1;
    IntegerMatrix A(m, count), transposed(count, m), product(m, m);
    for (Index k = 0; k < count; ++k)
        for (Index j = 0; j < m; ++j) {
            auto const x = dyadic(entry_of(data_, j, first + k));
            if (x.mantissa == 0) continue;
            fmpz_set_si(A(j, k), x.mantissa);
            fmpz_mul_2exp(A(j, k), A(j, k), ulong(x.exponent - unit_[size_t(j)]));
            fmpz_set(transposed(k, j), A(j, k));
        }
    fmpz_mat_mul(product, A, transposed);
    fmpz_mat_add(sum_, sum_, product);
}

void IntegerGram::entry(arb_ptr ball, Index i, Index j, long bits) const {
    Integer const exponent(long(unit_[size_t(i)]) + unit_[size_t(j)]);
    arb_set_round_fmpz_2exp(ball, sum_(i, j), exponent, bits);
}

ForgettingGram::ForgettingGram(Records const& data, double forgetting, BallMatrix M0, long bits, unsigned power)
    : data_(data), bits_(bits), power_(size_t(block + 1), Ball(1.0)), sum_(std::move(M0)),
      a_(data.parameters() + 1, block), wa_(data.parameters() + 1, block) {
    Ball lambda(forgetting);
    arb_pow_ui(lambda, lambda, power, bits_);
    for (Index i = 1; i <= block; ++i) arb_mul(power_[size_t(i)], power_[size_t(i - 1)], lambda, bits_);
}

void ForgettingGram::advance(Index k, std::function<void()> const& pause) {
    for (; rows_ < k; rows_ = std::min(k, rows_ + block)) {
        add(rows_, std::min(block, k - rows_));
        if (pause) pause();
    }
}

void ForgettingGram::add(Index first, Index count) {  // (1)
    Index const m = data_.parameters() + 1;
    for (Index j = 0; j < m; ++j)
        for (Index k = 0; k < count; ++k) {
            arb_set_d(a_(j, k), entry_of(data_, j, first + k));
            arb_mul(wa_(j, k), a_(j, k), power_[size_t(count - 1 - k)], bits_);
        }
    for (Index j = 0; j < m; ++j)
        for (Index i = 0; i <= j; ++i) {
            arb_mul(sum_(i, j), sum_(i, j), power_[size_t(count)], bits_);
            arb_dot(sum_(i, j), sum_(i, j), 0, a_(i, 0), 1, wa_(j, 0), 1, count, bits_);
        }
}

WeightedGram::WeightedGram(Records const& data, double lambda, Index last, unsigned power, long bits)
    : size_(data.parameters() + 1), bits_(bits) {
    if (lambda == 1) exact_ = std::make_unique<IntegerGram>(data, last);
    else forgetting_ = std::make_unique<ForgettingGram>(data, lambda, BallMatrix(size_, size_), bits, power);
}

BallMatrix WeightedGram::at(Index k) {
    BallMatrix out(size_, size_);
    exact_ ? exact_->advance(k) : forgetting_->advance(k);
    for (Index j = 0; j < size_; ++j)
        for (Index i = 0; i <= j; ++i) {
            if (exact_) exact_->entry(out(i, j), i, j, bits_);
            else arb_set(out(i, j), forgetting_->matrix()(i, j));
            arb_set(out(j, i), out(i, j));
        }
    return out;
}

BallMatrix leading(BallMatrix const& A, Index d) {
    BallMatrix out(d, d);
    for (Index i = 0; i < d; ++i)
        for (Index j = 0; j < d; ++j) arb_set(out(i, j), A(i, j));
    return out;
}

}  // namespace rlslab::balls
