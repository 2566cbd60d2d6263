// Nine defects that were read in other libraries. Each is a law that ours keeps, and that a copy of the defect breaks.
#include <rlslab/arithmetic/multiprecision.hpp>

#include "tests/adapt/adapt.hpp"

#include <rlslab/adapt/guard.hpp>
#include <rlslab/adapt/outputs.hpp>
#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/variants/variants.hpp>

#include <gtest/gtest.h>

#include <optional>

namespace rlslab {
namespace {

using namespace adapt_laws;

constexpr double u = 0x1p-53;
using Psi = Vector<double>;

template <class Law>
void for_each_variant(Law law) {
    for_each(Variants<double>{}, law);
}
/// What the saboteurs are made of: the textbook's P in full storage, with theta and gain.
struct Textbook {
    using scalar = double;
    double lambda;
    Psi theta_, K;
    Eigen::MatrixXd P;

    explicit Textbook(Problem<double> const& p)
        : lambda(p.forgetting), theta_(Psi::Zero(p.size)), K(Psi::Zero(p.size)),
          P(Eigen::MatrixXd::Identity(p.size, p.size) * p.prior->variance) {
        if (p.prior->theta) theta_ = *p.prior->theta;
    }
    void update(Regressor<double> row, double y) {
        Psi const psi = Eigen::Map<Psi const>(row.data(), row.size()), f = P * psi;
        K = f / (lambda + psi.dot(f));
        P = (P - K * f.transpose()) / lambda;
        theta_ += K * (y - psi.dot(theta_));
    }
    Psi theta() const { return theta_; }
    Psi gain() const { return K; }
    Stored<double> stored() const { return {Stored<double>::Quantity::covariance, Stored<double>::Form::plain, P}; }
};
Psi random_row(Seed& seed, Index d) {
    Psi psi(d);
    for (double& x : psi) x = seed.bell();
    return psi;
}
bool is_definite(Matrix<double> const& P) {
    return P.allFinite() && Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(Eigen::MatrixXd(P)).eigenvalues()[0] > 0;
}

// --- 1. a guard that makes P indefinite (indiflight's rls.c, flight-solver) ------------------------------------------

/// Theirs is meant to limit how fast P falls. It multiplies P itself, and not what is subtracted from it:
///   P = (kappa P - K f') / lambda,  kappa = min(1, 0.9 max_i P_ii / (K f')_ii)
struct LimitsP : Textbook {
    using Textbook::Textbook;
    void update(Regressor<double> row, double y) {
        Eigen::MatrixXd const before = P;
        Textbook::update(row, y);
        Eigen::MatrixXd const taken = before - lambda * P;
        double ratio = 0;
        for (Index i = 0; i < P.rows(); ++i)
            if (taken(i, i) > 0) ratio = std::max(ratio, before(i, i) / taken(i, i));
        P = (std::min(1.0, 0.9 * ratio) * before - taken) / lambda;
    }
};
/// From P0 = 100 I: a first regressor with one entry, or dense ones.
template <class F>
bool stays_definite(Index d, bool one_entry, unsigned seed) {
    F f(Problem<double>{.size = d, .forgetting = 0.995, .prior = Prior<double>{.variance = 100}});
    Seed rows{seed};
    for (int k = 0; k < 100; ++k) {
        Psi psi = random_row(rows, d);
        if (one_entry && k == 0) psi = Psi::Unit(d, 0);
        f.update(psi, rows.bell());
        if (!is_definite(covariance_of(f))) return false;
    }
    return true;
}
TEST(PeersDefects, AGuardDoesNotMakePIndefinite) {
    for (Index d : {1, 2, 4, 8}) {
        for (unsigned seed : {1, 2, 3}) {
            EXPECT_TRUE((stays_definite<Guarded<Conventional<double>>>(d, true, seed))) << d;
            EXPECT_TRUE((stays_definite<Guarded<Ud<double>, rebuilding>>(d, false, seed))) << d;
        }
        EXPECT_FALSE(stays_definite<LimitsP>(d, true, 1)) << d;
        EXPECT_TRUE(stays_definite<Textbook>(d, true, 1)) << d << ": without that guard";
    }
    LimitsP published({.size = 2, .forgetting = 0.995, .prior = Prior<double>{.variance = 100}});
    published.update({1.0, 0.0}, 1);
    EXPECT_NEAR(published.P(0, 0), -8.16, 0.01);
}

// --- 2. a half-life that leaves 31 % (the same two) ------------------------------------------------------------------

/// Theirs: lambda = (1 - ln 2)^(1/T), documented as the lambda that leaves a row half of its weight after T rows.
double theirs(double rows) { return correctly::pow(1 - correctly::log(2.0), 1 / rows); }
double half_life(double rows) { return correctly::pow(0.5, 1 / rows); }

/// What is left after `rows` rows of the information that a filter of one parameter had.
template <class F>
double weight_left(double lambda, int rows) {
    F f(Problem<double>{.size = 1, .forgetting = lambda, .prior = Prior<double>{.variance = 4}});
    Vector<double> const silence = Vector<double>::Zero(1);
    for (int k = 0; k < rows; ++k) f.update(silence, 0);
    return 4 / covariance_of(f)(0, 0);
}
TEST(PeersDefects, ARowLosesHalfItsWeightInAHalfLife) {
    for_each_variant([]<class F>() {
        // sqrt(lambda) rounded, squared, to the T-th power: 3 u a row, as much again for P from its factor.
        for (int rows : {1, 10, 693})
            EXPECT_NEAR(weight_left<F>(half_life(rows), rows), 0.5, 6 * (rows + 2) * u) << F::name << rows;
        EXPECT_NEAR(weight_left<F>(theirs(10), 10), 0.307, 0.001) << F::name;
    });
}

// --- 3. a window that takes back rows it never took (gapost's BlockRLS) ----------------------------------------------

/// Theirs: the window is filled with the rows e_1, e_2 ... that would give P = I, whatever P starts from; of what is
/// left when a row goes only b == 0 is refused.
class SeededWindow : public Textbook {
    std::vector<Psi> rows_;
    size_t at_ = 0;

public:
    bool refuses_negative = false;  ///< what their square-root form does
    int failed = 0;

    SeededWindow(Problem<double> const& p, WindowOptions<double> const& options) : Textbook(p) {
        for (Index k = 0; k < options.rows; ++k)
            rows_.push_back(k < p.size ? Psi(Psi::Unit(p.size, k)) : Psi(Psi::Zero(p.size)));
    }
    void update(Regressor<double> row, double y) {
        Textbook::update(row, y);
        Psi const out = rows_[at_], f = P * out;
        double const b = 1 - out.dot(f);
        failed += b <= 0;
        if (b != 0 && !(refuses_negative && b < 0)) P += f * f.transpose() / b;
        rows_[at_] = Eigen::Map<Psi const>(row.data(), row.size());
        at_ = (at_ + 1) % rows_.size();
    }
};
template <class W>
bool keeps_its_window(double variance) {
    W w({.size = 2, .prior = Prior<double>{.variance = variance}}, {.rows = 10});
    Seed rows{1};
    for (int k = 0; k < 25; ++k) {
        w.update(random_row(rows, 2), rows.bell());
        if (!is_definite(covariance_of(w))) return false;
    }
    return true;
}
TEST(PeersDefects, AWindowTakesBackOnlyRowsThatItTook) {
    for (double variance : {1.0, 10.0, 100.0, 0x1p20}) {
        EXPECT_TRUE((keeps_its_window<Windowed<Symmetric<double>>>(variance))) << variance;
        EXPECT_TRUE((keeps_its_window<Windowed<Ud<double>>>(variance))) << variance;
        EXPECT_TRUE((keeps_its_window<Windowed<Qr<double>>>(variance))) << variance;
        EXPECT_EQ(keeps_its_window<SeededWindow>(variance), variance == 1) << variance;
    }
}
/// What is refused, or taken, of a row that the filter does not hold: nothing would be left.
template <class F>
bool refuses_what_leaves_less_than_nothing() {
    F f(Problem<double>{.size = 2, .prior = Prior<double>{.variance = 10}});
    auto const before = f;
    auto const out = remove(f, Regressor<double>({1.0, 0.0}), 1.0, 1.0);
    return out.refused() && identical(f, before);
}
/// A Textbook with a removal that refuses b == 0 alone.
struct TakesNegative : Textbook {
    using Textbook::Textbook;
};
struct Taken {
    bool taken;
    bool refused() const { return !taken; }
};
Taken remove(TakesNegative& f, Regressor<double> row, double, double) {
    Psi const psi = Eigen::Map<Psi const>(row.data(), row.size()), v = f.P * psi;
    double const b = 1 - psi.dot(v);
    if (b != 0) f.P += v * v.transpose() / b;
    return {b != 0};
}
TEST(PeersDefects, ARemovalThatWouldLeaveLessThanNothingIsRefused) {
    for_each_variant([]<class F>() {
        if constexpr (Downdates<F>) {
            EXPECT_TRUE(refuses_what_leaves_less_than_nothing<F>()) << F::name;
        }
    });
    EXPECT_FALSE(refuses_what_leaves_less_than_nothing<TakesNegative>());
}

// --- 4. a factorisation that later rows do not renew (GSL's multilarge tsqr) -----------------------------------------

/// Theirs: what was factored at the first solution serves all later ones, with the right-hand side of now.
struct FactorsOnce : Textbook {
    Psi b;
    mutable std::optional<Eigen::MatrixXd> factored;
    explicit FactorsOnce(Problem<double> const& p) : Textbook(p), b(Psi::Zero(p.size)) {}
    void update(Regressor<double> row, double y) {
        Textbook::update(row, y);
        b = lambda * b + Eigen::Map<Psi const>(row.data(), row.size()) * y;
    }
    Psi theta() const {
        if (!factored) factored = P;
        return *factored * b;
    }
};
template <class F>
bool answers_from_all_rows() {
    Problem<double> const problem{.size = 3, .forgetting = 0.96875, .prior = Prior<double>{.variance = 4}};
    F asked(problem), not_asked(problem);
    Seed rows{5};
    for (int k = 0; k < 30; ++k) {
        Psi const psi = random_row(rows, 3);
        double const y = rows.bell();
        asked.update(psi, y);
        not_asked.update(psi, y);
        if (k % 10 == 9) (void)asked.theta(), (void)asked.gain(), (void)asked.stored();
    }
    return Psi(asked.theta()) == Psi(not_asked.theta()) && asked.stored().F == not_asked.stored().F;
}
TEST(PeersDefects, AnAnswerIsFromAllRowsWhenTheOneBeforeWasNot) {
    for_each_variant([]<class F>() { EXPECT_TRUE(answers_from_all_rows<F>()) << F::name; });
    EXPECT_FALSE(answers_from_all_rows<FactorsOnce>());
}

// --- 5. a P0 that is no covariance (gr-adapt's complex filters) ------------------------------------------------------

/// Theirs: P0 = (1 + i) / delta I, not Hermitian. In reals, (Re theta, Im theta): [1 -1; 1 1] / delta, not I / delta.
struct TakesAnyPrior : Textbook {
    explicit TakesAnyPrior(Problem<double> const& p) : Textbook(p) {
        if (p.prior->covariance) P = *p.prior->covariance;
    }
};
template <class F>
bool refuses_a_prior_that_is_no_covariance() {
    for (double imaginary : {1.0, 1e-9}) {
        Matrix<double> const P0{{100, -100 * imaginary}, {100 * imaginary, 100}};
        try {
            F const f(Problem<double>{.size = 2, .prior = Prior<double>{.covariance = P0}});
            return false;
        } catch (std::invalid_argument const&) {}
    }
    return true;
}
TEST(PeersDefects, APriorIsACovariance) {
    for_each_variant([]<class F>() {
        EXPECT_TRUE(refuses_a_prior_that_is_no_covariance<F>()) << F::name;
        Matrix<double> const P = covariance_of(F(Problem<double>{.size = 3, .prior = Prior<double>{.variance = 16}}));
        EXPECT_EQ(P, 16 * Matrix<double>::Identity(3, 3)) << F::name;
    });
    EXPECT_FALSE(refuses_a_prior_that_is_no_covariance<TakesAnyPrior>());
}

// --- 6. several outputs that nobody ever instantiated (Controlpp) ----------------------------------------------------

/// Theirs takes one scalar y, where there is one for each output.
template <class F>
struct TakesOneOutput : MultiOutput<F, 2> {
    using MultiOutput<F, 2>::MultiOutput;
    void update(Regressor<double> psi, Regressor<double> y) { MultiOutput<F, 2>::update(psi, {y[0], y[0]}); }
};
template <class M>
bool learns_each_output() {
    M f({.size = 2, .prior = Prior<double>{.variance = 1e6}});
    Seed rows{4};
    for (int k = 0; k < 20; ++k) {
        Psi const psi = random_row(rows, 2);
        f.update(psi, {psi[0] - 2 * psi[1], 5 * psi[1]});
    }
    return (f.theta() - Matrix<double, 2>{{1.0, 0.0}, {-2.0, 5.0}}).cwiseAbs().maxCoeff() < 1e-4;
}
TEST(PeersDefects, SeveralOutputsAreSeveral) {
    for_each_variant([]<class F>() {
        if constexpr (requires { typename MultiOutput<F, 2>; }) {
            EXPECT_TRUE((learns_each_output<MultiOutput<F, 2>>())) << F::name;
            EXPECT_FALSE(learns_each_output<TakesOneOutput<F>>()) << F::name;
        }
    });
}

// --- 7. a covariance after the row that is the one before it (filterpy's square-root filter) -------------------------

template <class F>
struct ReportsBefore : F {
    Stored<typename F::scalar> before;
    explicit ReportsBefore(Problem<typename F::scalar> const& p) : F(p), before(F::stored()) {}
    void update(Regressor<typename F::scalar> psi, typename F::scalar y) {
        before = F::stored();
        F::update(psi, y);
    }
    Stored<typename F::scalar> stored() const { return before; }
};
/// K = P psi holds of the P after the row; before it, K = P psi / s. Exact.
template <class F>
bool reports_the_covariance_after_the_row() {
    using Q = Rational;
    F f(Problem<Q>{.size = 2, .forgetting = Q(9) / 10, .prior = Prior<Q>{.variance = Q(4)}});
    Seed rows{6};
    for (int k = 0; k < 5; ++k) {
        Vector<Q> psi(2);
        for (Q& x : psi) x = int(rows.next() % 15) - 7;
        if (psi[0] == 0 && psi[1] == 0) continue;
        f.update(psi, Q(int(rows.next() % 9)));
        Stored<Q> const stored = f.stored();
        Matrix<Q> const X = multiplied_out(stored);
        Vector<Q> const K = f.gain();
        bool const covariance = stored.quantity == Stored<Q>::Quantity::covariance;
        if (!(covariance ? Vector<Q>(X.lazyProduct(psi)) == K : Vector<Q>(X.lazyProduct(K)) == psi)) return false;
    }
    return true;
}
TEST(PeersDefects, TheCovarianceIsThatAfterTheRow) {
    for_each(Variants<Rational>{}, []<class F>() {
        EXPECT_TRUE(reports_the_covariance_after_the_row<F>()) << F::name;
        EXPECT_FALSE(reports_the_covariance_after_the_row<ReportsBefore<F>>()) << F::name;
    });
}

// --- 8. weights that nobody has written yet, and lambda = 0 (liquid's eqrls) -----------------------------------------

struct AnswersFromTheLastStep : Textbook {
    Psi answer;
    explicit AnswersFromTheLastStep(Problem<double> const& p) : Textbook(p), answer(Psi::Constant(p.size, 1e30)) {}
    void update(Regressor<double> psi, double y) {
        Textbook::update(psi, y);
        answer = theta_;
    }
    Psi theta() const { return answer; }
};
template <class F>
bool answers_before_the_first_row() {
    Psi const theta0{{1.0, -2.0, 0.5}};
    F const f(Problem<double>{.size = 3, .prior = Prior<double>{.variance = 4, .theta = theta0}});
    return Psi(f.theta()) == theta0;  // P0 = 4 I: a root of it, and its inverse, are exact
}
template <class F>
bool refuses_lambda(double lambda) {
    try {
        F const f(Problem<double>{.size = 2, .forgetting = lambda});
    } catch (std::invalid_argument const&) {
        return true;
    }
    return false;
}
TEST(PeersDefects, ThetaIsThereBeforeTheFirstRow) {
    for_each_variant([]<class F>() { EXPECT_TRUE(answers_before_the_first_row<F>()) << F::name; });
    EXPECT_TRUE((answers_before_the_first_row<Guarded<Ud<double>>>()));
    EXPECT_TRUE((answers_before_the_first_row<Windowed<Qr<double>>>()));
    EXPECT_FALSE(answers_before_the_first_row<AnswersFromTheLastStep>());
}
TEST(PeersDefects, LambdaZeroIsRefused) {
    for (double lambda : {0.0, -0.5, 1.5, double(NAN), double(INFINITY)}) {
        for_each_variant([lambda]<class F>() { EXPECT_TRUE(refuses_lambda<F>(lambda)) << F::name << lambda; });
        EXPECT_TRUE((refuses_lambda<Guarded<Ud<double>>>(lambda))) << lambda;
        EXPECT_TRUE((refuses_lambda<Windowed<Ud<double>>>(lambda))) << lambda;
        EXPECT_FALSE(refuses_lambda<Textbook>(lambda)) << lambda;
    }
}

// --- 9. a name that is another form's (flight-solver's inverse QR) ---------------------------------------------------

/// Theirs: keeps R, the factor of the information, and solves for theta.
struct CalledInverse : Qr<double> {
    using Qr::Qr;
    static constexpr std::string_view name = "inverse_qr";
};
bool is_named_for_the_inverse(std::string_view name) {
    for (std::string_view form : {"information", "qr", "gentleman", "qr_block"})
        if (name == form) return true;
    return false;
}
/// What is stored is P, or P^-1, as the form of that name has it; and the numbers say so, too: of rows that leave P =
/// 1/50.
template <class F>
bool stores_what_its_name_says() {
    F f(Problem<double>{.size = 1, .prior = Prior<double>{.variance = 1}});
    Vector<double> const seven = Vector<double>::Constant(1, 7);
    f.update(seven, 1);
    Stored<double> const stored = f.stored();
    bool const inverse = is_named_for_the_inverse(F::name);
    return (stored.quantity == Stored<double>::Quantity::information) == inverse &&
           std::abs(multiplied_out(stored)(0, 0) * (inverse ? 0.02 : 50) - 1) < 4 * 50 * u;  // 1 - 49/50 cancels
}
TEST(PeersDefects, AFormStoresWhatItsNameSays) {
    for_each_variant([]<class F>() { EXPECT_TRUE(stores_what_its_name_says<F>()) << F::name; });
    EXPECT_FALSE(stores_what_its_name_says<CalledInverse>());
}

}  // namespace
}  // namespace rlslab
