// Triangles of the rows so far in double; each row that is kept is carried to each checkpoint.
#include "src/lab/compare/prior_law.hpp"

#include <rlslab/linalg/dot.hpp>
#include <rlslab/linalg/product.hpp>
#include <rlslab/variants/potter.hpp>
#include <rlslab/variants/qr.hpp>

#include <algorithm>
#include <cmath>

namespace rlslab::compare {
using detail::product;
namespace {

using Square = Matrix<double>;
using Column = Vector<double>;

/// What the law needs of row j. A root of P_(j-1), and P_(j-1), are those that a form rounds.
struct Row {
    Square R, F, S, S_before, before;  // R'R = M_j, F = R^-1, S of Potter's
    Column psi;
};

/// Row j and the rows that it stands for.
struct Share {
    Index row;
    double rows;
};
/// All of the first 4 d and the `bright`, in ascending order, then fewer the longer ago they are.
std::vector<Share> rows_before(Index k, Index d, std::vector<Index> const& bright) {
    std::vector<Share> out;
    Index const dense = std::min(k, 4 * d);
    constexpr int of_a_length = 6;
    for (Index j = k, n = 0, length = 1; j > dense;) {
        Index const taken = std::min(length, j - dense);
        auto const first = std::ranges::upper_bound(bright, j - taken), last = std::ranges::upper_bound(bright, j);
        for (auto one = first; one != last; ++one) out.push_back({*one, 1});
        Index row = j - taken / 2;
        for (auto one = last; one != first && row > j - taken;) row -= *--one == row;
        if (Index const others = taken - (last - first); others > 0 && row > j - taken)
            out.push_back({row, double(others)});
        j -= taken;
        if (++n % of_a_length == 0) length *= 2;
    }
    for (Index j = dense; j > 0; --j) out.push_back({j, 1});
    return out;
}

std::vector<Index> looked_at(Index rows, Index d) {
    std::vector<Index> const all = checkpoints_of(rows);
    std::vector<Index> out;
    for (size_t i = all.size(); i > 0; i -= std::min<size_t>(i, 4))
        if (all[i - 1] >= counted_from(rows, d)) out.push_back(all[i - 1]);
    return out;
}

constexpr double least = 0x1p-1000;
/// Rows behind the first 4 d whose gamma is below a quarter of the median, 2 d at most, the smallest: they change P
/// more than rows around them, which stand for one another.
std::vector<Index> bright_rows(Potter<double> root, Matrix<double> const& psi, double unit, Index rows) {
    Index const d = psi.rows();
    std::vector<std::pair<double, Index>> gammas;
    for (Index k = 1; k <= rows; ++k) {
        double const gamma = root.update(Column(unit * psi.col(k - 1)), 0).gamma;
        if (k > 4 * d) gammas.emplace_back(gamma, k);
    }
    std::ranges::sort(gammas);
    std::vector<Index> out;
    for (auto const& [gamma, k] : gammas)
        if (Index(out.size()) < 2 * d && gamma < gammas[gammas.size() / 2].first / 4) out.push_back(k);
    std::ranges::sort(out);
    return out;
}
/// Of an upper triangle.
Square inverse_of(Square const& R) {
    Square out = Square::Identity(R.rows(), R.cols());
    for (Index j = 0; j < R.cols(); ++j)
        for (Index l = j; l >= 0; --l) {
            out(l, j) /= R(l, l);
            out.col(j).head(l) -= R.col(l).head(l) * out(l, j);
        }
    return out;
}
/// The rows that the checkpoints need, by number, and which are bright.
struct Rows {
    std::map<Index, Row> at;
    std::vector<Index> bright;
};
Rows rows_of(RoundedProblem const& rounded, std::vector<Index> const& checkpoints) {
    Index const d = rounded.problem.size;
    Rows rows;
    auto& out = rows.at;
    Prior<double> const& prior = *rounded.problem.prior;
    // Digits have no unit; in one where the largest number is near 1 squares are in range.
    double const unit = std::ldexp(1.0, -std::ilogb(std::max(least, rounded.records.psi.cwiseAbs().maxCoeff())));
    Column const P0 =
        (prior.covariance ? Column(prior.covariance->diagonal()) : Column::Constant(d, prior.variance)) / unit / unit;
    double const lambda = rounded.problem.forgetting;
    Problem<double> const in_unit{
        .size = d, .forgetting = lambda, .prior = Prior<double>{.covariance = P0.asDiagonal()}};
    Potter<double> of_P(in_unit);
    Qr<double> of_M(in_unit);
    rows.bright = bright_rows(of_P, rounded.records.psi, unit, checkpoints.front());
    for (Index const k : checkpoints) {
        out[k];
        for (Share const& one : rows_before(k, d, rows.bright)) out[one.row];
    }
    for (Index k = 1; k <= checkpoints.front(); ++k) {
        Column const psi = unit * rounded.records.psi.col(k - 1);
        auto const kept = out.find(k);
        Square const before = kept == out.end() ? Square() : Square(of_P.stored().F);
        of_P.update(psi, 0), of_M.update(psi, 0);
        if (kept == out.end()) continue;
        Square const R = of_M.stored().F.transpose().triangularView<Eigen::Upper>();
        kept->second = {.R = R,
                        .F = inverse_of(R),
                        .S = of_P.stored().F,
                        .S_before = before,
                        .before = product(before, Square(before.transpose())) / lambda,
                        .psi = psi};
    }
    return rows;
}

/// The squared lengths of the columns.
Column lengths(Square const& X) {
    Column out(X.cols());
    for (Index j = 0; j < X.cols(); ++j) out[j] = dot(X.col(j).data(), X.col(j).data(), X.rows());
    return out;
}
double norm(Square const& X) { return std::sqrt(dot(X.data(), X.data(), X.size())); }
/// sum_il x_i E_il^2 y_l.
double weighed(Column const& x, Square const& E, Column const& y) {
    Column by(E.rows());
    double sum = 0;
    for (Index l = 0; l < E.cols(); ++l) {
        by = E.col(l).cwiseAbs2();
        sum += dot(x.data(), by.data(), x.size()) * y[l];
    }
    return sum;
}

PowerLaw::Sizes sizes_at(Rows const& rows, Index k, double lambda) {
    Square const &F_k = rows.at.at(k).F, P = product(F_k, Square(F_k.transpose()));
    PowerLaw::Sizes out{};
    Square bias = Square::Zero(P.rows(), P.cols());
    for (auto const [j, count] : rows_before(k, P.rows(), rows.bright)) {
        Row const& row = rows.at.at(j);
        double const left = correctly::pow(lambda, double(k - j)), share = count * left * left;
        Square const carried = product(P, Square(row.R.transpose())), T = product(carried, row.R);
        Column const of_entry = lengths(T);
        out.triangle += share * weighed(of_entry, row.F, lengths(carried));
        out.information += share * weighed(lengths(carried), row.R, lengths(P));
        out.root += share * weighed(of_entry, row.S_before, lengths(product(T, row.S)));
        out.difference += share * weighed(of_entry, row.before, of_entry);
        Square const psi = row.psi, K = product(row.F, product(Square(row.F.transpose()), psi)),
                     H = (Square::Identity(P.rows(), P.cols()) - product(K, Square(psi.transpose()))).cwiseAbs(),
                     spread = product(product(H, Square(row.before.cwiseAbs())), Square(H.transpose()));
        out.joseph += share * weighed(of_entry, spread, of_entry);
        if (lambda < 1) bias += count * left * product(carried, Square(carried.transpose()));
    }
    double const size = norm(P);
    auto const relative = [&](double squares) { return std::sqrt(squares) / size; };
    return {relative(out.triangle),   relative(out.information), relative(out.root),
            relative(out.difference), relative(out.joseph),      norm(bias) / size};
}

/// eps of (2).
double bias_of(Arithmetic const& arithmetic, double lambda) {
    if (lambda == 1) return 0;
    double const rho = arithmetic.round(std::sqrt(lambda)), c = arithmetic.round((1 - rho) / rho);
    Reference const factor = Reference(1) + c;
    return static_cast<double>(Reference(Reference(1) / (factor * factor * Reference(lambda)) - Reference(1)));
}

struct Form {
    std::string_view name;
    double PowerLaw::Sizes::*size;
    double c;
    bool rounds_root = false;
    bool at_least = false;
};
constexpr double once = 0.5, twice = 0.8, rotated = 1.5, at_most = 5;
constexpr auto triangle = &PowerLaw::Sizes::triangle, information = &PowerLaw::Sizes::information,
               difference = &PowerLaw::Sizes::difference;
constexpr Form forms[] = {{"ud", triangle, twice},
                          {"ud_delta", triangle, once},
                          {"carlson_delta", triangle, twice},
                          {"inverse_qr_delta", triangle, twice},
                          {"gentleman", information, once},
                          {"carlson", triangle, rotated, true},
                          {"inverse_qr", triangle, rotated, true},
                          {"qr", information, rotated, true},
                          {"extended_qr", triangle, rotated, true},
                          {"potter", &PowerLaw::Sizes::root, twice, true},
                          {"symmetric", difference, at_most, false, true},
                          {"joseph_rank_two", difference, at_most, false, true},
                          {"conventional_two_sided", difference, at_most, false, true},
                          {"joseph", &PowerLaw::Sizes::joseph, at_most, false, true}};

}  // namespace

PowerLaw power_law(RoundedProblem const& rounded) {
    std::vector<Index> const checkpoints = looked_at(rounded.records.rows(), rounded.problem.size);
    Rows const rows = rows_of(rounded, checkpoints);
    PowerLaw out;
    for (Index const k : checkpoints) out.at.push_back(sizes_at(rows, k, rounded.problem.forgetting));
    return out;
}

std::optional<Predicted> predicted(PowerLaw const& law, CatalogueEntry const& entry, double forgetting) {
    auto const form = std::ranges::find(forms, entry.variant, &Form::name);
    Arithmetic const& arithmetic = *entry.arithmetic;
    constexpr int longest = 53;
    if (form == std::end(forms) || arithmetic.stochastic || arithmetic.digits > longest) return {};
    double const eps = form->rounds_root ? bias_of(arithmetic, forgetting) : 0;
    std::vector<double> digits;
    for (PowerLaw::Sizes const& at : law.at) {
        double const rounding = form->c * arithmetic.unit_roundoff() * at.*form->size, bias = eps * at.bias;
        double const error = std::sqrt(rounding * rounding + bias * bias);
        if (!(std::isfinite(error) && error > 0)) return {};
        digits.push_back(std::min(arithmetic.decimal_digits(), -correctly::log10(error)));
    }
    std::ranges::sort(digits);
    double const median = digits[(digits.size() - 1) / 2];
    return median > 0 ? std::optional(Predicted{median, form->at_least}) : std::nullopt;
}

void predict(std::vector<Result>& results, std::map<std::string_view, RoundedProblem> const& rounded) {
    std::map<std::string_view, PowerLaw> laws;
    for (auto const& [name, problem] : rounded)
        if (problem.in_range && problem.records.psi.allFinite()) laws[name] = power_law(problem);
    for (Result& r : results) {
        std::string_view const name = r.entry->arithmetic->digits >= 53 ? "double" : r.entry->arithmetic->name;
        if (auto const law = laws.find(name); law != laws.end())
            r.predicted = predicted(law->second, *r.entry, rounded.at(name).problem.forgetting);
    }
}

}  // namespace rlslab::compare
