// The cells of a column of times: each is one, and all are written alike. Internal to the reader of CSV files.
#pragma once

#include <rlslab/input/csv_marks.hpp>
#include <rlslab/input/times.hpp>

#include <map>

namespace rlslab::csv {

class TimeCells {
public:
    /// The time in the next cell. Nothing: it is none, and the sentences below say why.
    std::optional<double> read(Reading reading, std::string_view cell, long line, std::size_t column);
    /// Whether a mark of these numbers may stand between thousands, or is not that of the others; `unread` says so.
    bool in_doubt(Marks of_others, char separator);
    bool numbers() const { return written_ == Written::number; }

    std::string expected;  ///< "expected a time ..., found ..."
    std::string unread;    ///< "... is not read as a time ...", of a column that nobody asked for

private:
    Written written_ = Written::missing;
    long line_ = 0;                      // that showed it
    std::map<Kind, Marks::Cell> first_;  // of each kind of number
};

}  // namespace rlslab::csv
