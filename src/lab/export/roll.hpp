// Loops: runs of statements that are the same but for places that go on by equal steps. Loops of equal count become one
// where no statement sees another order of what it depends on; a number stored for one pass alone becomes a variable.
#pragma once

#include "src/lab/export/lower.hpp"

#include <limits>

namespace rlslab::exporting {
namespace detail {

using Items = std::vector<Item>;

/// Without loops.
inline Items expanded(Items const& items);

/// visit(affine) for every index and count, in order.
template <class E, class Visit>
void indices_of(E& e, Visit& visit) {
    if (e.op == Op::load) visit(e.ref.index);
    for (auto& x : e.arguments) indices_of(x, visit);
}
template <class I, class Visit>
void indices(I& item, Visit& visit) {
    if (item.loops) {
        visit(item.count);
        for (auto& x : item.body) indices(x, visit);
    } else {
        visit(item.target.index);
        indices_of(item.value, visit);
    }
}

inline void write(std::string& out, auto const& number) {
    out.append(reinterpret_cast<char const*>(&number), sizeof number);
}
inline void shape_of(Affine const& index, std::string& out) {
    write(out, index.strides.size());
    for (int const s : index.strides) write(out, s);
}
inline void shape_of(Expression const& e, std::string& out) {
    out += {char('a' + int(e.op)), char(e.kind)};
    if (e.op == Op::constant) write(out, e.constant);
    if (e.op == Op::load) {
        write(out, e.ref.array);
        shape_of(e.ref.index, out);
    }
    for (Expression const& x : e.arguments) shape_of(x, out);
}
/// All but the bases of the indices.
inline void shape_of(Item const& item, std::string& out) {
    if (item.loops) {
        out += '[';
        shape_of(item.count, out);
        for (Item const& x : item.body) shape_of(x, out);
        out += ']';
    } else {
        out += '=';
        write(out, item.target.array);
        shape_of(item.target.index, out);
        shape_of(item.value, out);
    }
}
inline std::vector<int> bases_of(Item const& item) {
    std::vector<int> out;
    auto const add = [&](Affine const& index) { out.push_back(index.base); };
    indices(item, add);
    return out;
}

/// Equal but for nothing: constants by their bits.
inline bool same(Items const& a, Items const& b) {
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::string x, y;
        shape_of(a[i], x);
        shape_of(b[i], y);
        if (x != y || bases_of(a[i]) != bases_of(b[i])) return false;
    }
    return true;
}

/// The item in pass k of the outermost loop around it, whose stride is the last.
inline Item in_pass(Item item, int k) {
    auto const enter = [k](Affine& index) {
        if (index.strides.empty()) return;  // of the item's own inner loops: not reached
        index.base += k * index.strides.back();
        index.strides.pop_back();
    };
    indices(item, enter);
    return item;
}
inline int weight(Item const& item) {
    if (!item.loops) return 1;
    int out = 1;
    for (Item const& x : item.body) out += weight(x);
    return out;
}

struct Looked {
    Item item;
    std::string shape;
    std::vector<int> bases;
    explicit Looked(Item of) : item(std::move(of)), bases(bases_of(item)) { shape_of(item, shape); }
};

/// The loop whose first pass is [first, first + period) of `items`, each pass `step` further than the last.
inline Item loop_of(std::vector<Looked> const& items, std::size_t first, std::size_t period, int count,
                    std::vector<std::vector<int>> const& step) {
    Item out{.loops = true, .count = {count}};
    for (std::size_t m = 0; m < period; ++m) {
        Item item = items[first + m].item;
        std::size_t n = 0;
        auto const enter = [&](Affine& index) { index.strides.push_back(step[m][n++]); };
        indices(item, enter);
        out.body.push_back(std::move(item));
    }
    return out;
}
inline Items flat(std::vector<Looked> const& items, std::size_t first, std::size_t last) {
    Items out;
    for (std::size_t i = first; i < last; ++i) out.push_back(items[i].item);
    return expanded(out);
}
/// Pass k of the loop, without loops.
inline Items pass(Item const& loop, int k) {
    Items out;
    for (Item const& x : loop.body) out.push_back(in_pass(x, k));
    return expanded(out);
}
inline Items expanded(Items const& items) {
    Items out;
    for (Item const& item : items) {
        if (!item.loops) {
            out.push_back(item);
            continue;
        }
        for (int k = 0; k < item.count.base; ++k)
            for (Item& x : pass(item, k)) out.push_back(std::move(x));
    }
    return out;
}

/// How many of `items` from `first` on (or, backwards, before it) are together `wanted`; 0: none.
inline std::size_t taken(std::vector<Looked> const& items, std::size_t first, bool backwards, Items const& wanted) {
    std::size_t const most = backwards ? first : items.size() - first;
    for (std::size_t n = 1; n <= std::min(most, wanted.size()); ++n) {
        Items const here = backwards ? flat(items, first - n, first) : flat(items, first, first + n);
        if (here.size() == wanted.size()) return same(here, wanted) ? n : 0;
        if (here.size() > wanted.size()) return 0;
    }
    return 0;
}

/// The first loop of this period that saves statements, in place of what it repeats.
inline bool roll_once(std::vector<Looked>& items, std::size_t period) {
    for (std::size_t first = 0; first + 2 * period <= items.size(); ++first) {
        std::vector<std::vector<int>> step(period);
        auto const follows = [&](std::size_t k) {
            for (std::size_t m = 0; m < period; ++m) {
                Looked const &a = items[first + m], &b = items[first + k * period + m];
                if (a.shape != b.shape) return false;
                if (k == 1) step[m].resize(a.bases.size());
                for (std::size_t n = 0; n < a.bases.size(); ++n) {
                    if (k == 1) step[m][n] = b.bases[n] - a.bases[n];
                    if (b.bases[n] - a.bases[n] != int(k) * step[m][n]) return false;
                }
            }
            return true;
        };
        std::size_t passes = 1;
        while (first + (passes + 1) * period <= items.size() && follows(passes)) ++passes;
        if (passes < 2) continue;
        bool const nested = std::any_of(items.begin() + long(first), items.begin() + long(first + period),
                                        [](Looked const& x) { return x.item.loops; });
        Item loop = loop_of(items, first, period, int(passes), step);
        // A pass whose inner loop runs once, or not at all, is written without it.
        std::size_t begin = first, end = first + passes * period, more = passes;
        if (nested) {
            while (std::size_t const n = taken(items, end, false, pass(loop, int(more)))) end += n, ++more;
            int before = 0;
            while (std::size_t const n = taken(items, begin, true, pass(loop, before - 1))) begin -= n, --before;
            if (before < 0) {
                for (Item& x : loop.body) {
                    auto const shift = [&](Affine& index) { index.base += before * index.strides.back(); };
                    indices(x, shift);
                }
                more += std::size_t(-before);
            }
            loop.count.base = int(more);
        }
        int size = 0;
        for (Item const& x : loop.body) size += weight(x);
        if (more < 3 && size * int(more - 1) < 3) continue;
        items.erase(items.begin() + long(begin), items.begin() + long(end));
        items.insert(items.begin() + long(begin), Looked(std::move(loop)));
        return true;
    }
    return false;
}

// --- loops of equal count become one --------------------------------------------------------------------------------

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

/// The same with repeated statements as loops. Its expansion is the statements that it was made of.
inline Routine rolled(Routine routine) {
    using namespace detail;
    std::vector<Looked> items;
    for (Item const& item : routine.items) items.emplace_back(item);
    std::size_t constexpr longest = 40;
    for (std::size_t period = 1; period <= longest;) period = roll_once(items, period) ? 1 : period + 1;
    Routine out{.items = {}, .variables = routine.variables, .kinds = routine.kinds};
    for (Looked& x : items) out.items.push_back(std::move(x.item));
    if (!same(expanded(out.items), expanded(routine.items))) throw std::logic_error("loops of other statements");
    return out;
}

/// The same with fewer loops and fewer places. `kept`: arrays whose numbers are read afterwards.
inline Routine fused(Routine routine, std::vector<int> const& kept) {
    while (detail::fuse_once(routine.items, routine.variables)) {}
    detail::keep_in_variables(routine, {kept.begin(), kept.end()});
    return routine;
}

}  // namespace rlslab::exporting
