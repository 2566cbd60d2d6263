// Read as any other record: by the reader of CSV files.
#include "studies/published/data.hpp"

#include <rlslab/core/input_error.hpp>
#include <rlslab/model/regression.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>

namespace rlslab::studies {
namespace {

/// The last column is y.
Records read(CsvFile csv) {
    std::vector<std::string> columns = csv.names();
    Columns const data = csv.read(columns);
    columns.pop_back();
    return linear_records(data, columns, "y");
}
Records read(std::string_view text, std::string const& name) {
    ByteSource const bytes = [rest = text](std::span<char> to) mutable {
        std::size_t const n = std::min(rest.size(), to.size());
        std::memcpy(to.data(), rest.data(), n);
        rest.remove_prefix(n);
        return n;
    };
    return read(CsvFile(bytes, name));
}

}  // namespace
}  // namespace rlslab::studies

namespace rlslab::studies::strd {
namespace {

std::map<std::string, std::vector<Reference>> decimals() {
    std::map<std::string, std::vector<Reference>> out;
    nlohmann::json const solutions = nlohmann::json::parse(file("solutions.json"));
    for (auto const& [set, solution] : solutions.items()) {
        auto const& theta = solution.contains("theta_decimal") ? solution.at("theta_decimal") : solution.at("theta");
        for (auto const& digits : theta) out[set].emplace_back(digits.get<std::string>());
    }
    return out;
}

}  // namespace

Records records_of(std::string const& set) { return read(file(set + ".csv"), set + ".csv"); }

Reference decimal(std::string const& set, Index i) {
    static auto const all = decimals();
    return all.at(set).at(size_t(i));
}

std::map<std::string, std::map<std::string, double>> const& listed_digits() {
    static auto const digits =
        nlohmann::json::parse(file("digits.json")).get<std::map<std::string, std::map<std::string, double>>>();
    return digits;
}

}  // namespace rlslab::studies::strd

namespace rlslab::studies::survey_data {
namespace {

constexpr std::string_view of_nist = "NIST.";

/// sum (x - mean)^2 / (N - 1) of these numbers, and the mean.
struct Moments {
    double mean = 0, deviation = 0;
    template <class Numbers>
    explicit Moments(Numbers const& x) {
        for (Index k = 0; k < x.size(); ++k) mean += x[k] / double(x.size());
        double squares = 0;
        for (Index k = 0; k < x.size(); ++k) squares += (x[k] - mean) * (x[k] - mean);
        deviation = std::sqrt(squares / double(x.size() - 1));
    }
};

}  // namespace

std::vector<std::string> used() {
    std::vector<std::string> out;
    for (std::string_view rest = file("records.csv"); !rest.empty();) {
        std::string_view const line = rest.substr(0, rest.find('\n'));
        rest.remove_prefix(std::min(rest.size(), line.size() + 1));
        if (line.ends_with(",used")) out.emplace_back(line.substr(0, line.find(',')));
    }
    return out;
}

bool in_program(std::string const& record) { return record.starts_with(of_nist) || !file(record + ".csv").empty(); }

Records records_of(std::string const& record) {
    if (record.starts_with(of_nist)) return strd::records_of(record.substr(of_nist.size()));
    std::string const name = record + ".csv";
    if (std::string_view const text = file(name); !text.empty()) return read(text, name);
    char const* const folder = std::getenv("RLSLAB_RECORDS");
    if (!folder)
        throw InputError(
            "expected RLSLAB_RECORDS=FOLDER in the environment, written by studies/data/survey/lay_out.py FOLDER");
    return read(CsvFile(fmt::format("{}/{}", folder, name)));
}

Records scaled(Records records) {
    for (Index i = 0; i < records.parameters(); ++i) {
        auto row = records.psi.row(i);
        if ((row.array() == row[0]).all()) continue;
        Moments const of(row);
        for (Index k = 0; k < records.rows(); ++k) row[k] = (row[k] - of.mean) / of.deviation;
    }
    double const deviation = Moments(records.y).deviation;
    for (Index k = 0; k < records.rows(); ++k) records.y[k] /= deviation;
    return records;
}

Records first_half(Records const& records) {
    Index const rows = (records.rows() + 1) / 2;
    return {.psi = records.psi.leftCols(rows), .y = records.y.head(rows), .names = records.names};
}

}  // namespace rlslab::studies::survey_data
