// Loops of equal count become one where no statement sees another order of what it depends on; a number that is stored
// for the same pass alone becomes a variable.
#pragma once

#include "src/lab/export/roll.hpp"

#include <set>

namespace rlslab::exporting {
namespace detail {

/// What statements read and write. `own`: variables that each pass sets before it reads them.
struct Touched {
    std::set<std::pair<int, int>> read, written;
    std::set<int> own;

    explicit Touched(Items const& statements) {
        for (Item const& item : expanded(statements)) {
            loads(item.value, [&](Ref const& r) {
                std::pair const place{r.array, r.index.base};
                if (!own.contains(r.array)) read.insert(place);
            });
            std::pair const place{item.target.array, item.target.index.base};
            written.insert(place);
            if (!read.contains(place)) own.insert(place.first);
        }
    }
    /// Whether the two may not change places. `variables`: those from this one on may be each one's own.
    bool disturbs(Touched const& other, int variables) const {
        auto const meet = [&](auto const& a, auto const& b) {
            return std::ranges::any_of(a, [&](auto const& place) {
                bool const apart =
                    place.first >= variables && own.contains(place.first) && other.own.contains(place.first);
                return !apart && b.contains(place);
            });
        };
        return meet(written, other.read) || meet(written, other.written) || meet(read, other.written);
    }
};

inline bool fuse_once(Items& items, int variables) {
    for (std::size_t q = 1; q < items.size(); ++q) {
        if (!items[q].loops) continue;
        constexpr int none = std::numeric_limits<int>::max();
        std::vector<std::size_t> begins;  // constants that the loop begins with: they move with it
        auto const begun = [&] {
            Items out;
            for (std::size_t const b : begins) out.push_back(items[b]);
            return out;
        };
        for (std::size_t p = q; p-- > 0;) {
            if (items[p].loops && items[p].count == items[q].count) {
                int const n = items[q].count.base;
                std::vector<Touched> first, second;
                for (int k = 0; k < n; ++k) {
                    first.emplace_back(pass(items[p], k));
                    second.emplace_back(pass(items[q], k));
                }
                bool free = !Touched(begun()).disturbs(Touched({items[p]}), none);
                for (int k = 0; k < n && free; ++k)
                    for (int later = k + 1; later < n && free; ++later)
                        free = !second[std::size_t(k)].disturbs(first[std::size_t(later)], variables);
                if (free) {
                    for (Item& x : items[q].body) items[p].body.push_back(std::move(x));
                    items.erase(items.begin() + long(q));
                    Items const moved = begun();
                    for (std::size_t const b : begins) items.erase(items.begin() + long(b));
                    items.insert(items.begin() + long(p), moved.rbegin(), moved.rend());
                    return true;
                }
            }
            // A variable that is set before the loop and read behind it stays there: nothing is apart here.
            Items all = begun();
            all.push_back(items[q]);
            if (!Touched(all).disturbs(Touched({items[p]}), none)) continue;
            if (items[p].loops || items[p].value.op != Op::constant) break;
            begins.push_back(p);
        }
    }
    return false;
}

inline bool reads_array(Item const& item, int array) {
    if (item.loops) return std::ranges::any_of(item.body, [&](Item const& x) { return reads_array(x, array); });
    bool out = false;
    loads(item.value, [&](Ref const& r) { out = out || r.array == array; });
    return out;
}
inline void replace(Expression& e, Ref const& from, Ref const& to) {
    if (e.op == Op::load && e.ref == from) e.ref = to;
    for (Expression& x : e.arguments) replace(x, from, to);
}
/// Whether every use of its array in these statements is of this number of it.
inline bool alone(Items const& body, Ref const& ref) {
    bool out = true;
    for (Item const& item : body) {
        if (item.loops) {
            for (Item const& x : item.body) out = out && !reads_array(x, ref.array) && x.target.array != ref.array;
        } else {
            out = out && (item.target.array != ref.array || item.target == ref);
            loads(item.value, [&](Ref const& r) { out = out && (r.array != ref.array || r == ref); });
        }
    }
    return out;
}

inline void keep_in_variables(Routine& routine, std::set<int> const& kept) {
    Items& items = routine.items;
    for (std::size_t at = 0; at < items.size(); ++at) {
        if (!items[at].loops) continue;
        Items& body = items[at].body;
        for (std::size_t m = 0; m < body.size(); ++m) {
            if (body[m].loops || body[m].target.array >= routine.variables) continue;
            Ref const place = body[m].target;
            if (!alone(body, place)) continue;
            std::size_t next = m + 1;
            while (next < body.size() && (body[next].loops || body[next].target != place)) ++next;
            bool const again = next < body.size();
            bool const later = std::any_of(items.begin() + long(at) + 1, items.end(),
                                           [&](Item const& x) { return reads_array(x, place.array); });
            if (!again && (kept.contains(place.array) || later)) continue;
            std::size_t const last = std::min(next, body.size() - 1);
            if (std::none_of(body.begin() + long(m) + 1, body.begin() + long(last) + 1,
                             [&](Item const& x) { return reads_array(x, place.array); })) {
                body.erase(body.begin() + long(m--));
                continue;
            }
            Ref const variable{routine.variables + int(routine.kinds.size()), {0, place.index.strides}};
            Ref own = variable;
            for (int& stride : own.index.strides) stride = 0;
            routine.kinds.push_back(body[m].value.kind);
            body[m].target = own;
            for (std::size_t k = m + 1; k <= last; ++k) replace(body[k].value, place, own);
        }
    }
}

}  // namespace detail

/// The same with fewer loops and fewer places. `kept`: arrays whose numbers are read afterwards.
inline Routine fused(Routine routine, std::vector<int> const& kept) {
    while (detail::fuse_once(routine.items, routine.variables)) {}
    detail::keep_in_variables(routine, {kept.begin(), kept.end()});
    return routine;
}

}  // namespace rlslab::exporting
