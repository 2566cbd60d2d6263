// The pages that are recorded.
#include "src/lab/export/export.hpp"
#include "src/lab/export/recording.hpp"

#include <rlslab/state/state.hpp>
#include <rlslab/variants/carlson.hpp>
#include <rlslab/variants/conventional.hpp>
#include <rlslab/variants/gentleman.hpp>
#include <rlslab/variants/joseph_rank_two.hpp>
#include <rlslab/variants/symmetric.hpp>
#include <rlslab/variants/ud.hpp>
#include <rlslab/variants/ud_delta.hpp>

#include <algorithm>
#include <new>

namespace rlslab::exporting {
namespace {

/// Where each member of the state lies.
struct Members : detail::Silent {
    std::vector<Member> found;
    std::vector<Place> places;  // of the first number of each
    void token(char kind, std::uint64_t) {
        if (kind == 'n') found.push_back({});
    }
    void length(char, Index, std::size_t) {
        found.push_back({});
        found.back().listed = true;
    }
    template <Kind kind>
    void number(Cell<kind> const& x) {
        Place const place = Tape::now->place_of(&x);
        Member& member = found.back();
        if (member.length++ > 0) return;
        member.kind = kind;
        member.array = place.array;
        places.push_back(place);
    }
    template <class X>
    void irregular(X const&) {
        throw std::logic_error("a state of irregular members");
    }
};

/// An object, as an array of what it is made of.
template <class X>
class Room {
    alignas(X) std::byte bytes_[sizeof(X)];
    X* object_ = nullptr;

public:
    int const array;
    Room() : array(Tape::now->array(bytes_, sizeof(X) / sizeof(int), sizeof(int))) {}
    Room(Room const&) = delete;
    Room& operator=(Room const&) = delete;
    template <class... With>
    X& make(With const&... with) {
        return *(object_ = new (bytes_) X(with...));
    }
    ~Room() {
        if (object_) object_->~X();
        Tape::now->forget(bytes_);
    }
};

/// Each number of `array` becomes an array of its own: the numbers of an object are no row.
std::vector<int> split(Recording& r, int array, int first, int last) {
    std::vector<int> own(std::size_t(r.tape.lengths[std::size_t(array)]), -1);
    for (int i = first; i < last; ++i) {
        Place& place = r.tape.entries[std::size_t(i)].place;
        if (place.array != array) continue;
        int& to = own[std::size_t(place.index)];
        if (to < 0) {
            to = int(r.tape.lengths.size());
            r.tape.lengths.push_back(1);
        }
        place = {to, 0};
    }
    return own;
}

template <class F>
Recording record(int size, std::initializer_list<char const*> names) {
    using T = typename F::scalar;
    static_assert(sizeof(T) == sizeof(int) && sizeof(RecordedTruth) == sizeof(int));
    Recording r;
    Tape* const outer = std::exchange(Tape::now, &r.tape);
    struct Back {
        Tape* to;
        ~Back() { Tape::now = to; }
    } const back{outer};
    {
        Room<T> lambda, variance, y, innovation, residual, gamma;
        Room<RecordedHealth> health;
        Room<RecordedTruth> valid;
        Room<F> room;
        std::vector<T, Registering<T>> psi(std::size_t(size), T(0));
        r.forgetting = lambda.array, r.variance = variance.array, r.y = y.array;
        r.psi = r.tape.place_of(psi.data()).array;
        r.innovation = innovation.array, r.residual = residual.array, r.gamma = gamma.array, r.health = health.array;
        T const &forgetting = lambda.make(0), &c2 = variance.make(0), &output = y.make(0);

        r.begun = int(r.tape.entries.size());
        Problem<T> problem{.size = size, .forgetting = forgetting, .prior = Prior<T>{.variance = c2}};
        F& filter = room.make(problem);
        int taken = r.tape.assumed.front();
        for (std::size_t i = 1; i < r.tape.assumed.size(); ++i)
            taken = (RecordedTruth::of(taken) && RecordedTruth::of(r.tape.assumed[i])).read();
        valid.make(RecordedTruth::of(taken));
        r.valid = valid.array;
        r.made = int(r.tape.entries.size());

        r.tape.assumes = false;
        Step<T> const step = filter.update({psi.data(), size}, output);
        innovation.make(step.innovation);
        residual.make(step.residual);
        gamma.make(step.gamma);
        health.make(step.health);
        r.updated = int(r.tape.entries.size());
        if constexpr (requires(StateVector<T, Dynamic>& out) { filter.theta(out); }) {
            StateVector<T, Dynamic> theta(size);
            r.theta = r.tape.place_of(theta.data()).array;
            filter.theta(theta);
        }
        r.solved = int(r.tape.entries.size());

        Members members;
        detail::walk(members, filter);
        std::vector<int> const own = split(r, room.array, r.begun, r.solved);
        auto name = names.begin();
        for (std::size_t i = 0; i < members.found.size(); ++i) {
            Member member = members.found[i];
            if (members.places[i].array == room.array) member.array = own[std::size_t(members.places[i].index)];
            if (name == names.end() || member.array < 0) throw std::logic_error("a state of other members");
            member.name = *name++;
            r.state.push_back(member);
        }
        std::size_t const entries = detail::entry_bytes<F>;
        auto const bytes = state_of(filter);
        r.head.assign(bytes.begin(), bytes.begin() + std::ptrdiff_t(StateHeader::size + entries));
    }
    r.tape.entries.resize(std::size_t(r.solved));
    for (Entry const& e : r.tape.entries)
        if (e.op == Op::load && e.place.array < 0) throw std::logic_error("a load from nowhere");
    return r;
}

template <class T>
Recording recorded_in(std::string_view variant, int size) {
    using R = Recorded<T>;
    auto const plain = {"lambda", "correction", "theta", "K", "P"};
    auto const ud = {"lambda", "correction", "theta", "D", "K", "U"};
    if (variant == "ud") return record<Ud<R>>(size, ud);
    if (variant == "ud_delta") return record<UdDelta<R>>(size, ud);
    if (variant == "carlson") return record<Carlson<R>>(size, {"lambda", "correction", "theta", "K", "S"});
    if (variant == "gentleman")
        return record<Gentleman<R>>(size, {"lambda", "D", "z", "psi", "L", "squares", "right", "unknown"});
    if (variant == "symmetric") return record<Symmetric<R>>(size, plain);
    if (variant == "joseph_rank_two") return record<JosephRankTwo<R>>(size, plain);
    if (variant == "conventional") return record<Conventional<R>>(size, plain);
    throw std::logic_error("no such page");
}

}  // namespace

std::vector<std::string_view> const& exported_variants() {
    static std::vector<std::string_view> const names{"ud",        "ud_delta",        "carlson",     "gentleman",
                                                     "symmetric", "joseph_rank_two", "conventional"};
    return names;
}

bool is_exported(std::string_view variant, bool in_double) {
    auto const& names = exported_variants();
    return std::find(names.begin(), names.end(), variant) != names.end() && (variant != "gentleman" || in_double);
}

Recording recorded(std::string_view variant, int size, bool in_double) {
    return in_double ? recorded_in<double>(variant, size) : recorded_in<float>(variant, size);
}

}  // namespace rlslab::exporting
