// From a tape to statements: what is not needed goes, what is used once stands where it is used, and a value that is
// stored is stored as soon as it is known.
#pragma once

#include "src/lab/export/recorded.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <string>

namespace rlslab::exporting {

/// base + sum of stride times counter; strides[0] belongs to the innermost loop around.
struct Affine {
    int base = 0;
    std::vector<int> strides{};
    bool operator==(Affine const&) const = default;
};
/// A number of an array, or a variable.
struct Ref {
    int array = -1;
    Affine index{};
    bool operator==(Ref const&) const = default;
};
/// A constant, a load from `ref`, or an operation on the arguments.
struct Expression {
    Op op = Op::constant;
    Kind kind = Kind::number;
    double constant = 0;
    Ref ref{};
    std::vector<Expression> arguments{};
};
/// target = value; or a loop of `count` passes.
struct Item {
    Ref target{};
    Expression value{};
    bool loops = false;
    Affine count{};
    std::vector<Item> body{};
};

/// visit(ref) for each load.
inline void loads(Expression const& e, auto&& visit) {
    if (e.op == Op::load) visit(e.ref);
    for (Expression const& x : e.arguments) loads(x, visit);
}

struct Routine {
    std::vector<Item> items;
    /// Variables are arrays of one number from this one on: all of numbers, then truths, then healths.
    int variables = 0;
    std::vector<Kind> kinds;  ///< of the variables
};

namespace detail {

inline constexpr int nowhere = -1;

class Lowering {
    Tape const& tape_;
    int const begin_, end_;
    std::vector<bool> needed_, variable_;
    std::vector<std::vector<int>> users_;
    std::vector<int> moved_;                        // where a store stands
    std::vector<std::vector<int>> stores_at_;       // those that stand behind this entry
    std::map<Place, std::vector<int>> written_at_;  // in order
    std::vector<int> root_;                         // the entry where the statement stands that a value is part of

    Entry const& at(int i) const { return tape_.entries[std::size_t(i)]; }
    static bool computes(Entry const& e) { return e.op != Op::constant && e.op != Op::load && e.op != Op::store; }
    std::vector<int>& users(int i) { return users_[std::size_t(i)]; }
    std::vector<int> operands(int i) const {
        Entry const& e = at(i);
        if (e.op == Op::load || e.op == Op::constant) return {};
        std::vector<int> out;
        for (int const x : {e.a, e.b, e.c})
            if (x >= 0) out.push_back(x);
        return out;
    }

    void find_needed(std::vector<int> const& kept, bool whole) {
        std::set<Place> live, killed;
        auto const is_kept = [&](Place const& p) {
            return live.contains(p) || (std::ranges::count(kept, p.array) > 0 && (whole || !killed.contains(p)));
        };
        for (int i = end_ - 1; i >= begin_; --i) {
            Entry const& e = at(i);
            bool wanted = needed_[std::size_t(i)];
            if (e.op == Op::store) {
                wanted = is_kept(e.place);
                live.erase(e.place);
                killed.insert(e.place);
                needed_[std::size_t(i)] = wanted;
            }
            if (!wanted) continue;
            if (e.op == Op::load) live.insert(e.place);
            for (int const x : operands(i)) {
                if (x < begin_ && at(x).op != Op::constant) throw std::logic_error("a value of another routine");
                needed_[std::size_t(x)] = true;
                users(x).push_back(i);
            }
        }
        for (auto& list : users_) std::ranges::reverse(list);
    }

    /// Stores move up to where their value is computed, if nothing looks at the place in between.
    void move_stores() {
        std::map<Place, int> last_touched;
        for (int i = begin_; i < end_; ++i) {
            Entry const& e = at(i);
            if (!needed_[std::size_t(i)] || (e.op != Op::load && e.op != Op::store)) continue;
            auto const touched = last_touched.find(e.place);
            int const before = touched == last_touched.end() ? nowhere : touched->second;
            if (e.op == Op::store && e.a >= begin_ && computes(at(e.a)) && before < e.a) moved_[std::size_t(i)] = e.a;
            last_touched[e.place] = i;
        }
        for (int i = begin_; i < end_; ++i)
            if (needed_[std::size_t(i)] && at(i).op == Op::store) {
                stores_at_[std::size_t(moved_[std::size_t(i)])].push_back(i);
                written_at_[at(i).place].push_back(moved_[std::size_t(i)]);
            }
        for (auto& [place, list] : written_at_) std::ranges::sort(list);
    }
    bool overwritten(Place const& place, int from, int before) const {
        auto const found = written_at_.find(place);
        if (found == written_at_.end()) return false;
        auto const next = std::ranges::upper_bound(found->second, from);
        return next != found->second.end() && *next < before;
    }

    /// A sum goes on in the variable that it has, and so does a chain of `and`.
    bool goes_on(Entry const& e) const {
        if (e.op == Op::both) {
            int first = e.a;
            while (at(first).op == Op::both) first = at(first).a;
            return at(first).op == Op::constant;
        }
        if ((e.op != Op::add && e.op != Op::subtract) || e.a == e.b) return false;
        Entry const& sum = at(e.a);
        return users_[std::size_t(e.a)].size() > 1 &&
               (sum.op == Op::constant || sum.op == Op::add || sum.op == Op::subtract);
    }
    bool begins_chain(int i) const {
        auto const& of = users_[std::size_t(i)];
        return at(i).kind == Kind::truth && of.size() == 1 && at(of.front()).op == Op::both;
    }
    void choose_variables() {
        for (int i = end_ - 1; i >= begin_; --i) {
            if (!needed_[std::size_t(i)]) continue;
            Entry const& e = at(i);
            if (e.op == Op::store) {
                root_[std::size_t(i)] = moved_[std::size_t(i)];
            } else if (e.op == Op::load) {
                bool const kept = std::ranges::any_of(
                    users(i), [&](int u) { return overwritten(e.place, i, root_[std::size_t(u)]); });
                variable_[std::size_t(i)] = kept;
                root_[std::size_t(i)] = i;
            } else if (e.op == Op::constant) {
                // One that operations share is a sum's beginning, and a variable as the sum is.
                variable_[std::size_t(i)] = begins_chain(i) || std::ranges::count_if(users(i), [&](int u) {
                                                                   return computes(at(u)) && at(u).op != Op::choose;
                                                               }) > 1;
                root_[std::size_t(i)] = i;
            } else {
                int const user = users(i).front();
                root_[std::size_t(i)] = users(i).size() == 1 ? root_[std::size_t(user)] : i;
                bool stays = users(i).size() == 1 && !goes_on(e);
                for (int const x : operands(i))
                    if (stays && at(x).op == Op::load && overwritten(at(x).place, x, root_[std::size_t(i)]) &&
                        !overwritten(at(x).place, x, i))
                        stays = false;
                variable_[std::size_t(i)] = !stays;
                if (!stays) root_[std::size_t(i)] = i;
            }
        }
    }

    Expression expression(int i, bool whole = false) const {
        Entry const& e = at(i);
        if (!whole && i >= begin_ && variable_[std::size_t(i)])
            return {.op = Op::load, .kind = e.kind, .ref = {variable(i), {}}};
        Expression out{.op = e.op, .kind = e.kind, .constant = e.constant};
        if (e.op == Op::load) out.ref = {e.place.array, {e.place.index}};
        for (int const x : operands(i)) out.arguments.push_back(expression(x));
        return out;
    }
    int variable(int i) const { return int(tape_.lengths.size()) + i; }

public:
    Lowering(Tape const& tape, int begin, int end, std::vector<int> const& kept, bool whole)
        : tape_(tape), begin_(begin), end_(end), needed_(std::size_t(end)), variable_(std::size_t(end)),
          users_(std::size_t(end)), moved_(std::size_t(end)), stores_at_(std::size_t(end)), root_(std::size_t(end)) {
        for (int i = 0; i < end; ++i) moved_[std::size_t(i)] = i;
        find_needed(kept, whole);
        move_stores();
        choose_variables();
    }
    /// One variable for each value that has one.
    std::vector<Item> statements() const {
        std::vector<Item> out;
        for (int i = begin_; i < end_; ++i) {
            if (!needed_[std::size_t(i)]) continue;
            if (variable_[std::size_t(i)]) out.push_back({.target = {variable(i), {}}, .value = expression(i, true)});
            for (int const s : stores_at_[std::size_t(i)])
                out.push_back({.target = {at(s).place.array, {at(s).place.index}}, .value = expression(at(s).a)});
        }
        return out;
    }
};

/// Statements that go on with the variable that the last one set come first: a sum that was begun is finished.
inline std::vector<Item> in_chains(std::vector<Item> const& items, int variables) {
    std::size_t const n = items.size();
    std::vector<std::vector<std::size_t>> before(n), reads(n);  // reads: the statements that set what it reads
    std::vector<std::vector<std::size_t>> readers(n);
    std::map<std::pair<int, int>, std::size_t> writer;
    std::map<std::pair<int, int>, std::vector<std::size_t>> looked;
    for (std::size_t i = 0; i < n; ++i) {
        loads(items[i].value, [&](Ref const& r) {
            std::pair const place{r.array, r.index.base};
            if (auto const w = writer.find(place); w != writer.end()) {
                before[i].push_back(w->second);
                if (r.array >= variables) readers[w->second].push_back(i);
            }
            looked[place].push_back(i);
        });
        std::pair const place{items[i].target.array, items[i].target.index.base};
        if (auto const w = writer.find(place); w != writer.end()) before[i].push_back(w->second);
        for (std::size_t const reader : looked[place])
            if (reader != i) before[i].push_back(reader);
        looked[place].clear();
        writer[place] = i;
    }
    std::vector<bool> done(n, false);
    std::vector<Item> out;
    std::vector<std::size_t> chain;
    auto const emit = [&](auto const& self, std::size_t i) -> void {
        if (done[i]) return;
        done[i] = true;
        for (std::size_t const b : before[i]) self(self, b);
        out.push_back(items[i]);
        if (items[i].target.array >= variables) chain.push_back(i);
    };
    // Whether nothing but loads is missing before it.
    auto const is_next = [&](std::size_t i) {
        return std::ranges::all_of(before[i], [&](std::size_t b) {
            return done[b] || (items[b].value.op == Op::load && items[b].target.array >= variables &&
                               std::ranges::all_of(before[b], [&](std::size_t c) { return done[c]; }));
        });
    };
    for (std::size_t next = 0; out.size() < n;) {
        while (!chain.empty()) {
            auto const& wanted = readers[chain.back()];
            auto const reader = std::ranges::find_if(wanted, [&](std::size_t r) { return !done[r]; });
            if (reader == wanted.end() || !is_next(*reader)) chain.pop_back();
            else emit(emit, *reader);
        }
        while (next < n && done[next]) ++next;
        if (next < n) emit(emit, next);
    }
    return out;
}

/// Few variables for many: one is free after its value was used last. A sum keeps its variable.
inline Routine with_few_variables(std::vector<Item> items, int variables) {
    std::map<int, std::size_t> last;
    for (std::size_t i = 0; i < items.size(); ++i)
        loads(items[i].value, [&](Ref const& r) {
            if (r.array >= variables) last[r.array] = i;
        });
    Routine out{.items = {}, .variables = variables, .kinds = {}};
    std::map<int, int> name;
    std::vector<bool> busy;
    for (std::size_t i = 0; i < items.size(); ++i) {
        Item& item = items[i];
        int first = nowhere;  // the variable of a sum that goes on
        std::vector<int> dying;
        auto const rename = [&](auto const& self, Expression& e) -> void {
            if (e.op == Op::load && e.ref.array >= variables) {
                int const old = e.ref.array;
                e.ref.array = variables + name.at(old);
                if (last.at(old) == i) dying.push_back(name.at(old));
            }
            for (Expression& x : e.arguments) self(self, x);
        };
        rename(rename, item.value);
        for (int const v : dying) busy[std::size_t(v)] = false;
        if (Expression const* e = &item.value; !e->arguments.empty()) {
            while (!e->arguments.empty() && (e->op == Op::add || e->op == Op::subtract || e->op == Op::both))
                e = &e->arguments.front();
            if (e->op == Op::load && std::ranges::count(dying, e->ref.array - variables) > 0)
                first = e->ref.array - variables;
        }
        if (item.target.array >= variables) {
            Kind const kind = item.value.kind;
            int to = first;
            for (int v = 0; to == nowhere && v < int(busy.size()); ++v)
                if (!busy[std::size_t(v)] && out.kinds[std::size_t(v)] == kind) to = v;
            if (to == nowhere) {
                to = int(busy.size());
                busy.push_back(false);
                out.kinds.push_back(kind);
            }
            busy[std::size_t(to)] = last.contains(item.target.array);
            name[item.target.array] = to;
            item.target.array = variables + to;
        }
    }
    out.items = std::move(items);
    return out;
}

}  // namespace detail

/// The entries [begin, end) of a tape. `kept`: arrays whose numbers are read afterwards. `whole`: stores there are kept
/// even where a later one follows.
inline Routine lowered(Tape const& tape, int begin, int end, std::vector<int> const& kept, bool whole) {
    int const variables = int(tape.lengths.size());
    std::vector<Item> const items = detail::Lowering(tape, begin, end, kept, whole).statements();
    return detail::with_few_variables(detail::in_chains(items, variables), variables);
}

}  // namespace rlslab::exporting
