// Filters by name against their types: the laws.
#include "tests/catalogue/by_name.hpp"

#include <rlslab/catalogue/composed.hpp>
#include "tests/common/composed.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace rlslab::by_name {
namespace {

using native::Filter;

/// As Typed::update's, and P.
Left left_by(Filter const& f, native::Step const& s) {
    std::vector<double> theta(d), gain(d);
    f.theta(theta.data());
    f.gain(gain.data());
    Left out;
    out.add("innovation", s.innovation).add("residual", s.residual).add("gamma", s.gamma).add("health", s.health);
    return out.add("theta", theta).add("gain", gain).add("signal", s.signal);
}
Left reported(Filter const& f) {
    std::vector<double> P(d * d);
    if (f.reports_covariance()) f.covariance(P.data());
    else f.information(P.data());
    return Left().add("P", P);
}
/// A row of floats is given as one.
native::Step update(Filter& f, Vector<double> const& psi, double y) {
    Vector<float> const row = psi.cast<float>();
    bool const fits = row.cast<double>() == psi && double(float(y)) == y;
    return fits ? f.update(row.data(), float(y)) : f.update(psi.data(), y);
}
/// And a NaN, after which a variant that is alone has NaN of one sign or another.
Records const& records_with_nan() {
    static Records const all = [] {
        Records out = records();
        out.psi(1, 480) = std::numeric_limits<double>::quiet_NaN();
        return out;
    }();
    return all;
}

void expect_rows_alike(Typed const& start, Filter const& fresh, Records const& rows) {
    auto typed = start.clone();
    auto filter = fresh.clone();
    std::unique_ptr<Filter> found;  // from the state alone
    bool const is_alone = !parted(start.reported(), Left()).empty();
    for (Index k = 0; k < rows.rows(); ++k) {
        Vector<double> const psi = rows.psi.col(k);
        double const y = rows.y[k];
        ASSERT_EQ(parted(left_by(*filter, update(*filter, psi, y)), typed->update(psi, y)), "") << k;
        ASSERT_EQ(saved(*filter), typed->saved()) << k;
        if (is_alone) {
            ASSERT_EQ(parted(reported(*filter), typed->reported()), "") << k;
        }
        if (found) {
            update(*found, psi, y);
            ASSERT_EQ(saved(*found), typed->saved()) << k;
        }
        if (k != rows.rows() / 2) continue;
        Bytes const state = saved(*filter);
        typed = start.clone();
        ASSERT_EQ(typed->load(state), StateFault::none);
        auto const another = fresh.clone();
        another->load(state);
        filter = another->clone();
        found = native::from_state(state);
        for (Filter const* f : {filter.get(), found.get()}) ASSERT_EQ(saved(*f), state);
        ASSERT_EQ(typed->saved(), state);
        ASSERT_EQ(found->variant(), fresh.variant());
        Bytes damaged = state;
        damaged[damaged.size() / 2] ^= std::byte(1);
        EXPECT_THROW(filter->load(damaged), std::invalid_argument);
        EXPECT_THROW(filter->load(std::span(state).first(7)), std::invalid_argument);
        EXPECT_EQ(saved(*filter), state) << "as it was";
    }
    if (auto const counts = typed->counts(); !counts.empty()) {
        native::Counts const c = filter->counts();
        std::vector<Index> const of_guard{c.unusable, c.outliers, c.changes, c.windups, c.breakdowns};
        EXPECT_EQ(std::vector(counts.begin() + 1, counts.end()), of_guard);
        EXPECT_GT(c.outliers + c.unusable, 0);
    }
    EXPECT_EQ(saved(fresh), start.saved()) << "a copy is a filter of its own";
    EXPECT_NE(saved(*filter), start.saved());
    filter->reset();
    EXPECT_EQ(saved(*filter), start.saved());
    EXPECT_EQ(filter->counts().rows, 0);
    EXPECT_EQ(parted(left_by(*filter, filter->pass_time()), start.clone()->pass_time()), "") << "time passes";
}
void expect_many_rows_alike(Typed const& start, Filter const& fresh, Records const& given) {
    Index const rows = given.rows(), stride = d + 3;
    Matrix<double> apart(stride, rows);
    apart.setConstant(std::numeric_limits<double>::quiet_NaN());
    apart.topRows(d) = given.psi;
    Matrix<float> const floats = apart.cast<float>();
    Vector<double> const& y = given.y;
    Vector<float> const y_floats = y.cast<float>();
    auto const typed = start.clone(), typed_floats = start.clone(), one_by_one = start.clone();
    auto const filter = fresh.clone(), of_floats = fresh.clone(), with_steps = fresh.clone();
    EXPECT_EQ(parted(left_by(*filter, filter->update_many(apart.data(), rows, stride, y.data(), nullptr)),
                     typed->process(given.psi, y)),
              "");
    EXPECT_EQ(saved(*filter), typed->saved());
    of_floats->update_many(floats.data(), rows, stride, y_floats.data(), nullptr);
    typed_floats->process(floats.topRows(d).cast<double>(), y_floats.cast<double>());
    EXPECT_EQ(saved(*of_floats), typed_floats->saved());
    std::vector<native::Step> steps(std::size_t(rows), native::Step{});
    with_steps->update_many(apart.data(), rows, stride, y.data(), steps.data());
    for (Index k = 0; k < rows; ++k) {
        native::Step const& s = steps[std::size_t(k)];
        Left const left = one_by_one->update(given.psi.col(k), y[k]);
        auto const of_type = [&](char const* name) { return left.of(name)[0]; };
        EXPECT_TRUE(s.gamma == of_type("gamma") || std::isnan(s.gamma)) << k;
        EXPECT_TRUE(s.innovation == of_type("innovation") || std::isnan(s.innovation)) << k;
        EXPECT_TRUE(s.health == of_type("health") && s.signal == of_type("signal")) << k;
    }
    EXPECT_EQ(saved(*with_steps), one_by_one->saved());
    EXPECT_TRUE(std::isnan(filter->update_many(apart.data(), 0, 0, y.data(), nullptr).gamma));
    EXPECT_THROW(filter->update_many(apart.data(), 1, d - 1, y.data(), nullptr), std::invalid_argument);
    EXPECT_THROW(filter->update_many(apart.data(), -1, 0, y.data(), nullptr), std::invalid_argument);
}
/// The first row in which the lab's filter leaves another bit than the type, or all.
Index rows_alike_in_the_lab(Typed const& start, native::Options const& options) {
    Composition const composition{.control = std::string(options.control),
                                  .parameters = {options.control_numbers.begin(), options.control_numbers.end()},
                                  .window = options.window,
                                  .guard = std::string(options.guard),
                                  .certify = options.certify,
                                  .digits = options.digits};
    auto const typed = start.clone();
    auto const made = composed(composition, start.variant, start.arithmetic, problem_of(options));
    for (Index k = 0; k < records_with_nan().rows(); ++k) {
        made->update(records_with_nan().sample(k), records_with_nan().y[k]);
        typed->update(records_with_nan().psi.col(k), records_with_nan().y[k]);
        Stored<Reference> const stored = made->stored();
        auto const number = [](Reference const& x) { return static_cast<double>(x); };
        Left shown;
        shown.add("theta", Vector<double>(made->theta().unaryExpr(number)));
        shown.add("F", Matrix<double>(stored.F.unaryExpr(number))).add("D", Vector<double>(stored.D.unaryExpr(number)));
        if (!parted(shown, typed->stored()).empty()) return k;
    }
    return records_with_nan().rows();
}

}  // namespace

Records const& records() {
    static Records const all = [] {
        Records out = composed_laws::rows_of(500, 100, 250, Seed{21});
        out.psi.middleCols(300, 60).setZero();
        for (Index k = 1; k < 500; k += 2) {
            out.psi.col(k) = out.psi.col(k).cast<float>().cast<double>().eval();
            out.y[k] = double(float(out.y[k]));
        }
        return out;
    }();
    return all;
}
Problem<double> problem_of(native::Options const& options) {
    return {.size = d, .forgetting = options.forgetting, .prior = Prior<double>{.variance = 64}};
}
Bytes saved(Filter const& f) {
    Bytes out(f.state_size());
    f.save(out);
    return out;
}
void expect_alike(Typed const& typed, native::Options options) {
    SCOPED_TRACE(testing::Message() << typed.variant << " in " << typed.arithmetic << ' ' << options.control << ' '
                                    << options.window << ' ' << options.guard);
    options.size = d, options.prior_variance = 64;
    auto const filter = native::make(typed.variant, typed.arithmetic, options);
    EXPECT_EQ(filter->variant(), typed.variant);
    EXPECT_EQ(filter->arithmetic(), typed.arithmetic);
    EXPECT_EQ(filter->size(), d);
    bool const is_alone = options.window == 0 && options.guard.empty() && options.control.empty();
    Records const& rows = is_alone ? records() : records_with_nan();
    expect_rows_alike(typed, *filter, rows);
    expect_many_rows_alike(typed, *filter, rows);
    if (is_alone && options.certify == 0) return;
    if (options.noise_memory == 0) {
        EXPECT_EQ(rows_alike_in_the_lab(typed, options), records().rows());
    }
    if (options.control == "constant" || is_alone) return;
    auto const bare = native::make(typed.variant, typed.arithmetic,
                                   {.size = d, .forgetting = options.forgetting, .prior_variance = 64});
    bare->update_many(records().psi.data(), 480, 0, records().y.data(), nullptr);
    filter->update_many(records().psi.data(), 480, 0, records().y.data(), nullptr);
    if (options.guard != "report") {
        EXPECT_NE(parted(reported(*bare), reported(*filter)), "") << "the variant alone is another filter";
    }
}

}  // namespace rlslab::by_name
