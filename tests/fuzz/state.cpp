// Any bytes as a state: refused in one printable line, or a filter that goes on; with the checksum made right, too, so
// that what stands behind it is reached.
#include "tests/fuzz/fuzz.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/state_file.hpp>
#include <rlslab/adapt/weighted.hpp>
#include <rlslab/arithmetic/chopped.hpp>
#include <rlslab/arithmetic/quad.hpp>
#include <rlslab/variants/variants.hpp>

namespace rlslab::fuzz {
namespace {

template <class F>
void offer(std::span<std::byte const> bytes) {
    using T = typename F::scalar;
    try {
        F f = loaded<F>(bytes);
        std::vector<std::byte> again(state_size(f));
        save(f, std::span(again));
        expect(std::equal(again.begin(), again.end(), bytes.begin(), bytes.end()),
               "what was loaded to be saved as it was");
        Vector<T> const psi = Vector<T>::Constant(Vector<T>(f.theta()).size(), T(1));
        for (int k = 0; k < 3; ++k) f.update(psi, T(2));
        (void)Vector<T>(f.theta());
        (void)Vector<T>(f.gain());
    } catch (InputError const& error) {
        one_line(error);
    }
    F fixed(Problem<T>{.size = 2});
    auto const before = state_of(fixed);
    if (load(fixed, bytes) != StateFault::none)
        expect(state_of(fixed) == before, "a filter that is as it was where a state is refused");
}
/// Small enough for the longest input.
struct OverThreeRows : Windowed<Ud<float>> {
    explicit OverThreeRows(Problem<float> const& problem) : Windowed(problem, {.rows = 3}) {}
};

template <class... F>
void offer_all(std::span<std::byte const> bytes) {
    (offer<F>(bytes), ...);
}

}  // namespace

void take(std::string_view text) {
    if (text.size() > 4096) return;
    std::vector<std::byte> bytes(text.size());
    std::transform(text.begin(), text.end(), bytes.begin(), [](char c) { return std::byte(c); });
    for (bool const sealed : {false, true}) {
        if (sealed && bytes.size() >= StateHeader::size + StateHeader::checksum) {
            detail::write_low(bytes.size(), 8, bytes.data() + 32);
            Checksum sum;
            sum.add(std::span(bytes).first(bytes.size() - StateHeader::checksum));
            detail::write_low(sum.value(), StateHeader::checksum, bytes.data() + bytes.size() - StateHeader::checksum);
        }
        offer_all<Ud<float>, Information<double>, QrBlock<double>, Kalman<float>, Gentleman<BFloat16>, Carlson<Quad>,
                  Guarded<Ud<float>>, OverThreeRows, Guarded<OverThreeRows>, Forgetting<Ud<double>, Fortescue<double>>,
                  Weighted<Ud<double>>>(bytes);
    }
}

}  // namespace rlslab::fuzz
