// The variant's estimate and its uncertainty; the parameters again where residuals are coloured; and remarks on it all.
#pragma once

#include "src/lab/identify/structure.hpp"

namespace rlslab::identify {

/// Adds a remark: its rank, what to do next, its sentence.
template <class... Values>
void remark(std::vector<Remark>& out, Remark::Rank rank, std::string next, fmt::format_string<Values...> sentence,
            Values&&... values) {
    out.push_back({rank, fmt::format(sentence, std::forward<Values>(values)...), std::move(next)});
}

/// The variant's entry in double. Throws InputError.
CatalogueEntry const& entry_of(std::string const& variant);

/// Statistics of an estimate that the variant does not report.
struct Uncertainty {
    Vector<double> sd;           ///< of the certified minimiser
    Matrix<double> correlation;  ///< of its components
};

struct Estimation {
    Estimate estimate;
    Uncertainty uncertainty;
    std::vector<Remark> remarks;  ///< about dependence, breakdown and rounding
};
/// The variant's estimate from the fitted rows. The standard deviations are those of the certified minimiser
/// (scatter.hpp). resolution (d): the unit to which each regressor's numbers are rounded. Throws InputError for
/// linearly dependent regressors, naming `file` and the structure, and for a lambda that remembers too few rows.
Estimation estimate(std::string const& file, IdentifyOptions const& options, Structure const& structure,
                    Records const& records, Vector<double> const& resolution);

/// The prior of the estimate for its parameters, and `further` for each of `more` that follow.
Prior<double> prior_of(Estimate const& estimate, int more = 0, double further = 0);

/// Throws InputError, which names --noise-model or --instruments, where the equation or its rows do not allow for it.
void expect_cures(IdentifyOptions const& options, Structure const& structure, Record const& record);

/// --noise-model n: A y = B u + c + C e by ExtendedLeastSquares<Ud<double>> over the fitted rows, a row that misses a
/// value is passed by. Prior: that of the model, and P0 = 1 / sigma^2 of each c_i, a standard deviation of 1. Its
/// residuals, sigma^2 and their test are those of the last parameters, e = (A y - B u - c) / C from e = 0 on. sd:
/// those of limit_deviations; NaN where |C(e^iw) - 1| reaches 1, where there may be none.
Cured with_noise_model(IdentifyOptions const& options, Structure const& structure, Record const& record,
                       Estimate const& estimate);

/// --instruments N: InstrumentalVariables<Ud<double>>, likewise, over the rows that have the instruments: the inputs
/// and the constant of the equation, and N further past lags of each input, whose prior is default_prior. sd, with
/// v = y - psi'theta, x_k = P psihat_k and L = sqrt(rows), 200 at most (docs/theory.md 90, by triangular weights):
///   sd_i^2 = sum |tau| <= L of (1 - |tau| / (L + 1)) r_v(tau) sum_k x_ik x_i(k+tau)
Cured with_instruments(IdentifyOptions const& options, Structure const& structure, Record const& record,
                       Estimate const& estimate);

/// The standard deviations of the limit Sigma / N of docs/theory.md 89, from its rows phi (d x N; 0 where one is
/// missing), P and sigma^2: with z = phi / C, A = P sum phi z' and M = A - I/2
///   M X + X M' = sigma^2 P,        sd_i = sqrt(X_ii)
/// by doubling, with F = A^-1 (A - I) and in units of sqrt P_ii:  X = F X F' + A^-1 sigma^2 P A^-T
/// NaN where M has an eigenvalue with a real part of 0 or less: there is no such limit. C must be stable.
Vector<double> limit_deviations(Matrix<double> const& phi, std::vector<double> const& c, Matrix<double> const& P,
                                double sigma2);

/// max |C(e^iw) - 1| over w: exact for n <= 2, else on 64 n frequencies.
double farthest_from_one(std::vector<double> const& c);

/// The options that estimate without bias where the model's residuals are not white, "--noise-model 2 --instruments 3";
/// empty where a higher order does, where they were given, or where the rows do not allow for any.
std::string cure_for(Identified const& model, Record const& record);

/// The number of leading terms of an input whose confidence intervals all contain 0; 0 if those of all its terms do.
int idle_lead(std::vector<Term> const& terms, std::vector<Parameter> const& parameters, int input);

/// Remarks about the structure, the residuals and the held-out part of a model that is otherwise complete.
std::vector<Remark> remarks_on(Identified const& model);

}  // namespace rlslab::identify
