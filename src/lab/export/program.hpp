// What a tape becomes: statements on arrays and variables, and loops of statements.
#pragma once

#include "src/lab/export/recorded.hpp"

#include <string>
#include <vector>

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

}  // namespace rlslab::exporting
