// Read as any other record: by the reader of CSV files.
#include "studies/published/nist_data.hpp"

#include <rlslab/model/regression.hpp>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstring>

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

Records records_of(std::string const& set) {
    std::string const name = set + ".csv";
    ByteSource const bytes = [rest = file(name)](std::span<char> to) mutable {
        std::size_t const n = std::min(rest.size(), to.size());
        std::memcpy(to.data(), rest.data(), n);
        rest.remove_prefix(n);
        return n;
    };
    CsvFile csv(bytes, name);
    std::vector<std::string> columns = csv.names();
    Columns const data = csv.read(columns);
    columns.pop_back();
    return linear_records(data, columns, "y");
}

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
