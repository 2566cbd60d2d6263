// A scalar that records its operations: a variant's page, run once with it, becomes a straight line of operations.
//
// Recorded<T> stands for a T that is not known yet. It behaves as one lane of a Pack: a comparison is a number, too
// (RecordedTruth), and a page goes on with select. Who owns memory tells the tape: what is read from an array, and what
// is stored there, is recorded with its place.
#pragma once

#include <rlslab/arithmetic/storage_traits.hpp>
#include <rlslab/core/encoding.hpp>
#include <rlslab/core/problem.hpp>
#include <rlslab/linalg/storage.hpp>

#include <cstdint>
#include <map>
#include <stdexcept>
#include <vector>

namespace rlslab::exporting {

enum class Kind : char { number, truth, health };
enum class Op : char {
    constant,
    load,
    store,
    add,
    subtract,
    multiply,
    divide,
    negate,
    root,
    less,
    less_equal,
    equal,
    both,
    either,
    opposite,
    choose
};

/// A number of an array.
struct Place {
    int array = -1, index = 0;
    auto operator<=>(Place const&) const = default;
};

/// One operation on earlier entries a, b, c; a load from `place`; or a store of entry a there.
struct Entry {
    Op op;
    Kind kind = Kind::number;
    int a = -1, b = -1, c = -1;
    double constant = 0;
    Place place{};
};

/// What was recorded, in order, and the arrays that it speaks of.
class Tape {
    struct Memory {
        char const* begin;
        std::size_t bytes, of_each;
        int array;
    };
    std::map<char const*, Memory> memory_;

public:
    std::vector<Entry> entries;
    std::vector<int> lengths;  ///< of the arrays
    std::vector<int> assumed;  ///< truths that held, in a recording that assumes what is asked for
    bool assumes = true;       ///< all(truth) is true, and noted; otherwise all(truth) is false and any(truth) true
    static thread_local Tape* now;  ///< that of this thread

    int array(void const* begin, std::size_t count, std::size_t of_each) {
        char const* const at = static_cast<char const*>(begin);
        memory_[at] = {at, count * of_each, of_each, int(lengths.size())};
        lengths.push_back(int(count));
        return int(lengths.size()) - 1;
    }
    void forget(void const* begin) { memory_.erase(static_cast<char const*>(begin)); }
    /// The place of an object; array -1 where it is in no array.
    Place place_of(void const* object) const {
        char const* const at = static_cast<char const*>(object);
        auto next = memory_.upper_bound(at);
        if (next == memory_.begin()) return {};
        Memory const& m = std::prev(next)->second;
        if (at >= m.begin + m.bytes) return {};
        return {m.array, int(std::size_t(at - m.begin) / m.of_each)};
    }
    int add(Entry const& entry) {
        entries.push_back(entry);
        return int(entries.size()) - 1;
    }
    bool is_constant(int i) const { return entries[std::size_t(i)].op == Op::constant; }
    double constant(int i) const { return entries[std::size_t(i)].constant; }
};
inline thread_local Tape* Tape::now = nullptr;

/// A recorded value, wherever it is kept.
template <Kind kind>
class Cell {
    int id_;

protected:
    explicit Cell(int id) : id_(id) { stored(); }

public:
    Cell(Cell const& other) : id_(other.read()) { stored(); }
    Cell& operator=(Cell const& other) {
        id_ = other.read();
        stored();
        return *this;
    }
    /// The entry that holds the value: a load where it is in an array.
    int read() const {
        Place const place = Tape::now->place_of(this);
        if (place.array < 0) return id_;
        return Tape::now->add({.op = Op::load, .kind = kind, .a = id_, .place = place});
    }
    void write(int id) {
        id_ = id;
        stored();
    }

private:
    void stored() const {
        Place const place = Tape::now->place_of(this);
        if (place.array >= 0) Tape::now->add({.op = Op::store, .kind = kind, .a = id_, .place = place});
    }
};

inline int constant(Kind kind, double value) {
    return Tape::now->add({.op = Op::constant, .kind = kind, .constant = value});
}

class RecordedHealth : public Cell<Kind::health> {
    explicit RecordedHealth(int id) : Cell(id) {}

public:
    explicit(false) RecordedHealth(Health health = Health::sound) : Cell(constant(Kind::health, int(health))) {}
    static RecordedHealth of(int id) { return RecordedHealth(id); }
};

class RecordedTruth : public Cell<Kind::truth> {
    explicit RecordedTruth(int id) : Cell(id) {}
    /// The constant, or -1.
    static int known(int id) { return Tape::now->is_constant(id) ? int(Tape::now->constant(id)) : -1; }
    static RecordedTruth joined(Op op, RecordedTruth const& a, RecordedTruth const& b) {
        int const x = a.read(), y = b.read(), decides = op == Op::either;
        if (known(x) == decides || known(y) == decides) return RecordedTruth(decides == 1);
        if (known(x) >= 0 && op == Op::either) return RecordedTruth(y);  // `true && ...` begins a chain
        if (known(y) >= 0) return RecordedTruth(x);
        return RecordedTruth(Tape::now->add({.op = op, .kind = Kind::truth, .a = x, .b = y}));
    }

public:
    explicit(false) RecordedTruth(bool truth) : Cell(constant(Kind::truth, truth)) {}
    static RecordedTruth of(int id) { return RecordedTruth(id); }
    friend RecordedTruth operator&&(RecordedTruth const& a, RecordedTruth const& b) { return joined(Op::both, a, b); }
    friend RecordedTruth operator||(RecordedTruth const& a, RecordedTruth const& b) { return joined(Op::either, a, b); }
    friend RecordedTruth operator!(RecordedTruth const& a) {
        int const x = a.read();
        if (known(x) >= 0) return RecordedTruth(known(x) == 0);
        return RecordedTruth(Tape::now->add({.op = Op::opposite, .kind = Kind::truth, .a = x}));
    }
    friend bool all(RecordedTruth const& a) {
        int const x = a.read();
        if (known(x) >= 0) return known(x) == 1;
        if (Tape::now->assumes) Tape::now->assumed.push_back(x);
        return Tape::now->assumes;
    }
    friend bool any(RecordedTruth const& a) {
        int const x = a.read();
        return known(x) >= 0 ? known(x) == 1 : true;
    }
    friend RecordedHealth select(RecordedTruth const& t, RecordedHealth const& a, RecordedHealth const& b) {
        return RecordedHealth::of(chosen(Kind::health, t, a.read(), b.read()));
    }
    static int chosen(Kind kind, RecordedTruth const& t, int a, int b) {
        int const x = t.read();
        if (known(x) >= 0) return known(x) == 1 ? a : b;
        return Tape::now->add({.op = Op::choose, .kind = kind, .a = x, .b = a, .c = b});
    }
};

/// T: float or double. What constants alone decide is computed at once, in T.
template <std::floating_point T>
class Recorded : public Cell<Kind::number> {
    struct Made {};
    Recorded(Made, int id) : Cell(id) {}
    static Recorded made(Op op, int a, int b = -1) {
        Tape& tape = *Tape::now;
        if (tape.is_constant(a) && (b < 0 || tape.is_constant(b))) {
            T const x = T(tape.constant(a)), y = b < 0 ? T(0) : T(tape.constant(b));
            if (op == Op::add) return Recorded(double(x + y));
            if (op == Op::subtract) return Recorded(double(x - y));
            if (op == Op::multiply) return Recorded(double(x * y));
            if (op == Op::divide) return Recorded(double(x / y));
            if (op == Op::negate) return Recorded(double(-x));
        }
        return Recorded(Made{}, tape.add({.op = op, .a = a, .b = b}));
    }
    static RecordedTruth compared(Op op, Recorded const& a, Recorded const& b) {
        Tape& tape = *Tape::now;
        int const x = a.read(), y = b.read();
        if (tape.is_constant(x) && tape.is_constant(y)) {
            double const p = tape.constant(x), q = tape.constant(y);
            return RecordedTruth(op == Op::less ? p < q : op == Op::equal ? p == q : p <= q);
        }
        return RecordedTruth::of(tape.add({.op = op, .kind = Kind::truth, .a = x, .b = y}));
    }

public:
    Recorded() : Recorded(0.0) {}
    explicit Recorded(double x) : Cell(constant(Kind::number, double(T(x)))) {}
    explicit Recorded(int x) : Recorded(double(x)) {}
    explicit Recorded(float x)
        requires std::same_as<T, float>
        : Recorded(double(x)) {}

    Recorded& operator+=(Recorded const& b) { return *this = *this + b; }
    Recorded& operator-=(Recorded const& b) { return *this = *this - b; }
    Recorded& operator*=(Recorded const& b) { return *this = *this * b; }
    Recorded& operator/=(Recorded const& b) { return *this = *this / b; }
    friend Recorded operator+(Recorded const& a, Recorded const& b) { return of(Op::add, a, b); }
    friend Recorded operator-(Recorded const& a, Recorded const& b) { return of(Op::subtract, a, b); }
    friend Recorded operator*(Recorded const& a, Recorded const& b) { return of(Op::multiply, a, b); }
    friend Recorded operator/(Recorded const& a, Recorded const& b) { return of(Op::divide, a, b); }
    friend Recorded operator-(Recorded const& a) { return made(Op::negate, a.read()); }
    friend Recorded sqrt(Recorded const& a) { return made(Op::root, a.read()); }
    friend RecordedTruth operator<(Recorded const& a, Recorded const& b) { return compared(Op::less, a, b); }
    friend RecordedTruth operator<=(Recorded const& a, Recorded const& b) { return compared(Op::less_equal, a, b); }
    friend RecordedTruth operator==(Recorded const& a, Recorded const& b) { return compared(Op::equal, a, b); }
    friend RecordedTruth operator!=(Recorded const& a, Recorded const& b) { return !(a == b); }
    /// x - x is zero for every number, NaN for infinities and NaN.
    friend RecordedTruth isfinite(Recorded const& a) {
        Recorded const x(a);
        return x - x == Recorded(0.0);
    }
    friend Recorded select(RecordedTruth const& t, Recorded const& a, Recorded const& b) {
        int const x = a.read(), y = b.read();
        return Recorded(Made{}, RecordedTruth::chosen(Kind::number, t, x, y));
    }

private:
    static Recorded of(Op op, Recorded const& a, Recorded const& b) {
        int const x = a.read(), y = b.read();
        return made(op, x, y);
    }
};

/// Arrays that the tape knows.
template <class T>
struct Registering {
    using value_type = T;
    Registering() = default;
    template <class Other>
    explicit(false) Registering(Registering<Other> const&) {}
    T* allocate(std::size_t n) {
        T* const p = static_cast<T*>(::operator new(n * sizeof(T)));
        Tape::now->array(p, n, sizeof(T));
        return p;
    }
    void deallocate(T* p, std::size_t) {
        Tape::now->forget(p);
        ::operator delete(p);
    }
    friend bool operator==(Registering, Registering) { return true; }
};

}  // namespace rlslab::exporting

namespace rlslab {

/// As of T: a state says that it is one in T.
template <class T>
struct ArithmeticTraits<exporting::Recorded<T>> : ArithmeticTraits<T> {};
template <class T, class X>
struct PerLaneOf<exporting::Recorded<T>, X> {
    static_assert(std::same_as<X, Health>);
    using type = exporting::RecordedHealth;
};
template <class T>
struct Encoding<exporting::Recorded<T>> : Encoding<T> {
    static void write(exporting::Recorded<T> const&, std::byte* to) { Encoding<T>::write(T(0), to); }
    static bool read(std::byte const*, exporting::Recorded<T>&) { return false; }
};
template <>
struct Encoding<exporting::RecordedTruth> : Encoding<bool> {
    static void write(exporting::RecordedTruth const&, std::byte* to) { Encoding<bool>::write(false, to); }
    static bool read(std::byte const*, exporting::RecordedTruth&) { return false; }
};
template <class T>
struct detail::Buffer<exporting::Recorded<T>, Dynamic> {
    std::vector<exporting::Recorded<T>, exporting::Registering<exporting::Recorded<T>>> values;
    MovedSize held;
    Buffer(Index numbers, Index size) : values(size_t(numbers), exporting::Recorded<T>(0)), held(size) {}
};

}  // namespace rlslab

template <class T>
struct Eigen::NumTraits<rlslab::exporting::Recorded<T>>
    : rlslab::detail::StorageTraits<rlslab::exporting::Recorded<T>> {
    using Number = rlslab::exporting::Recorded<T>;
    static Number highest() { return Number(NumTraits<T>::highest()); }
    static Number lowest() { return Number(NumTraits<T>::lowest()); }
};
