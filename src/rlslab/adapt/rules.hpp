// THE list of rules of forgetting. A new one is its struct, or its file, and a line here; the program goes through the
// list.
#pragma once

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/core/type_list.hpp>

namespace rlslab {

/// A rule that is listed has, besides what ForgettingRule asks for, its words:
///   name, type, what   on the command line, as C++ template, and in one sentence whose capitals are names of its
///                      numbers
///   numbers()          a tuple of RuleNumber; absent where it has none
///   header             where it is not in adapt/forgetting.hpp: "adapt/its_own"
///   below_one          true where it does nothing unless Problem::forgetting < 1
template <Real T>
using Rules = TypeList<ConstantForgetting<T>, Fortescue<T>, Kulhavy<T>, CaoSchwartz<T>, RotatingRidge<T>,
                       CovarianceReset<T>, RandomWalk<T>>;

}  // namespace rlslab
