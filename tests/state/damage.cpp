// What is damaged or of another kind is refused in one line; a file is old or new whenever its writer is killed.
#include "tests/common/files.hpp"
#include "tests/common/states.hpp"

#include <rlslab/adapt/forgetting.hpp>
#include <rlslab/adapt/guard.hpp>
#include <rlslab/state/state_file.hpp>
#include <rlslab/variants/variants.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <sys/wait.h>
#include <unistd.h>

namespace rlslab {
namespace {

using states::Bytes, states::bytes_of, states::sealed;

/// 10 000 files: every flipped bit, every length, every byte gone or twice, swapped halves, blocks of noise.
TEST(State, DamagedIsRefused) {
    Ud<float, 2> f({.size = 2, .forgetting = 0.875f});
    f.update({1, -0.0f}, 3);
    Ud<float, 2> other({.size = 2, .forgetting = 0.75f});
    Bytes const whole = bytes_of(f), second = bytes_of(other);
    int files = 0, accepted = 0;
    auto const offer = [&](Bytes const& bytes) {
        if (bytes == whole || bytes == second) return;
        Ud<float, 2> g({.size = 2});
        auto const before = state_of(g);
        ++files;
        accepted += load(g, bytes) == StateFault::none || state_of(g) != before;
    };
    states::each_damaged(whole, offer);
    for (std::ptrdiff_t n = 0; n < std::ssize(whole); ++n) {
        Bytes head = whole;
        std::copy(second.begin() + n, second.end(), head.begin() + n);
        offer(head);
    }
    Seed seed{71};
    while (files < 10000) {
        Bytes bytes = whole;
        size_t const first = seed.next() % bytes.size(), count = 1 + seed.next() % (bytes.size() - first);
        for (size_t i = first; i < first + count; ++i) bytes[i] = std::byte(seed.next() & 255);
        offer(bytes);
    }
    EXPECT_EQ(accepted, 0) << files;
}
TEST(State, WithAForgedChecksumIsNotBelievedInEverything) {
    Information<double> f({.size = 2}), g({.size = 2, .forgetting = 0.5});
    Bytes bytes = state_of(f);
    Bytes const before = state_of(g);
    bytes[bytes.size() - 5] = std::byte(7);  // solved_
    EXPECT_EQ(load(g, sealed(bytes)), StateFault::value);
    EXPECT_EQ(state_of(g), before) << "as it was";
    bytes = state_of(f);
    for (int const version : {1, 3}) {
        bytes[8] = std::byte(version);
        bytes = sealed(bytes);
        EXPECT_EQ(load(g, bytes), StateFault::other_version);
        EXPECT_EQ(state_of(g), before);
        std::string const names = "information double " + std::to_string(version) + " 2";
        EXPECT_THAT(files::message_of([&] { loaded<Information<double>>(std::span<std::byte const>(bytes)); }),
                    Names(names));
    }
    bytes = state_of(f);
    for (std::uint64_t const entries : {std::uint64_t(0), std::uint64_t(2), std::uint64_t(0xffffffff)}) {
        detail::write_low(entries, 4, bytes.data() + StateHeader::size);
        bytes = sealed(bytes);
        EXPECT_EQ(load(g, bytes), StateFault::layout) << entries;
        EXPECT_EQ(state_of(g), before);
        EXPECT_NO_THROW((void)described_state(bytes));
    }
    bytes = state_of(f);
    detail::write_low(0x7fffffff, 4, bytes.data() + 24);  // nobody makes a filter of so many parameters
    bytes = sealed(bytes);
    EXPECT_THROW(loaded<Information<double>>(std::span<std::byte const>(bytes)), InputError);
}
TEST(State, SaysWhatIsInIt) {
    Guarded<Forgetting<Ud<float>, RotatingRidge<float>>> f({.size = 2, .forgetting = 0.5f});
    f.update(Vector<float>::Ones(2).eval(), 1);
    EXPECT_EQ(described_state(state_of(f)),
              "a state of ud in float with 2 parameters: format 2, 929 bytes\n"
              "guard, edition 2\n"
              "  on_outlier       skip\n"
              "  on_change        reset\n"
              "  on_windup        cap\n"
              "  on_breakdown     reset\n"
              "  innovation       6\n"
              "  least_noise      0\n"
              "  noise_memory     200\n"
              "  asymmetry        0.0009765625\n"
              "  rows             1  (counted)\n"
              "ridge, edition 1\n"
              "  ridge            0.001\n"
              "  toward_zero      0\n"
              "  rows             1  (counted)\n"
              "ud, edition 1\n");
    Bytes bytes = state_of(f);
    bytes[200] ^= std::byte(1);
    EXPECT_THAT(files::message_of([&] { (void)described_state(bytes); }), Names("929 checksum"));
}
TEST(State, IsRefusedInOneLine) {
    files::Folder const folder;
    auto const path = folder.path / "x.state";
    save(Qr<double>({.size = 3}), path);
    Ud<float> f({.size = 5});
    auto const message = [&] { return folder.without(files::message_of([&] { load(f, path); })); };
    EXPECT_THAT(message(), Names("x.state ud float 5 qr double 3"));
    save(Ud<float>({.size = 1}), path);
    EXPECT_THAT(message(), Names("x.state ud float 5 1"));
    auto const around = [&](auto const& expected) {
        auto filter = expected;
        return folder.without(files::message_of([&] { load(filter, path); }));
    };
    using F = Ud<float>;
    save(Guarded<F>({.size = 3}, {.innovation = 4}), path);
    EXPECT_THAT(around(Guarded<F>({.size = 3})), Names("x.state guard innovation 4 6"));
    EXPECT_THAT(around(Guarded<F, reporting>({.size = 3}, {.innovation = 4})),
                Names("x.state guard on_outlier skip report"));
    EXPECT_THAT(around(Forgetting<F, Kulhavy<float>>({.size = 3})), Names("x.state guard kulhavy ud"));
    folder.file("a,b\n1,2\n", "x.state");
    EXPECT_THAT(message(), Names("x.state ud float 5"));
    std::filesystem::remove(path);
    EXPECT_THAT(message(), Names("x.state file"));
    std::filesystem::create_directory(path);
    EXPECT_THAT(message(), Names("x.state folder"));
    std::filesystem::remove(path);
    EXPECT_THAT(files::message_of([&] { save(f, folder.path / "no" / "folder"); }), Names("folder write"));
    EXPECT_THAT(folder.without(files::message_of([&] { loaded<Ud<float>>(path); })), Names("x.state"));
}

// --- kills -----------------------------------------------------------------------------------------------------------

/// Whether the file is old or new after each of 100 processes was killed that did nothing but save one and the other.
template <class Save>
bool whole_after_kills(Save save_to, int kills) {
    files::Folder const folder;
    auto const path = folder.path / "filter.state";
    Ud<double> old_one({.size = 60, .forgetting = 0.5}), new_one({.size = 60, .forgetting = 0.75});
    save_to(old_one, path);
    Seed seed{81};
    for (int i = 0; i < kills; ++i) {
        pid_t const child = fork();
        if (child == 0)
            for (;;) {
                save_to(new_one, path);
                save_to(old_one, path);
            }
        usleep(useconds_t(seed.next() % 5000));
        kill(child, SIGKILL);
        waitpid(child, nullptr, 0);
        try {
            Bytes const found = state_of(loaded<Ud<double>>(path));
            if (found != state_of(old_one) && found != state_of(new_one)) return false;
        } catch (InputError const&) {
            return false;
        }
    }
    return true;
}
TEST(State, IsSoughtInTheFirstBytes) {
    files::Folder const folder;
    EXPECT_EQ(detail::bytes_of("/dev/zero").size(), StateHeader::magic.size());
    auto const text = folder.file("not a state, and longer than one's first bytes", "text");
    EXPECT_EQ(detail::bytes_of(text).size(), StateHeader::magic.size());
    EXPECT_TRUE(detail::bytes_of(folder.file("", "empty")).empty());
    Ud<double> const f({.size = 2});
    auto const path = folder.path / "state";
    save(f, path, false);
    EXPECT_EQ(detail::bytes_of(path).size(), state_size(f));
    EXPECT_THAT([] { described_state({}); }, testing::ThrowsMessage<InputError>(testing::HasSubstr("found nothing")));
}
/// Of lanes, each of them. A count that indexes memory is read from a file whose checksum anyone can make right.
TEST(State, HasNoCountBeyondItsEnd) {
    using Lane = Lanes<std::ptrdiff_t, 2>;
    for (std::ptrdiff_t const n : {-1, 0, 7, 8}) {
        std::byte bytes[2 * Encoding<std::ptrdiff_t>::size];
        Encoding<BoundedCount>::write({n, 0}, bytes);
        BoundedCount one{0, 7};
        EXPECT_EQ(Encoding<BoundedCount>::read(bytes, one), 0 <= n && n <= 7) << n;
        Lane lanes(3);
        lanes.value[1] = n;
        BoundedCountOf<Lane> two{Lane(0), 7};
        Encoding<decltype(two)>::write({lanes, 0}, bytes);
        EXPECT_EQ(Encoding<decltype(two)>::read(bytes, two), 0 <= n && n <= 7) << n;
    }
}
TEST(State, IsOldOrNewAfterAnyKill) {
    EXPECT_TRUE(whole_after_kills([](auto const& f, auto const& path) { save(f, path, false); }, 50));
    EXPECT_TRUE(whole_after_kills([](auto const& f, auto const& path) { save(f, path, true); }, 50));
}
TEST(StateSaboteur, AWriterInPlaceIsCaught) {
    pid_t const parent = getpid();
    auto const in_place = [parent](auto const& f, auto const& path) {
        Bytes const bytes = state_of(f);
        std::ofstream file(path, std::ios::binary);
        file.write(reinterpret_cast<char const*>(bytes.data()), std::streamsize(bytes.size() / 2)).flush();
        if (getpid() != parent) raise(SIGKILL);  // at the worst moment
        file.write(reinterpret_cast<char const*>(bytes.data() + bytes.size() / 2),
                   std::streamsize(bytes.size() - bytes.size() / 2));
    };
    auto const with_time = [&](auto const& f, auto const& path) { in_place(f, path); };
    bool whole = true;
    for (int i = 0; i < 20 && whole; ++i) whole = whole_after_kills(with_time, 20);
    EXPECT_FALSE(whole);
}

}  // namespace
}  // namespace rlslab
