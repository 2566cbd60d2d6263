// What the page has in it from its build, as JSON: operations a row, records with their certified answers, and hashes
// that the page must reproduce. Usage: live_facts DATA_FOLDER
#include "docs/site/live/measures.hpp"
#include "docs/site/live/page.hpp"
#include "docs/site/live/settings.hpp"

#include <rlslab/catalogue/catalogue.hpp>
#include <rlslab/reference/certified.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <map>
#include <sstream>

namespace rlslab::live {
namespace {

using Json = nlohmann::ordered_json;

struct Record {
    char const *name, *file, *what, *source, *licence, *output, *inputs;  // inputs: blanks between them
    int past = 0, delays = 0;
    bool constant = false;
};
/// Those of studies/data/README.md, with models as the program gives them.
std::vector<Record> const records{
    {"sales", "sales.csv", "sales and a leading indicator", "Box and Jenkins 1976, series M, by R",
     "data of a book, distributed with R (GPL)", "sales", "lead", 2, 2, true},
    {"longley", "nist/longley.csv", "employment on six economic figures, nearly collinear", "NIST StRD; Longley 1967",
     "public domain", "y", "one x1 x2 x3 x4 x5 x6"},
    {"filip", "nist/filip.csv", "a polynomial of degree ten", "NIST StRD; A. Filippelli", "public domain", "y",
     "x0 x1 x2 x3 x4 x5 x6 x7 x8 x9 x10"},
    {"sunspots", "examples/sunspots.csv", "yearly numbers on the nine before", "NOAA, by statsmodels", "public domain",
     "number", "", 9, 0, true},
    {"airquality", "examples/airquality.csv", "ozone on sun, wind and temperature; rows are missing",
     "Chambers and others 1983, by R", "data of a book, distributed with R (GPL)", "Ozone", "Solar.R Wind Temp", 0, 0,
     true},
    {"consumption", "examples/consumption.csv", "consumption and income, both grow", "Federal Reserve, by statsmodels",
     "public domain", "consumption", "income", 2, 2, true}};
constexpr double record_forgetting = 1, record_prior = 14;

void set(std::map<std::string, double> const& chosen) {
    for (int i = 0; i < live_settings(); ++i) {
        auto const it = chosen.find(live_setting_name(i));
        live_values()[i] = it != chosen.end() ? it->second : live_setting_range(i)[3];
    }
}
std::string hexadecimal(double const* summary) {
    char out[17];
    std::snprintf(out, sizeof out, "%08lx%08lx", static_cast<unsigned long>(summary[11]),
                  static_cast<unsigned long>(summary[10]));
    return out;
}
[[noreturn]] void stop(std::string const& why) {
    std::cerr << "live_facts: " << why << '\n';
    std::exit(2);
}

Json operations() {
    Json out;
    for (int v = 0; v < live_variants(); ++v)
        for (int d = 1; d <= most_parameters; ++d) {
            Cost const c = cost(live_variant_name(v), d).value();
            out[live_variant_name(v)].push_back(
                {c.update.additions + c.theta.additions, c.update.multiplications + c.theta.multiplications,
                 c.update.divisions + c.theta.divisions, c.update.square_roots + c.theta.square_roots});
        }
    return out;
}

/// theta of all rows, scaled as the page scales them, in 30 digits.
Json certified_answer(int d) {
    set({{"table", 1}, {"bits", 53}, {"lambda", record_forgetting}, {"prior", record_prior}});
    if (live_start(0) != d) stop(live_message());
    int const n = live_rows_made();
    Records rows{Matrix<double>(d, n), Vector<double>(n), {}};
    for (int k = 0; k < n; ++k) {
        double const* const row = live_made_row(k);
        for (int i = 0; i < d; ++i) rows.psi(i, k) = row[i];
        rows.y[k] = row[d];
    }
    Problem<double> const problem{
        .size = d, .forgetting = record_forgetting, .prior = Prior<double>{.variance = std::exp2(record_prior)}};
    CertifiedSolution const exact = certified(problem, rows, {n}, 32).front();
    if (exact.status() != Status::certified) stop("a record without a certified answer");
    Json out;
    for (Reference const& x : exact.theta()) {
        double const head = static_cast<double>(x);
        out.push_back({head, static_cast<double>(Reference(x - Reference(head)))});
    }
    return out;
}
Json record_of(Record const& record, std::string const& folder) {
    std::ifstream file(folder + "/" + record.file, std::ios::binary);
    if (!file) stop(folder + "/" + record.file + ": cannot be read");
    std::string const text(std::istreambuf_iterator<char>(file), {});
    std::memcpy(live_text(int(text.size())), text.data(), text.size());
    int const columns = live_read_table(int(text.size()));
    if (columns < 0) stop(std::string(record.file) + ": " + live_message());
    auto const column = [&](std::string const& name) {
        for (int j = 0; j < columns; ++j)
            if (live_column_name(j) == name) return j;
        stop(std::string(record.file) + ": no column " + name);
    };
    std::vector<int> inputs;
    std::istringstream names(record.inputs);
    for (std::string name; names >> name;) inputs.push_back(column(name)), live_add_input(inputs.back());
    int const output = column(record.output), d = live_make_rows(output, record.past, record.delays, record.constant);
    if (d < 0) stop(std::string(record.file) + ": " + live_message());
    if (live_rows_made() > 300) stop(std::string(record.file) + ": more than 300 rows");
    return {{"name", record.name},
            {"what", record.what},
            {"source", record.source},
            {"licence", record.licence},
            {"text", text},
            {"output", output},
            {"inputs", inputs},
            {"past", record.past},
            {"delays", record.delays},
            {"constant", record.constant},
            {"lambda", record_forgetting},
            {"prior", record_prior},
            {"certified", certified_answer(d)}};
}

/// All variants over 300 rows at word lengths, exponents, roundings and switches of all kinds.
Json hashes() {
    Json out;
    auto const add = [&](std::map<std::string, double> const& chosen) {
        set(chosen);
        if (live_start(~0u) < 0) stop(live_message());
        for (int left = 300; left > 0;) left -= live_advance(std::min(left, 100));
        Json of;
        for (int v = 0; v < live_variants(); ++v) of[live_variant_name(v)] = hexadecimal(live_summary(v));
        out.push_back({{"settings", chosen}, {"hashes", of}});
    };
    for (double const bits : {2, 8, 11, 16, 24, 25, 26, 40, 53}) add({{"bits", bits}});
    for (double const d : {2, 8}) add({{"parameters", d}, {"condition", 4}});
    for (double const rounding : {0, 1, 2}) add({{"bits", 11}, {"exponents", 8}, {"rounding", rounding}});
    add({{"exponents", 5}, {"prior", 8}});
    add({{"units", 1}, {"condition", 6}, {"bits", 20}});
    add({{"gain_error", -10}, {"bits", 30}});
    add({{"outlier", 1}, {"silent", 1}, {"change", 1}, {"lambda", 0.95}});
    for (int guard = 1; guard <= live_guards(); ++guard) {
        add({{"outlier", 1}, {"silent", 1}, {"change", 1}, {"lambda", 0.95}, {"guard", guard}});
        add({{"gain_error", -10}, {"guard", guard}});
    }
    return out;
}

}  // namespace
}  // namespace rlslab::live

int main(int n, char** words) {
    using namespace rlslab::live;
    if (n != 2) stop("expected the folder of the records");
    Json out{{"operations", operations()}, {"records", Json::array()}, {"hashes", hashes()}};
    for (Record const& record : records) out["records"].push_back(record_of(record, words[1]));
    std::cout << out.dump() << '\n';
}
