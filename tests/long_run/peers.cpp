// peers_long_run ROWS [SEED]: the rows of long_run through dlib's and liquid's filters. How they end stands in
// docs/long_run.md.
#include "tests/long_run/abuse.hpp"

#include <cstdio>
#include <dlib/svm/rls.h>
#include <liquid/liquid.h>

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // liquid's next version is without it

namespace {

using namespace rlslab;
using long_run::d;

/// With the forgetting applied to C as well: the same recursion as ours, in double. P0 = 100 I.
class Dlib {
    dlib::rls rls_{long_run::lambda, 100, true};
    dlib::matrix<double, 0, 1> psi_ = dlib::matrix<double, 0, 1>(d);  // braces would make one number of it

public:
    static constexpr char name[] = "dlib::rls, double";
    void update(float const (&psi)[d], float y) {
        for (int i = 0; i < d; ++i) psi_(i) = double(psi[i]);
        rls_.train(psi_, double(y));
    }
    double theta(int i) const { return rls_.get_w()(i); }
};

/// Its delay line is filled with the row's five numbers, the first one last. P0 = 10 I is built in.
class Liquid {
    eqrls_rrrf q_;

public:
    static constexpr char name[] = "liquid's eqrls_rrrf, float";
    Liquid() {
        float zero[d] = {};
        q_ = eqrls_rrrf_create(zero, d);
        eqrls_rrrf_set_bw(q_, float(long_run::lambda));
    }
    ~Liquid() { eqrls_rrrf_destroy(q_); }
    void update(float const (&psi)[d], float y) {
        for (int i = d - 1; i >= 0; --i) eqrls_rrrf_push(q_, psi[i]);
        float predicted;
        eqrls_rrrf_execute(q_, &predicted);
        eqrls_rrrf_step(q_, y, predicted);
    }
    double theta(int i) const {
        float weights[d];
        eqrls_rrrf_get_weights(q_, weights);
        return double(weights[i]);
    }
};

/// screened: rows with a number that is not finite, or of a magnitude beyond 1e18, are kept from the filter, as a
/// careful caller would.
template <class Peer>
void run(Index rows, Seed seed, bool screened) {
    Peer peer;
    long_run::Abuse abuse(seed);
    long_run::Beside beside;
    long_run::Survived survived;
    float psi[d];
    Index first = 0;
    char const* during = "";
    for (Index k = 1; k <= rows; ++k) {
        float const y = abuse.next(psi);
        bool fit = std::abs(y) < 1e18f;
        for (float const x : psi) fit = fit && std::abs(x) < 1e18f;
        if (fit || !screened) peer.update(psi, y);
        double sum = 0;
        for (int i = 0; i < d; ++i) sum += 0 * peer.theta(i);
        survived.not_finite += !(sum == 0);
        if (first == 0 && !(sum == 0))
            first = k, during = abuse.is_good() ? "good rows" : long_run::names[size_t(abuse.kind())];
        beside.compare(
            abuse, psi, y, [&peer](int i) { return peer.theta(i); }, survived);
    }
    std::printf("%s%s: ", Peer::name, screened ? ", unusable rows kept from it" : "");
    if (first > 0)
        std::printf("theta not finite from row %lld on (%s), after %lld of %lld rows", (long long)first, during,
                    (long long)survived.not_finite, (long long)rows);
    else std::printf("theta finite after all of %lld rows", (long long)rows);
    std::printf("\n    beyond 2x after %lld of %lld disturbances\n", (long long)survived.all_worse(),
                (long long)survived.all_compared());
    for (size_t i = 0; i < long_run::names.size(); ++i)
        std::printf("  %-16s %10lld %11lld %26.4g\n", long_run::names[i], (long long)survived.compared[i],
                    (long long)survived.worse[i], std::abs(survived.ratio[i]));
}

}  // namespace

int main(int arguments, char** argument) {
    auto const length = long_run::length_of("peers_long_run", arguments, argument);
    if (!length) return 2;
    auto const [rows, seed] = *length;
    for (bool const screened : {false, true}) {
        run<Dlib>(rows, Seed{std::uint64_t(seed)}, screened);
        run<Liquid>(rows, Seed{std::uint64_t(seed)}, screened);
    }
}
