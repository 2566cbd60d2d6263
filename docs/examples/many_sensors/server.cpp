// Readings in, alarms out, by any pipe or socket; what was learnt is saved every minute, and nothing is lost by a kill.
//
//   server STATE [ROWS]    reads NAME,HOURS,VALUE or remove,NAME a line; saves every minute, and every ROWS lines
#include <sensors.hpp>

#include <charconv>
#include <chrono>
#include <cmath>
#include <iostream>
#include <unordered_map>

namespace {

using rlslab::Index;
constexpr double deviations = 6, silence = 1;  // an innovation that is an alarm; hours without a reading
constexpr Index learning = 30, memory = 1000;  // readings before the first such alarm; that the variance is from

using Clock = std::chrono::steady_clock;

class Server {
    Sensors s_;
    std::string path_;
    Index every_, saved_;
    Clock::time_point when_ = Clock::now();
    std::unordered_map<std::string, Index> number_of_;
    rlslab::Matrix<double> psi_;
    rlslab::Vector<double> y_;
    rlslab::FleetSteps<double> steps_;
    std::vector<Index> batch_, row_of_;  // sensors that have a reading in psi_ and y_; the lines these came in
    double hours_ = 0;                   // of the batch

public:
    Server(std::string const& path, Index every)
        : s_(load_file(path)), path_(path), every_(every), saved_(s_.rows), steps_(0) {
        for (size_t i = 0; i < s_.names.size(); ++i)
            if (s_.filters.alive(Index(i))) number_of_[s_.names[i]] = Index(i);
        make_room();
    }
    Index rows() const { return s_.rows; }
    void save() {
        std::fflush(stdout);  // first the alarms that the state counts as raised
        save_file(s_, path_);
        saved_ = s_.rows, when_ = Clock::now();
    }

    void remove(std::string const& name) {
        judge();
        auto const found = number_of_.find(name);
        if (found != number_of_.end()) {
            s_.filters.remove(found->second);
            s_.names[size_t(found->second)].clear();
            number_of_.erase(found);
        }
        ++s_.rows;
    }
    /// All readings of one time go to the fleet together.
    void read(std::string const& name, double hours, double value) {
        if (hours != hours_) judge();
        auto const [known, is_new] = number_of_.try_emplace(name, 0);
        if (is_new) known->second = add(name, hours);
        Index const i = known->second;
        if (!std::isnan(y_[i])) judge();
        hours_ = hours;
        psi_.row(i) << 1, hours;
        y_[i] = value;
        batch_.push_back(i);
        row_of_.push_back(s_.rows++);
    }
    void skip() { ++s_.rows; }

    /// The batch is whole; what comes next begins another. Only here the state is saved: lines alone decide what a
    /// batch is, and a server that starts from the state meets the same ones.
    void judge() {
        if (batch_.empty()) return;
        Index const count = s_.filters.filters();
        if (steps_.filters() != count) steps_.resize(count);
        s_.filters.update(psi_.topRows(count), y_.head(count), steps_);
        for (size_t k = 0; k < batch_.size(); ++k) judge(batch_[k], row_of_[k]);
        batch_.clear();
        row_of_.clear();
        for (size_t i = 0; i < s_.names.size(); ++i)
            if (s_.filters.alive(Index(i)) && !s_.silent[i] && s_.now - s_.last[i] > silence) {
                s_.silent[i] = 1;
                alarm(Index(i), s_.rows - 1, "silent", s_.now - s_.last[i]);
            }
        std::fflush(stdout);
        if (s_.rows - saved_ >= every_ || Clock::now() - when_ >= std::chrono::minutes(1)) save();
    }

private:
    Index add(std::string const& name, double hours) {
        Index const i = s_.filters.add();
        if (size_t(i) == s_.names.size()) {
            s_.names.emplace_back();
            for (auto* x : {&s_.last, &s_.variance}) x->push_back(0);
            for (auto* x : {&s_.learnt, &s_.silent}) x->push_back(0);
            make_room();
        }
        size_t const at = size_t(i);
        s_.names[at] = name, s_.last[at] = hours, s_.variance[at] = 0, s_.learnt[at] = s_.silent[at] = 0;
        return i;
    }
    void make_room() {
        Index const room = psi_.rows(), count = s_.filters.filters();
        if (count <= room) return;
        psi_.conservativeResize(2 * count, 2);
        y_.conservativeResize(2 * count);
        psi_.bottomRows(2 * count - room).setZero();
        y_.tail(2 * count - room).setConstant(NAN);
    }
    void judge(Index i, Index row) {
        size_t const at = size_t(i);
        y_[i] = NAN;
        if (steps_.health[at] != rlslab::Health::sound) {
            alarm(i, row, "health", double(steps_.health[at]));
            s_.filters.reset(i);
            s_.learnt[at] = 0;
            return;
        }
        s_.now = std::max(s_.now, hours_);
        s_.last[at] = hours_;
        s_.silent[at] = 0;
        double const e = steps_.innovation[i], square = steps_.gamma[i] * e * e, variance = s_.variance[at];
        if (s_.learnt[at] >= learning && square > deviations * deviations * variance)
            alarm(i, row, "innovation", e / std::sqrt(variance / steps_.gamma[i]));
        Index const n = s_.learnt[at] = std::min(s_.learnt[at] + 1, memory);
        s_.variance[at] += ((n > learning ? std::min(square, 9 * variance) : square) - variance) / double(n);
    }
    void alarm(Index i, Index row, char const* what, double how_much) {
        std::printf("alarm,%ld,%ld,%s,%.17g,%s,%.3g\n", long(s_.alarms++), long(row), s_.names[size_t(i)].c_str(),
                    hours_, what, how_much);
    }
};

bool number(std::string const& text, double& out) {
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), out);
    return error == std::errc{} && end == text.data() + text.size() && std::isfinite(out);
}
void take(Server& server, std::string const& line) {
    size_t const first = line.find(','), second = line.find(',', first + 1);
    double hours, value;
    if (second == line.npos && first != line.npos && line.substr(0, first) == "remove")
        server.remove(line.substr(first + 1));
    else if (first != 0 && second != line.npos && number(line.substr(first + 1, second - first - 1), hours) &&
             number(line.substr(second + 1), value))
        server.read(line.substr(0, first), hours, value);
    else {
        std::fprintf(stderr, "line %ld: expected NAME,HOURS,VALUE or remove,NAME: %s\n", long(server.rows()),
                     line.substr(0, 100).c_str());
        server.skip();
    }
}

}  // namespace

int main(int argc, char** argv) try {
    Index const every = argc == 3 ? std::atoll(argv[2]) : 100'000;
    if (argc < 2 || argc > 3 || every < 1) throw std::runtime_error("usage: server STATE [ROWS], ROWS >= 1");
    Server server(argv[1], every);
    std::printf("continue,%ld\n", long(server.rows()));
    std::fflush(stdout);
    std::ios::sync_with_stdio(false);
    for (std::string line; std::getline(std::cin, line) && !std::cin.eof();) take(server, line);  // whole lines alone
    server.judge();
    server.save();
    return 0;
} catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
}
