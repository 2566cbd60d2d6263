// What the server knows of its sensors, and how that is kept in a file.
#pragma once

#include <rlslab/many/fleet.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/ud.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <stdexcept>
#include <string>
#include <unistd.h>
#include <vector>

inline rlslab::Problem<double> const sensor{.size = 2, .forgetting = 0.999};  // offset and drift: psi = (1, hours)

/// A fleet, and beside each filter what its alarms need. All that a later row depends on is in `state`.
struct Sensors {
    using Filters = rlslab::Fleet<rlslab::Ud<rlslab::Pack<double, 8>, 2>>;
    using scalar = Filters::scalar;
    static constexpr std::string_view name = Filters::name, layer = "sensors";

    Filters filters;
    std::vector<double> last, variance;         // hours of the last reading; of the noise
    std::vector<rlslab::Index> learnt, silent;  // readings that the variance is from; 1 while it is silent
    double now = 0;                             // hours of the newest reading
    rlslab::Index rows = 0, alarms = 0;         // lines taken; alarms raised
    std::vector<std::string> names;             // empty where a sensor was removed

    explicit Sensors(rlslab::Index count)
        : filters(count, sensor), last(size_t(count)), variance(size_t(count)), learnt(size_t(count)),
          silent(size_t(count)), names(size_t(count)) {}
    static auto state(auto& s) {
        return std::tie(s.filters, s.last, s.variance, s.learnt, s.silent, s.now, s.rows, s.alarms);
    }
};

/// The names a line each, their number first; then the state.
inline std::string text_of(Sensors const& sensors) {
    std::string out = std::to_string(sensors.names.size()) + "\n";
    for (std::string const& name : sensors.names) out += name + "\n";
    size_t const first = out.size();
    out.resize(first + rlslab::state_size(sensors));
    rlslab::save(sensors, std::as_writable_bytes(std::span(out)).subspan(first));
    return out;
}

/// Writes beside the file, waits for the disk, and renames: at every moment the file is the old one or the new one.
inline void save_file(Sensors const& sensors, std::string const& path) {
    std::string const text = text_of(sensors), beside = path + ".new";
    int const file = ::open(beside.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    size_t at = 0;
    while (file >= 0 && at < text.size()) {
        ssize_t const written = ::write(file, text.data() + at, text.size() - at);
        if (written < 0 && errno != EINTR) break;
        if (written > 0) at += size_t(written);
    }
    bool const on_disk = file >= 0 && at == text.size() && ::fsync(file) == 0;
    if (file >= 0) ::close(file);
    if (!on_disk || ::rename(beside.c_str(), path.c_str()) != 0)
        throw std::runtime_error(path + ": cannot write: " + std::strerror(errno));
    size_t const slash = path.find_last_of('/');
    int const folder = ::open(slash == path.npos ? "." : path.substr(0, slash + 1).c_str(), O_RDONLY);
    if (folder >= 0) ::fsync(folder), ::close(folder);  // of the name, too
}

/// Without a file: no sensors, no rows.
inline Sensors load_file(std::string const& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file && errno == ENOENT) {
        Sensors none(1);  // a fleet has one number at least
        none.filters.remove(0);
        return none;
    }
    std::string line;
    rlslab::Index const count = std::getline(file, line) ? std::atoll(line.c_str()) : 0;
    file.seekg(0, std::ios::end);
    auto const bytes = file.tellg();
    if (count < 1 || count > bytes) throw std::runtime_error(path + ": expected a state of this server");
    file.seekg(std::streamoff(line.size() + 1));
    Sensors out(count);
    for (std::string& name : out.names) std::getline(file, name);
    std::string const rest{std::istreambuf_iterator<char>(file), {}};
    if (auto const fault = rlslab::load(out, std::as_bytes(std::span(rest))); fault != rlslab::StateFault::none)
        throw std::runtime_error(path + ": " + std::string(name_of(fault)));
    return out;
}
