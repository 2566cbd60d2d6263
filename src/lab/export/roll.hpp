// Loops: runs of statements that are the same but for places that go on by equal steps.
#pragma once

#include "src/lab/export/program.hpp"

#include <algorithm>
#include <bit>
#include <optional>

namespace rlslab::exporting {

/// Without loops.
inline std::vector<Item> expanded(std::vector<Item> const& items);
/// Equal but for nothing: constants by their bits.
inline bool same(std::vector<Item> const& a, std::vector<Item> const& b);
namespace detail {

using Items = std::vector<Item>;

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
inline Items flat(Items const& items) { return expanded(items); }
inline Items flat(std::vector<Looked> const& items, std::size_t first, std::size_t last) {
    Items out;
    for (std::size_t i = first; i < last; ++i) out.push_back(items[i].item);
    return expanded(out);
}
/// Pass k of the loop, without loops.
inline Items pass(Item const& loop, int k) {
    Items out;
    for (Item const& x : loop.body) out.push_back(in_pass(x, k));
    return flat(out);
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

}  // namespace detail

inline std::vector<Item> expanded(std::vector<Item> const& items) {
    using namespace detail;
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

inline bool same(std::vector<Item> const& a, std::vector<Item> const& b) {
    using namespace detail;
    if (a.size() != b.size()) return false;
    for (std::size_t i = 0; i < a.size(); ++i) {
        std::string x, y;
        shape_of(a[i], x);
        shape_of(b[i], y);
        if (x != y || bases_of(a[i]) != bases_of(b[i])) return false;
    }
    return true;
}

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

}  // namespace rlslab::exporting
