// peer/liquid/float/SIZE: liquid-dsp's eqrls_rrrf, P0 = 10 I and a delay line of its own.
#include "bench/rows.hpp"

#include <liquid/liquid.h>
#include <memory>

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"  // liquid's next version is without it

namespace rlslab::bench {
namespace {

/// Only the newest sample of a regressor is pushed: the rest is in its delay line, which like the scenario's starts
/// with zeros.
class Liquid {
    struct Destroy {
        void operator()(eqrls_rrrf q) const { eqrls_rrrf_destroy(q); }
    };
    std::unique_ptr<std::remove_pointer_t<eqrls_rrrf>, Destroy> q_;
    Index size_;

public:
    using scalar = float;
    static constexpr std::string_view name = "liquid";

    explicit Liquid(Problem<float> const& problem) : size_(problem.size) {
        std::vector<float> zero(size_t(size_), 0.f);  // its own start is theta0 = (1, 0, ..., 0)
        q_.reset(eqrls_rrrf_create(zero.data(), unsigned(size_)));
        eqrls_rrrf_set_bw(q_.get(), problem.forgetting);
    }
    Liquid(Liquid const& other) : q_(eqrls_rrrf_copy(other.q_.get())), size_(other.size_) {}
    Liquid& operator=(Liquid const& other) {
        q_.reset(eqrls_rrrf_copy(other.q_.get()));
        return *this;
    }
    void update(Regressor<float> psi, float y) {
        float predicted;
        eqrls_rrrf_push(q_.get(), psi[0]);
        eqrls_rrrf_execute(q_.get(), &predicted);
        eqrls_rrrf_step(q_.get(), y, predicted);
    }
    Vector<float> theta() const {
        Vector<float> weights(size_);  // of the newest sample first
        eqrls_rrrf_get_weights(q_.get(), weights.data());
        return weights;
    }
};

Rows const added([] {
    for (Index size : choice().sizes) add_filter_row<Liquid>("peer", size);
});

}  // namespace
}  // namespace rlslab::bench
