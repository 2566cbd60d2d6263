// The sizes of the batches, for the rows that are timed and for the limits on them.
#pragma once

#include <string>
#include <vector>

namespace rlslab::bench {

inline std::vector<int> const batch_sizes{10, 20, 40, 60, 100};
inline int batch_rows(long size) { return size <= 40 ? 200000 : 50000; }  // more than a cache holds, either way
inline std::string shape(long rows, long size) { return std::to_string(rows) + "x" + std::to_string(size); }

}  // namespace rlslab::bench
