// A variant's constructor, its update and its theta, as a tape; and what of the memory is its state.
#pragma once

#include "src/lab/export/recorded.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace rlslab::exporting {

/// A number or an array of the state, in the order of its bytes.
struct Member {
    std::string name;
    Kind kind = Kind::number;
    int array = -1, length = 0;
    bool listed = false;  ///< an array, even if of one number
};

struct Recording {
    Tape tape;
    int begun = 0, made = 0, updated = 0, solved = 0;  ///< where constructor begins, and these three end
    std::vector<Member> state;
    std::vector<std::byte> head;  ///< of the state's bytes: all before its numbers
    /// Arrays: what the constructor takes, what update takes and returns, and theta where update does not store it.
    int forgetting = -1, variance = -1, psi = -1, y = -1, innovation = -1, residual = -1, gamma = -1, health = -1,
        theta = -1, valid = -1;  ///< valid: whether the constructor takes what it is given
};

/// Records a variant that is exported, in float or double with `size` parameters.
Recording recorded(std::string_view variant, int size, bool in_double);

}  // namespace rlslab::exporting
