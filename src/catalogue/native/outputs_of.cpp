// Outputs of the variants in one arithmetic, RLSLAB_NATIVE: float or double.
#include <rlslab/catalogue/native/makers.hpp>
#include <rlslab/catalogue/native/merging.hpp>

#include <rlslab/adapt/outputs.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::native {
namespace {

std::string described(Outputs const& f) {
    return std::string(f.variant()) + " in " + std::string(f.arithmetic()) + " with " + std::to_string(f.size()) +
           " parameters and " + std::to_string(f.outputs()) + " outputs";
}

/// F is a variant.
template <class F>
class OutputsIn final : public Outputs {
    using Filters = MultiOutput<F>;
    using T = typename F::scalar;
    static constexpr bool by_blocks = requires(Filters& f, Matrix<T> const& A) { f.update_block(RowsOf<T>(A), A); };
    /// Rows at a time. Joseph's form multiplies most quickly by 64 of them, from 16 to 1000 parameters.
    static constexpr Index block = [] {
        if constexpr (TakesBlocks<F>) return F::block;
        else return Index(by_blocks ? 64 : 1);
    }();

    Problem<T> problem_;  // for reset()
    Filters filters_;
    Matrix<T> X_, Y_;  // rows that are not in place, and their outputs: d x block, block x m

    template <class X>
    static bool finite(X const* x, Index n) {
        bool out = true;
        for (Index i = 0; i < n; ++i) out = is_finite(T(x[i])) && out;
        return out;
    }
    template <class X>
    Regressor<T> rounded(X const* x, Index n, Matrix<T>& room) {
        if constexpr (std::same_as<X, T>) return {x, n};
        if (room.size() < n) room.resize(n, 1);
        for (Index i = 0; i < n; ++i) room.data()[i] = T(x[i]);
        return {room.data(), n};
    }
    std::int32_t worst() const {
        Health out = Health::sound;
        for (auto const& step : filters_.steps()) out = worse(out, step.health);
        return std::int32_t(out);
    }
    /// The n rows at `places`: in place where they stand one after another.
    template <class X>
    std::int32_t take(X const* x, Index x_stride, X const* y, Index y_stride, Index const* places, Index n) {
        if constexpr (!by_blocks) {
            filters_.update(rounded(x + *places * x_stride, size(), X_),
                            rounded(y + *places * y_stride, outputs(), Y_));
            return worst();
        } else {
            Y_.resize(n, outputs());
            for (Index k = 0; k < n; ++k)
                for (Index j = 0; j < outputs(); ++j) Y_(k, j) = T(y[places[k] * y_stride + j]);
            if constexpr (std::same_as<X, T>)
                if (places[n - 1] - places[0] == n - 1)
                    return std::int32_t(
                        filters_.update_block(RowsOf<T>(Eigen::Map<Matrix<T> const, 0, Eigen::OuterStride<>>(
                                                  x + places[0] * x_stride, size(), n, Eigen::OuterStride<>(x_stride))),
                                              Y_));
            X_.resize(size(), n);
            for (Index k = 0; k < n; ++k)
                for (Index i = 0; i < size(); ++i) X_(i, k) = T(x[places[k] * x_stride + i]);
            return std::int32_t(filters_.update_block(RowsOf<T>(X_), Y_));
        }
    }
    template <class X>
    void take_all(X const* x, Index x_stride, X const* y, Index y_stride, Index rows, bool leave_out) {
        auto const usable = [&](Index k) {
            return finite(x + k * x_stride, size()) && finite(y + k * y_stride, outputs());
        };
        if (!leave_out)
            for (Index k = 0; k < rows; ++k)
                if (!usable(k))
                    refuse("row " + std::to_string(k) +
                           ", counted from 0, has a number that is not finite: no row was " +
                           "taken; leave_out leaves such rows out");
        Index places[block] = {}, n = 0;
        for (Index k = 0; k < rows; ++k) {
            if (!leave_out || usable(k)) places[n++] = k;
            else ++left_out_;
            if (n == block || (n > 0 && k == rows - 1)) health_ = take(x, x_stride, y, y_stride, places, n), n = 0;
        }
    }

public:
    OutputsIn(Index outputs, Problem<T> const& problem)
        : Outputs({problem.size, outputs, F::name, ArithmeticTraits<T>::name, ReportsCovariance<F>}, started(problem)),
          problem_(problem), filters_(problem, outputs) {}

    std::int32_t update(Numbers psi, Numbers y, Step* steps) override {
        std::visit(
            [&]<class X>(X const* x) {
                filters_.update(rounded(x, size(), X_), rounded(std::get<X const*>(y), outputs(), Y_));
            },
            psi);
        if (steps)
            for (auto const& s : filters_.steps())
                *steps++ = {double(s.innovation), double(s.residual), double(s.gamma), std::int32_t(s.health), 0};
        return health_ = worst();
    }
    std::int32_t update_many(Rows const& rows, bool leave_out) override {
        Index const x_stride = rows.X_stride ? rows.X_stride : size(),
                    y_stride = rows.Y_stride ? rows.Y_stride : outputs();
        expects(rows.count >= 0 && x_stride >= size() && y_stride >= outputs(),
                "rows >= 0, those of X at least d numbers apart and those of Y at least m");
        std::visit(
            [&]<class X>(X const* x) {
                take_all(x, x_stride, std::get<X const*>(rows.Y), y_stride, rows.count, leave_out);
            },
            rows.X);
        return health();
    }
    void add_outputs(Index more) override {
        expects(more >= 1, "one more output or several");
        filters_.add_outputs(more);
        shape_.outputs += more;
    }
    void merge(Outputs const& newer) override {
        if constexpr (requires(Filters& f) { f.merge(f); }) {
            auto const* const part = dynamic_cast<OutputsIn const*>(&newer);
            if (!part || part->size() != size() || part->outputs() != outputs())
                refuse("expected a part of " + described(*this) + ", found " + described(newer));
            expect_newer_part(filters_.filter(), part->filters_.filter());
            health_ = std::int32_t(part == this ? filters_.merge(Filters(filters_)) : filters_.merge(part->filters_));
            left_out_ += part->left_out_;
        } else {
            refuse(std::string(variant()) + " does not merge; qr_block does");
        }
    }
    void reset() override {
        filters_ = Filters(problem_, outputs());
        health_ = started(problem_), left_out_ = 0;
    }
    std::size_t save(std::span<std::byte> to) const override {
        return to.empty() ? rlslab::state_size(filters_) : rlslab::save(filters_, to);
    }
    void load(std::span<std::byte const> from) override {
        if (StateFault const fault = rlslab::load(filters_, from); fault != StateFault::none)
            refuse(refusal_of(fault, from));
        health_ = known(), left_out_ = 0;
    }
    std::unique_ptr<Outputs> clone() const override { return std::make_unique<OutputsIn>(*this); }

private:
    static std::int32_t started(Problem<T> const& problem) {
        return std::int32_t(problem.prior ? Health::sound : Health::undetermined);
    }
    /// Of the rows so far, where there was no last one: as a row of zeros tells, and the first theta.
    std::int32_t known() const {
        Filters next = filters_;
        std::vector<T> const psi(size_t(size()), T(0)), y(size_t(outputs()), T(0));  // no symbol of Eigen's
        bool open = !all_finite<T>(filters_.filter().theta());
        for (auto const& step : next.update({psi.data(), size()}, {y.data(), outputs()}))
            open = open || step.health == Health::undetermined;
        return std::int32_t(open ? Health::undetermined : Health::sound);
    }
    void copy(Part part, double* to) const override {
        if (part == Part::theta) {
            Eigen::Map<Eigen::Matrix<double, Dynamic, Dynamic, Eigen::RowMajor>> theta(to, size(), outputs());
            if (health_ == std::int32_t(Health::undetermined) && known() == health_)
                theta.setConstant(undefined<double>());
            else theta = filters_.theta().template cast<double>();
            return;
        }
        Eigen::Map<Matrix<double>> matrix(to, size(), size());
        if (part == Part::factor) matrix = root_in(filters_.filter().stored(), variant()).template cast<double>();
        else if constexpr (ReportsCovariance<F>) matrix = filters_.covariance().template cast<double>();
        else matrix = filters_.filter().information().template cast<double>();
    }
};

}  // namespace

template <class T>
std::unique_ptr<Outputs> outputs_named(std::string_view variant, Index outputs, Problem<T> const& problem) {
    std::unique_ptr<Outputs> out;
    for_each(Variants<T>{}, [&]<class F>() {
        if constexpr (requires { typename MultiOutput<F>; })
            if (F::name == variant) out = std::make_unique<OutputsIn<F>>(outputs, problem);
    });
    return out;
}
template std::unique_ptr<Outputs> outputs_named(std::string_view, Index, Problem<RLSLAB_NATIVE> const&);

}  // namespace rlslab::native
