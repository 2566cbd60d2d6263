// The server, killed a hundred times at random points and restarted, beside one that was never killed.
#include <sensors.hpp>

#include <rlslab/core/random.hpp>

#include <csignal>
#include <filesystem>
#include <map>
#include <sstream>
#include <sys/wait.h>

namespace {

constexpr int sensors = 1000, times = 60, kills = 100;

/// A reading a line: an offset and a drift each, noise of 0.05, a reading in 2000 far off; one sensor is silent for a
/// while, one sends an hour that overflows; some go, and some of them come back.
std::vector<std::string> lines() {
    rlslab::Seed seed{1};
    std::vector<double> offset(sensors), drift(sensors);
    for (int i = 0; i < sensors; ++i) offset[size_t(i)] = seed.bell(), drift[size_t(i)] = 0.1 * seed.bell();
    std::vector<std::string> out;
    for (int k = 0; k < times; ++k)
        for (int i = 0; i < sensors; ++i) {
            double const hours = k / 20.0, value = offset[size_t(i)] + drift[size_t(i)] * hours + 0.05 * seed.bell();
            double const off = seed.uniform() < 0.0005 ? 5 : 0;
            if (k == 30 && i % 100 == 50) out.push_back("remove,s" + std::to_string(i));
            if ((i == 3 && k > 20 && k < 50) || (i % 100 == 50 && k >= 30 && k < 40)) continue;
            std::ostringstream line;
            line.precision(17);
            line << "s" << i << "," << (i == 7 && k == 40 ? 1e200 : hours) << "," << value + off;
            out.push_back(line.str());
        }
    return out;
}

/// The server as a process: `in` is its standard input, `out` its standard output.
struct Running {
    pid_t process;
    int in, out;
    Running(std::string const& server, std::string const& state) {
        int to[2], from[2];
        if (::pipe(to) != 0 || ::pipe(from) != 0 || (process = ::fork()) < 0) throw std::runtime_error("no process");
        if (process == 0) {
            ::dup2(to[0], 0), ::dup2(from[1], 1);
            for (int const end : {to[0], to[1], from[0], from[1]}) ::close(end);
            ::execl(server.c_str(), server.c_str(), state.c_str(), "1000", nullptr);
            ::_exit(127);
        }
        ::close(to[0]), ::close(from[1]);
        in = to[1], out = from[0];
    }
    bool write(std::string const& text) const { return ::write(in, text.data(), text.size()) == ssize_t(text.size()); }
    std::string line() const {
        std::string text;
        for (char c; ::read(out, &c, 1) == 1 && c != '\n';) text += c;
        return text;
    }
    /// The whole lines that it has written, at its end.
    std::vector<std::string> ended(bool killed) const {
        if (killed) ::kill(process, SIGKILL);
        ::close(in);
        std::string text;
        char some[4096];
        for (ssize_t n; (n = ::read(out, some, sizeof some)) > 0;) text.append(some, size_t(n));
        ::close(out);
        int status = 0;
        ::waitpid(process, &status, 0);
        if (!killed && status != 0) throw std::runtime_error("the server failed");
        std::vector<std::string> whole;
        size_t at = 0;
        for (size_t end; (end = text.find('\n', at)) != text.npos; at = end + 1)
            whole.push_back(text.substr(at, end - at));
        return whole;
    }
};

long number_behind(std::string const& line, std::string const& word) {
    if (line.rfind(word + ",", 0) != 0) throw std::runtime_error("expected " + word + ", found " + line);
    return std::atol(line.c_str() + word.size() + 1);
}
std::string bytes(std::string const& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

int main(int, char** argv) try {
    std::signal(SIGPIPE, SIG_IGN);
    std::string const server = std::filesystem::path(argv[0]).replace_filename("server");
    auto const folder = std::filesystem::temp_directory_path() / ("sensors-" + std::to_string(::getpid()));
    std::filesystem::create_directory(folder);
    std::string const killed = folder / "killed.state", never = folder / "never.state";
    auto const rows = lines();

    Running calm(server, never);
    calm.line();
    for (auto const& row : rows) calm.write(row + "\n");
    auto const expected = calm.ended(false);

    // A reader that keeps each number once.
    std::map<long, std::string> alarms;
    bool same_again = true;
    rlslab::Seed seed{2};
    long least = 0;
    for (int k = 0; k <= kills; ++k) {
        Running one(server, killed);
        long const from = number_behind(one.line(), "continue");
        if (from < least) throw std::runtime_error("rows were lost");
        least = from;
        auto const to = k == kills ? rows.size() : size_t(double(rows.size()) * (k + seed.uniform()) / kills);
        for (size_t i = size_t(from); i < to; ++i) one.write(rows[i] + "\n");
        if (k < kills) ::usleep(useconds_t(seed.uniform() * 8000));
        for (std::string const& alarm : one.ended(k < kills)) {
            auto const found = alarms.try_emplace(number_behind(alarm, "alarm"), alarm).first;
            same_again = same_again && found->second == alarm;
        }
    }
    bool once = alarms.size() == expected.size() && same_again;
    for (size_t i = 0; once && i < expected.size(); ++i) once = alarms[long(i)] == expected[i];
    bool const same = bytes(killed) == bytes(never);

    // Each filter alone.
    std::map<std::string, rlslab::Ud<double, 2>> alone;
    for (std::string const& row : rows) {
        size_t const first = row.find(','), second = row.find(',', first + 1);
        std::string const name = row.substr(0, first);
        if (second == row.npos) alone.erase(row.substr(first + 1));
        else {
            auto& filter = alone.try_emplace(name, sensor).first->second;
            double const hours = std::atof(row.c_str() + first + 1), value = std::atof(row.c_str() + second + 1);
            if (filter.update({1.0, hours}, value).health != rlslab::Health::sound)
                filter = rlslab::Ud<double, 2>(sensor);
        }
    }
    Sensors const after = load_file(killed);
    int bits = 0;
    for (size_t i = 0; i < after.names.size(); ++i)
        if (after.filters.alive(rlslab::Index(i)))
            bits += after.filters.theta(rlslab::Index(i)) == rlslab::Vector<double>(alone.at(after.names[i]).theta());
    std::map<std::string, int> kinds;
    for (std::string const& alarm : expected)
        for (char const* kind : {"innovation", "health", "silent"}) kinds[kind] += alarm.find(kind) != alarm.npos;

    std::printf("%d rows of %d sensors; killed %d times\n", int(rows.size()), int(alone.size()), kills);
    std::printf("the state, beside that of a server never killed: %s\n", same ? "the same bytes" : "other bytes");
    std::printf("theta, beside that of a filter alone: the bits of %d of %d\n", bits, int(alone.size()));
    std::printf("alarms: %d innovation, %d health, %d silent; each number once: %s\n", kinds["innovation"],
                kinds["health"], kinds["silent"], once ? "yes" : "no");
    std::filesystem::remove_all(folder);
    return same && once && bits == int(alone.size()) && kinds["health"] == 1 ? 0 : 1;
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
}
