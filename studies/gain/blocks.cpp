// P -= K G' by blocks of rows, Joseph's form by blocks, QR of blocks and normal equations, in float and double.
#include <rlslab/catalogue/round_to.hpp>
#include <rlslab/linalg/product.hpp>
#include <rlslab/studies/judgements.hpp>
#include <rlslab/studies/scenarios.hpp>
#include <rlslab/variants/variants.hpp>

#include <rlslab/arithmetic/elementary.hpp>
#include <rlslab/arithmetic/pair.hpp>

#include <cmath>

namespace rlslab::studies {
using detail::product;
namespace {

/// S^-1 by Gauss and Jordan with pivots.
template <class T>
Matrix<T> inverse_of(Matrix<T> const& S) {
    Index const k = S.rows();
    Matrix<T> both(k, 2 * k);
    both << S, Matrix<T>::Identity(k, k);
    for (Index j = 0; j < k; ++j) {
        Index pivot = j;
        for (Index i = j + 1; i < k; ++i)
            if (std::abs(both(i, j)) > std::abs(both(pivot, j))) pivot = i;
        both.row(j).swap(both.row(pivot));
        Matrix<T> const column = both.col(j);
        for (Index c = 0; c < 2 * k; ++c) {
            both(j, c) /= column(j);
            for (Index i = 0; i < k; ++i)
                if (i != j) both(i, c) -= column(i) * both(j, c);
        }
    }
    return both.rightCols(k);
}
/// G S^-1 by Cholesky of S's lower triangle; NaN where S is not definite.
template <class T>
Matrix<T> divided(Matrix<T> G, Matrix<T> S) {
    using std::sqrt;
    Index const k = S.rows();
    auto const minus = [](auto to, T const& f, auto const& x) {
        for (Index i = 0; i < x.size(); ++i) to[i] -= f * x[i];
    };
    for (Index j = 0; j < k; ++j) {
        S(j, j) = sqrt(S(j, j));
        for (Index i = j + 1; i < k; ++i) S(i, j) /= S(j, j);
        for (Index c = j + 1; c < k; ++c) minus(S.col(c).tail(k - c), S(c, j), S.col(j).tail(k - c));
    }
    for (Index j = 0; j < k; ++j) {  // K L'
        for (Index i = 0; i < j; ++i) minus(G.col(j), S(j, i), G.col(i));
        for (Index i = 0; i < G.rows(); ++i) G(i, j) /= S(j, j);
    }
    for (Index j = k; j-- > 0;) {  // K
        for (Index i = j + 1; i < k; ++i) minus(G.col(j), S(i, j), G.col(i));
        for (Index i = 0; i < G.rows(); ++i) G(i, j) /= S(j, j);
    }
    return G;
}

/// What people run. `inverse`: K = G S^-1 with S's explicit inverse, P -= K (X'P), theta += P X e with the new P;
/// otherwise K by Cholesky, P -= K G', theta += K e. Divided by lambda^k; row j of the block weighs lambda^(k-j).
template <class T>
struct Published {
    bool inverse;
    T lambda;
    Matrix<T> P;
    Matrix<T> theta;

    Published(Problem<T> const& p, bool inverse_)
        : inverse(inverse_), lambda(p.forgetting), P(p.prior->variance * Matrix<T>::Identity(p.size, p.size)),
          theta(Matrix<T>::Zero(p.size, 1)) {}

    template <class Perturb>
    void update_block(Matrix<T> const& X, Matrix<T> const& y, Perturb perturb) {
        Index const k = X.cols();
        Matrix<T> const G = product(P, X), Xt = X.transpose();
        Matrix<T> S = product(Xt, G);
        Matrix<T> e = y - product(Xt, theta);
        T weight(1);
        for (Index j = 0; j < k; ++j) S(j, j) += weight *= lambda;
        Matrix<T> K = inverse ? product(G, inverse_of(S)) : divided(G, S);
        perturb(K);
        P -= inverse ? product(K, product(Xt, P)) : product(K, Matrix<T>(G.transpose()));
        P /= weight;
        if (inverse)
            for (T left(1), *at = e.data() + k; at-- != e.data(); left *= lambda) *at *= left;
        theta += product(inverse ? product(P, X) : K, e);
    }
};

/// psi, y in the numbers of float, so that all words have the same data. `rotated`: geometric deviations from 1 to
/// 1/kappa, in columns that two reflections mix. `features`: max(0, W z + noise), z of 16 inputs.
struct Data {
    Matrix<double> X;
    Matrix<double> y;
    Data(Trial const& t, Index count) : X(Index(t.number("d")), count), y(count, 1) {
        Index const d = X.rows();
        Seed seed = t.seed({"rows", "d", "kappa", "replicate"});
        auto const bells = [&](Index rows, Index columns) {
            Matrix<double> out(rows, columns);
            for (Index j = 0; j < columns; ++j)
                for (Index i = 0; i < rows; ++i) out(i, j) = seed.bell();
            return out;
        };
        double const down = correctly::log(t.number("kappa")) / double(d - 1);
        Matrix<double> const V = bells(d, 2), W = bells(d, 16);
        for (Index k = 0; k < count; ++k) {
            Matrix<double> x = bells(d, 1);
            if (t.text("rows") == "features") {
                Matrix<double> const z = bells(16, 1), signal = product(W, z);
                for (Index i = 0; i < d; ++i) x(i) = std::max(0.0, signal(i) / 4 + 0.3 * x(i));
            } else {
                for (Index i = 0; i < d; ++i) x(i) *= correctly::exp(-double(i) * down);
                for (Index j = 0; j < 2; ++j) {
                    double along = 0, square = 0;
                    for (Index i = 0; i < d; ++i) along += V(i, j) * x(i), square += V(i, j) * V(i, j);
                    for (Index i = 0; i < d; ++i) x(i) -= 2 * along / square * V(i, j);
                }
            }
            y(k) = 1e-4 * seed.bell();
            for (Index i = 0; i < d; ++i) y(k) += X(i, k) = float(x(i));
            y(k) = float(y(k));
        }
    }
};
Problem<double> problem_of(Trial const& t) {
    return {.size = Index(t.number("d")),
            .forgetting = t.number("lambda"),
            .prior = Prior<double>{.variance = t.number("c2")}};
}

double norm_of(Matrix<Pair> const& A) {
    Pair sum = 0;
    for (Index i = 0; i < A.size(); ++i) sum += A.data()[i] * A.data()[i];
    return static_cast<double>(sqrt(sum));
}
/// P in pairs of doubles; empty where it, or the X = P^-1 that is stored, is not definite.
template <class T>
Matrix<Pair> covariance_in_pairs(Stored<T> const& stored) {
    Matrix<Pair> const F = multiplied_out(stored.template mapped<Pair>([](T const& x) { return Pair(x); }));
    Matrix<Pair> const X = (F + F.transpose()) / Pair(2);
    bool const is_P = stored.quantity == Stored<T>::Quantity::covariance;  // one row tells whether it is definite
    Matrix<Pair> const over_X = divided<Pair>(Matrix<Pair>::Identity(is_P ? 1 : X.rows(), X.rows()), X);
    if (!std::isfinite(norm_of(over_X) + norm_of(X))) return {};
    return is_P ? X : over_X;
}
/// |A - B| / |B|, infinite where A is empty or not finite.
template <class T>
double apart(Matrix<T> const& A, Matrix<Pair> const& B) {
    if (A.size() == 0) return INFINITY;
    double const out = norm_of(A.unaryExpr([](T const& x) { return Pair(x); }) - B) / norm_of(B);
    return std::isfinite(out) ? out : INFINITY;
}
/// theta and P of the rows by normal equations in pairs of doubles. Their relative errors are d N 2^-104 times the
/// condition of P^-1, or less: below 1e-19 here.
struct Answer {
    Matrix<Pair> theta, P;
    Answer(Problem<double> const& p, Data const& data) {
        Information<Pair> f(problem_as<Pair>(p));
        for (Index k = 0; k < data.y.size(); ++k)
            f.accumulate(Vector<Pair>(data.X.col(k).unaryExpr([](double x) { return Pair(x); })), Pair(data.y(k)));
        theta = f.theta();
        P = covariance_in_pairs(f.stored());
    }
};

struct Full {
    void operator()(auto&&) const {}
};
/// K in bfloat16 or tf32.
template <class Short>
struct Shortened {
    Index d, k;
    void operator()(auto&& K) const {
        for (Index j = 0; j < k; ++j)
            for (Index i = 0; i < d; ++i) K(i, j) = float(static_cast<double>(Short(double(K(i, j)))));
    }
};

template <class T, class Perturb = Full>
void run_in(Trial const& trial, Data const& data, Answer const& truth, std::string const& word, TrialOutput& out,
            Perturb perturb = {}) {
    constexpr bool whole = std::same_as<Perturb, Full>;
    Problem<T> const p = problem_as<T>(problem_of(trial));
    auto const k = Index(trial.number("k")), count = data.y.size();
    Matrix<T> const X = data.X.cast<T>(), y = data.y.cast<T>();
    double const u = std::numeric_limits<T>::epsilon() / 2,
                 scale = u * trial.number("c2") * std::sqrt(double(p.size)) / norm_of(truth.P);
    auto const blocks = [&](auto take) {
        bool sound = true;
        for (Index at = 0; at < count; at += k)
            sound = take(Matrix<T>(X.middleCols(at, k)), Matrix<T>(y.middleRows(at, k))) && sound;
        return sound;
    };
    auto const row = [&](std::string const& form, Matrix<T> const& theta, Stored<T> const& stored, bool taken) {
        Matrix<Pair> const P = taken ? covariance_in_pairs(stored) : Matrix<Pair>{};
        out({form, word, 0.0, taken ? apart(theta, truth.theta) : INFINITY, apart(P, truth.P),
             P.size() > 0 ? "yes" : "no", scale});
    };
    for (bool const inverse : {true, false}) {
        if (inverse && !whole) continue;
        Published<T> f(p, inverse);
        bool const taken = blocks([&](auto const& X_, auto const& y_) {
            f.update_block(X_, y_, perturb);
            return true;
        });
        row(inverse ? "inverse" : "cholesky", f.theta, {Stored<T>::Quantity::covariance, Stored<T>::Form::plain, f.P},
            taken);
    }
    {
        JosephRankTwo<T> f(p);
        BlockGain<T> block;
        bool const taken = blocks([&](auto const& X_, auto const& y_) {
            return f.update_block(X_, y_.col(0), block, perturb) != Health::nonfinite;
        });
        row("joseph", f.theta(), f.stored(), taken);
    }
    if constexpr (whole) {
        QrBlock<T> f(p);
        bool const taken =
            blocks([&](auto const& X_, auto const& y_) { return f.update_block(X_, y_.col(0)) != Health::nonfinite; });
        row("qr_block", f.theta(), f.stored(), taken);
        Information<T> g(p);
        for (Index i = 0; i < count; ++i) g.accumulate(X.col(i), y(i));
        row("gram", g.theta(), g.stored(), true);
    }
}

/// Four blocks in double, then one whose K is wrong by the share epsilon: what that changes in P.
void one_wrong_gain(Trial const& trial, TrialOutput& out) {
    Problem<double> const p = problem_of(trial);
    auto const k = Index(trial.number("k"));
    Data const data(trial, 5 * k);
    Seed seed = trial.seed({"replicate"});
    Matrix<double> wrong(p.size, k);
    for (Index i = 0; i < wrong.size(); ++i) wrong.data()[i] = seed.bell();
    for (int power = -20; power <= -4; power += 2) {
        double const epsilon = std::ldexp(1.0, power);
        auto const spoil = [&](auto&& K) {
            for (Index j = 0; j < k; ++j)
                for (Index i = 0; i < p.size; ++i) K(i, j) += epsilon * wrong(i, j) * K(i, j);
        };
        Published<double> f(p, false), g = f;
        JosephRankTwo<double> a(p), b = a;
        BlockGain<double> block;
        for (Index at = 0; at < 5 * k; at += k) {
            Matrix<double> const X = data.X.middleCols(at, k), y = data.y.middleRows(at, k);
            bool const last = at == 4 * k;
            auto const maybe = [&](auto&& K) {
                if (last) spoil(K);
            };
            f.update_block(X, y, Full{}), g.update_block(X, y, maybe);
            a.update_block(X, y.col(0), block), b.update_block(X, y.col(0), block, maybe);
        }
        auto const pairs = [](auto const& P) { return Matrix<Pair>(P.unaryExpr([](double x) { return Pair(x); })); };
        out({"cholesky", "double", epsilon, 0.0, apart(g.P, pairs(f.P)), "yes", 0.0});
        out({"joseph", "double", epsilon, 0.0, apart(Matrix<double>(b.covariance()), pairs(a.covariance())), "yes",
             0.0});
    }
}

void measure(Trial const& trial, TrialOutput& out) {
    auto const d = Index(trial.number("d")), k = Index(trial.number("k"));
    std::string const& part = trial.text("part");
    if (part == "gain") return one_wrong_gain(trial, out);
    Data const data(trial, part == "memory" ? 2560 : 4 * d);
    Answer const truth(problem_of(trial), data);
    if (part == "reference") {
        Records const records{.psi = data.X, .y = data.y.col(0), .names = {}};
        CertifiedSolution const exact = certified(problem_of(trial), records, {records.rows()}).front();
        Vector<Reference> const theta = truth.theta.col(0).unaryExpr(
            [](Pair const& x) { return Reference(Reference(x.high()) + Reference(x.low())); });
        return out({"pairs", "pair", 0.0, error_of(exact.theta_digits(theta)), 0.0, "yes", 0.0});
    }
    run_in<float>(trial, data, truth, "float", out);
    run_in<double>(trial, data, truth, "double", out);
    run_in<float>(trial, data, truth, "K bfloat16", out, Shortened<BFloat16>{d, k});
    run_in<float>(trial, data, truth, "K tf32", out, Shortened<Tf32>{d, k});
}

// --- claims ----------------------------------------------------------------------------------------------------------

Selection of(char const* part, char const* form, char const* word) {
    return where("part", part).where("form", form).where("word", word);
}
/// Of the runs on rotated rows of kappa = 10.
Selection ten(char const* form, char const* word) {
    return of("run", form, word).where("rows", "rotated").where("kappa", 10.0);
}
/// Of rows with a c^2 in [from, to], of kappa = 10.
Selection priors(char const* rows, double from, double to) {
    return where("part", "run").where("rows", rows).where("kappa", 10.0).where("c2", between(from, to));
}
Selection in_float(char const* rows, double from, double to) { return priors(rows, from, to).where("word", "float"); }
/// `of` the rows with the one value of `column` over that of the other, on the same data, in each setting.
Judge over(Selection const& rows, std::string column, std::string one, std::string other, std::string of, double from,
           double to) {
    Statistic const x = number(of);
    return within(rows, {"d", "k", "c2"}, x.on(where(column, one)) / x.on(where(column, other)), from, to);
}
Basis const set_before = own_result("set before any run, after runs of numpy and of a GPU on other rows");
Basis const narrowed = own_result("set before any run; d = 256, which has one c^2, was taken out after the first");
std::vector<std::string> const setting{"d", "k"};
Selection sloped(char const* form, char const* word) { return ten(form, word).where("d", below(256)); }

}  // namespace

extern Study const blocks{
    .name = "blocks",
    .question = "Which update by blocks of rows can be trusted in float, and with a gain in tf32 or bfloat16?",
    .source = "derived (docs/theory.md 132 to 134)",
    .formula = R"tex(\begin{aligned} P - KG' &: \quad \delta P = -\delta K\,G' / \lambda^k \\
P - KF' - FK',\ F = G - \tfrac12 KS &: \quad \delta P = \delta K\,S\,\delta K' / \lambda^k \end{aligned})tex",
    .interpretation =
        "qr_block keeps theta and P in float whatever c^2 is. The published code loses theta first: it computes "
        "theta += P X e with the new P; by theta += K e it stays right far longer. P - K G' with one product for "
        "both sides is lost with forgetting, in double too. Joseph's form errs 2.5 times less in P (median of "
        "runs), and is not definite by itself: G and S err in first order. With K alone in bfloat16 or tf32 it "
        "stays definite up to c^2 = 1024, where P - K G' is lost in every run. Against what was expected, longer "
        "blocks cost accuracy where P is stored, most near k = d. The explicit inverse costs up to 4e6 times "
        "Cholesky's error, not 10^4, and in double theta errs by up to 7e-4, not 1e-8. P - K G' errs by 1.8 to 47 "
        "times u c^2 sqrt(d) / |P|, not at most once. theta's errors are those of small residuals.",
    .data =
        "geometric deviations 1 to 1/kappa in rotated columns, and 16 inputs through random features; 4 d rows; "
        "memory: lambda = 63/64, 40 memories",
    .factors = {{"part", {"reference", "gain", "run", "memory"}},
                {"rows", {"rotated", "features"}},
                {"d", {16.0, 32.0, 64.0, 128.0, 256.0}, {16.0, 32.0}},
                {"k", {8.0, 32.0, 128.0}, {8.0, 32.0}},
                {"lambda", {1.0, 0.984375}},
                {"kappa", {10.0, 100.0, 1000.0}},
                {"c2", {16.0, 1024.0, 65536.0}},
                {"replicate", counted(20), counted(11)}},
    .admits =
        [](Trial const& t) {
            double const d = t.number("d"), k = t.number("k"), kappa = t.number("kappa"), c2 = t.number("c2");
            bool const forgets = t.number("lambda") < 1, rotated = t.text("rows") == "rotated", plain = kappa == 10;
            std::string const& part = t.text("part");
            if (part == "gain") return rotated && d == 32 && k == 8 && plain && c2 == 1024;
            if (part == "memory") return rotated && forgets && d == 16 && k == 32 && plain && c2 == 1024;
            if (part == "reference") return rotated && !forgets && d == 32 && k == 8 && kappa == 1000 && c2 == 65536;
            if (forgets || d == 16 || k > d || (d == 256 && (k < 128 || !plain || c2 != 1024))) return false;
            return rotated || (plain && k >= 32);
        },
    .measures = {"form", "word", "epsilon", "theta", "P", "definite", "scale"},
    .measure = measure,
    .plots = {},
    // The last number of each: the probability that was given to "holds" before any run.
    .claims = {
        {"the reference in pairs of doubles lies within 1e-20 of the certified theta",
         within(where("part", "reference"), {}, greatest("theta"), 0, 1e-20),
         verification("d N 2^-104 times the condition of P^-1"), 0.95},
        {"P - K G': an error of K enters P with slope 1.00 +- 0.02",
         within(of("gain", "cholesky", "double"), {"lambda"}, slope("epsilon", "P"), 0.98, 1.02),
         verification("docs/theory.md 132"), 0.97},
        {"P - K F' - F K': with slope 2.00 +- 0.02",
         within(of("gain", "joseph", "double"), {"lambda"}, slope("epsilon", "P"), 1.98, 2.02),
         verification("docs/theory.md 132"), 0.9},
        {"float, kappa = 10: qr_block's error of P does not depend on c^2: slope 0 +- 0.1",
         within(sloped("qr_block", "float"), setting, slope("c2", "P"), -0.1, 0.1), narrowed, 0.75},
        {"double, kappa = 10: that of P - K G' by Cholesky and of joseph grows in proportion to c^2: "
         "slope 1 +- 0.2",
         within(sloped("cholesky", "double"), setting, slope("c2", "P"), 0.8, 1.2) &&
             within(sloped("joseph", "double"), setting, slope("c2", "P"), 0.8, 1.2),
         narrowed, 0.5},
        {"float, kappa = 10, c^2 up to 1024: joseph's error of P is 1.5 to 30 times below that of P - K G' by "
         "Cholesky",
         over(in_float("rotated", 16, 1024), "form", "cholesky", "joseph", "P", 1.5, 30), set_before, 0.55},
        {"random features, likewise", over(in_float("features", 16, 1024), "form", "cholesky", "joseph", "P", 1.5, 30),
         set_before, 0.5},
        {"float, kappa = 10, c^2 = 1024: the explicit inverse's error of theta is 2 to 10^4 times that of "
         "Cholesky's",
         over(in_float("rotated", 1024, 1024), "form", "inverse", "cholesky", "theta", 2, 1e4), set_before, 0.55},
        {"float, kappa = 10: qr_block's median error of theta is at most 1e-5",
         within(ten("qr_block", "float"), {"d", "k", "c2"}, median("theta"), 0, 1e-5), set_before, 0.85},
        {"float, kappa = 10, c^2 = 1024 and 65536: joseph's error of P is at least three times qr_block's",
         over(in_float("rotated", 1024, 65536), "form", "joseph", "qr_block", "P", 3, INFINITY), set_before, 0.6},
        {"K in bfloat16, kappa = 10, c^2 = 1024 and 65536: P - K G' ends indefinite, for most seeds",
         everywhere(ten("cholesky", "K bfloat16").where("c2", at_least(1024)), "definite", "no"), set_before, 0.8},
        {"joseph, likewise, ends definite, for most seeds",
         everywhere(ten("joseph", "K bfloat16").where("c2", at_least(1024)), "definite", "yes"), set_before, 0.65},
        {"joseph, kappa = 10, c^2 up to 1024: K in bfloat16 costs a factor of 8 to 100 of P",
         over(priors("rotated", 16, 1024).where("form", "joseph"), "word", "K bfloat16", "float", "P", 8, 100),
         set_before, 0.45},
        {"float, kappa = 10, c^2 = 1024: joseph's error of P falls with the rows of a block: slope -0.5 +- 0.3",
         within(sloped("joseph", "float").where("c2", 1024.0), {"d"}, slope("k", "P"), -0.8, -0.2), set_before, 0.4},
        {"float, kappa = 10: P - K G' by Cholesky errs by 0.01 to 1 times u c^2 sqrt(d) / |P|",
         within(ten("cholesky", "float").where("c2", at_most(1024)), {"d", "k", "c2"}, number("P") / number("scale"),
                0.01, 1),
         set_before, 0.4},
        {"float, 40 memories of lambda = 63/64: P - K G' with one product for both sides ends indefinite, for most "
         "seeds",
         everywhere(of("memory", "cholesky", "float"), "definite", "no"), set_before, 0.8},
        {"there the update with X'P of its own, joseph and qr_block err by at most 1e-4 in P",
         within(where("part", "memory").where("word", "float").where("form", {"inverse", "joseph", "qr_block"}),
                {"form"}, median("P"), 0, 1e-4),
         set_before, 0.65},
        {"float, c^2 = 65536: in kappa theta's error by normal equations has slope 2 +- 0.4, qr_block's 1 +- 0.4",
         within(of("run", "gram", "float").where("rows", "rotated").where("c2", 65536.0), setting,
                slope("kappa", "theta"), 1.6, 2.4) &&
             within(of("run", "qr_block", "float").where("rows", "rotated").where("c2", 65536.0), setting,
                    slope("kappa", "theta"), 0.6, 1.4),
         set_before, 0.45},
        {"double, kappa up to 100: each form's median error of theta is at most 1e-8",
         within(where("part", "run").where("word", "double").where("rows", "rotated").where("kappa", at_most(100)),
                {"form", "d", "k", "kappa", "c2"}, median("theta"), 0, 1e-8),
         set_before, 0.8}}};

}  // namespace rlslab::studies
