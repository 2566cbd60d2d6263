// An acoustic echo canceller: what the loudspeaker plays comes back into the microphone over 256 taps, and is taken out
// again, also while somebody in the room speaks.
#include <rlslab/adapt/delay_line.hpp>
#include <rlslab/core/random.hpp>
#include <rlslab/variants/ud.hpp>

#include <cmath>
#include <cstdio>

namespace {

constexpr int taps = 256;

/// Takes the echo out of the microphone's signal. Somebody who speaks in the room makes innovations that the echo has
/// no part in, and a filter that learns from them loses the path. So rows whose innovation is beyond 4 standard
/// deviations are left out, and the 800 after them (0.1 s). A path that has changed looks the same at first: the
/// variance grows by 0.1 % a sample meanwhile, until it is let in.
class EchoCanceller {
    rlslab::DelayLine<float> loudspeaker_{taps};
    rlslab::Ud<float> filter_{{.size = taps, .forgetting = 0.9998f, .prior = rlslab::Prior<float>{.variance = 1}}};
    float variance_ = 1, bound_;
    int wait_ = 0;

public:
    explicit EchoCanceller(float bound = 4) : bound_(bound) {}

    /// What is left of the microphone's sample when the echo is taken out.
    float operator()(float played, float heard) {
        auto const psi = loudspeaker_.push(played);
        float const e = heard - rlslab::dot(psi.data(), filter_.theta().data(), taps);
        if (e * e > bound_ * bound_ * variance_) wait_ = 800;
        if (wait_ > 0) {
            --wait_;
            variance_ *= 1.001f;
        } else {
            filter_.update(psi, heard);
            variance_ += 0.002f * (e * e - variance_);
        }
        return e;
    }
};

/// Speech, as far as a filter is concerned: coloured noise, louder and softer.
class Speech {
    rlslab::Seed seed_;
    float y1_ = 0, y2_ = 0;
    int k_ = 0;

public:
    explicit Speech(std::uint64_t seed) : seed_{seed} {}
    float operator()() {
        float const loudness = k_++ / 800 % 4 == 3 ? 0.02f : 0.2f;
        float const y = 1.2f * y1_ - 0.6f * y2_ + loudness * float(seed_.bell());
        y2_ = y1_;
        return y1_ = y;
    }
};

/// The room: direct sound after 20 samples, then reflections that die away.
struct Room {
    float path[taps] = {};
    Room() {
        rlslab::Seed seed{3};
        float strength = 0.4f;
        for (int i = 20; i < taps; ++i, strength *= 0.98f) path[i] = strength * float(seed.bell());
    }
};

double decibels(double ratio) { return 10 * std::log10(ratio); }

}  // namespace

int main() {
    Room const room;
    Speech far(1), near(2);
    rlslab::Seed noise{4};
    rlslab::DelayLine<float> played(taps);
    EchoCanceller guarded, unguarded(1e9f);

    std::printf("echo taken out, dB      guarded  unguarded\n");
    double worst = 1000;
    for (char const* phase : {"learning", "quiet room", "both speak", "after that"}) {
        bool const both = phase[0] == 'b';
        double echo_power = 0, left[2] = {};
        for (int k = 0; k < 3200; ++k) {  // 0.4 s at 8 kHz
            float const x = far(), echo = rlslab::dot(played.push(x).data(), room.path, taps);
            float const other = 1e-3f * float(noise.bell()) + (both ? near() : 0);
            float const e[] = {guarded(x, echo + other) - other, unguarded(x, echo + other) - other};
            echo_power += echo * echo;
            for (int i = 0; i < 2; ++i) left[i] += e[i] * e[i];
        }
        double const kept = decibels(echo_power / left[0]);
        if (phase[0] != 'l') worst = std::min(worst, kept);
        std::printf("  %-20s %8.0f %10.0f\n", phase, kept, decibels(echo_power / left[1]));
    }
    return worst > 30 ? 0 : 1;
}
