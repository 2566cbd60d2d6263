// Rows folded on several threads, from memory and from a file larger than memory: the same bits; errors that name the
// file.
#include "tests/common/files.hpp"
#include "tests/common/laws.hpp"

#include <rlslab/many/fold_all.hpp>
#include <rlslab/input/row_file.hpp>
#include <rlslab/state/state.hpp>
#include <rlslab/variants/qr_block.hpp>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace rlslab {
namespace {

namespace fs = std::filesystem;
using files::Folder, files::message_of;
using F = QrBlock<double>;
static_assert(RowSource<RowFile> && !RowsInPlace<RowFile> && RowsInPlace<RowsInMemory>);

std::string file_of(Folder const& folder, Records const& records, std::string const& header = "") {
    std::string rows = header;
    for (Index k = 0; k < records.rows(); ++k) {
        rows.append(reinterpret_cast<char const*>(records.psi.col(k).data()), size_t(records.parameters()) * 8);
        rows.append(reinterpret_cast<char const*>(&records.y[k]), 8);
    }
    return folder.file(rows, "rows.bin");
}
/// A .npy file's beginning, as numpy.save writes it: 128 bytes for the shapes here.
std::string header_of(std::string const& shape, std::string const& type = "<f8", std::string const& fortran = "False") {
    std::string text = "{'descr': '" + type + "', 'fortran_order': " + fortran + ", 'shape': " + shape + ", }";
    text.resize(117, ' ');
    return std::string("\x93NUMPY\1\0\x76\0", 10) + text + '\n';
}
std::string file_of_bytes(Folder const& folder, size_t bytes) {
    return folder.file(std::string(bytes, '\0'), "rows.bin");
}

TEST(OutOfCore, TheBitsAreTheSameForAnyNumberOfThreadsAndFromAFile) {
    Records const records = laws::noise_records(5, 1003, Seed{51});
    Folder const folder;
    std::string const path = file_of(folder, records), array = (folder.path / "rows.npy").string();
    fs::rename(file_of(folder, records, header_of("(1003, 6)")), array);
    file_of(folder, records);
    for (auto const& p : {laws::problem(5, 0.999), Problem<double>{.size = 5, .prior = std::nullopt}}) {
        for (Index part : {Index(100), Index(256), rows_a_part}) {
            auto const one = state_of(fold_all<F>(p, RowsInMemory(records), 1, part));
            for (unsigned threads : {1u, 2u, 3u, 16u}) {
                EXPECT_EQ(state_of(fold_all<F>(p, RowFile(path, 5), threads, part)), one) << threads;
                EXPECT_EQ(state_of(fold_all<F>(p, RowFile(array), threads, part)), one) << threads;
                EXPECT_EQ(state_of(fold_all<F>(p, RowsInMemory(records), threads, part)), one) << threads;
            }
        }
        F const one = fold_all<F>(p, RowsInMemory(records), 1, 100);
        // Another division into parts rounds otherwise; the answer is the same.
        F all(p);
        all.update_block(records.psi, records.y);
        EXPECT_LE((one.theta() - all.theta()).norm(), 60 * epsilon<double>() * all.theta().norm());
        EXPECT_LE((fold_all<F>(p, RowsInMemory(records), 2).theta() - all.theta()).norm(),
                  60 * epsilon<double>() * all.theta().norm());
    }
}
TEST(OutOfCore, ShortWordsTakeTheirRowsRounded) {
    Records const records = laws::noise_records(3, 500, Seed{52});
    auto const f = fold_all<QrBlock<float>>(Problem<float>{.size = 3}, RowsInMemory(records), 2, 64);
    QrBlock<float> one(Problem<float>{.size = 3});
    one.update_block(records.psi.cast<float>(), records.y.cast<float>());
    EXPECT_LE((f.theta() - one.theta()).norm(), 60 * epsilon<float>() * one.theta().norm());
}
TEST(OutOfCore, MisuseThrowsAtTheDoor) {
    Records const records = laws::noise_records(3, 10, Seed{1});
    EXPECT_THROW(fold_all<F>(laws::problem(4), RowsInMemory(records)), std::invalid_argument);
    EXPECT_THROW(fold_all<F>(laws::problem(3), RowsInMemory(records), 1, 0), std::invalid_argument);
    EXPECT_THROW(fold_all<F>(laws::problem(3, 2), RowsInMemory(records)), std::invalid_argument);
}

/// A source that fails in the middle: every thread ends, and the error is the caller's.
struct Failing {
    Index size() const { return 2; }
    Index rows() const { return 1000; }
    void read(Index first, Eigen::Ref<Eigen::MatrixXd> block) const {
        if (first >= 500) throw InputError("rows.bin: broken");
        block.setOnes();
    }
};
TEST(OutOfCore, AnErrorOfTheSourceIsTheCallers) {
    for (unsigned threads : {1u, 2u, 5u})
        EXPECT_THAT(message_of([&] { fold_all<F>(laws::problem(2), Failing{}, threads, 10); }), Names("rows.bin"));
}

TEST(RowFile, SaysWhatIsWrongAndWithWhichFile) {
    Folder const folder;
    auto const opening = [&](std::string const& path) { return message_of([&] { RowFile(path, 4); }); };
    EXPECT_THAT(opening(folder.path / "none.bin"), Names("none.bin"));
    EXPECT_THAT(opening(folder.path), Names("directory"));
    ASSERT_EQ(mkfifo((folder.path / "pipe").c_str(), 0600), 0);
    EXPECT_THAT(opening(folder.path / "pipe"), Names("pipe regular"));
    EXPECT_THAT(opening(file_of_bytes(folder, 0)), Names("rows.bin empty"));
    EXPECT_THAT(opening(file_of_bytes(folder, 83)), Names("rows.bin 5 40 83 3"));
    EXPECT_THROW(RowFile(file_of_bytes(folder, 80), 0), std::invalid_argument);
}
TEST(RowFile, TakesAnArrayOfNumPyAndRefusesEveryOther) {
    Folder const folder;
    std::string const numbers(20 * 5 * 8, '\0');
    auto const opening = [&](std::string const& bytes, std::optional<Index> size = std::nullopt) {
        return message_of([&] { RowFile(folder.file(bytes, "rows.npy"), size); });
    };
    std::string const good = header_of("(20, 5)") + numbers;
    EXPECT_EQ(opening(good), "no error");
    EXPECT_EQ(opening(good, 4), "no error");
    EXPECT_THAT(opening(good, 3), Names("rows.npy 4 20 5"));
    EXPECT_THAT(opening(header_of("(20, 5)", "<f4") + numbers), Names("rows.npy float64 <f4"));
    EXPECT_THAT(opening(header_of("(20, 5)", ">f8") + numbers), Names("rows.npy order >f8"));
    EXPECT_THAT(opening(header_of("(20, 5)", "<f8", "True") + numbers), Names("rows.npy C 'fortran_order': True"));
    for (char const* shape :
         {"(100,)", "(5, 4, 5)", "()", "(20, -)", "(99999999999999999999, 5)", "(2 0, 5)", "(20, 5), 'shape': (20, 5)"})
        EXPECT_THAT(opening(header_of(shape) + numbers), Names("rows.npy two"));
    EXPECT_THAT(opening(header_of("(100, 1)") + numbers), Names("rows.npy 2 100 1"));
    EXPECT_THAT(opening(header_of("(100, -5)") + numbers), Names("rows.npy 2"));
    EXPECT_THAT(opening(header_of("(0, 5)")), Names("rows.npy no rows"));
    for (char const version : {'\0', '\x4', '\xff'}) {
        std::string other = good;
        other[6] = version;
        EXPECT_THAT(opening(other), Names("rows.npy version"));
    }
    for (char const* shape : {"(21, 5)", "(19, 5)", "(20, 6)", "(20, 9223372036854775807)", "(9223372036854775807, 5)"})
        EXPECT_THAT(opening(header_of(shape) + numbers), Names("rows.npy 800"));
    for (size_t left : {0, 6, 8, 11, 127}) {
        std::string const cut = left == 0 ? "empty" : "header";
        EXPECT_THAT(opening(good.substr(0, left)), Names("rows.npy " + cut)) << left;
    }
    EXPECT_THAT(opening(good.substr(0, 927)), Names("rows.npy 20 5 799"));
    EXPECT_THAT(opening(numbers), Names("rows.npy .npy number parameters"));
}
TEST(RowFile, ReadsAnyRowsAndNoOthers) {
    Records const records = laws::noise_records(4, 20, Seed{53});
    Folder const folder;
    RowFile const file(file_of(folder, records), 4);
    EXPECT_EQ(file.rows(), 20);
    Eigen::MatrixXd block(5, 3);
    file.read(17, block);
    EXPECT_EQ(block.topRows(4), records.psi.rightCols(3));
    EXPECT_EQ(block.row(4).transpose(), records.y.tail(3));
    EXPECT_THROW(file.read(18, block), std::invalid_argument);
    EXPECT_THROW(file.read(-1, block), std::invalid_argument);
    fs::resize_file(folder.path / "rows.bin", 18 * 40);
    EXPECT_THAT(message_of([&] { file.read(17, block); }), Names("rows.bin shorter"));
    RowFile const array(file_of(folder, records, header_of("(20, 5)")));
    ASSERT_EQ(array.size(), 4);
    array.read(17, block);
    EXPECT_EQ(block.row(4).transpose(), records.y.tail(3));
}

/// A process that may have 64 MB more than it has now folds a file of 160 MB, most of it a hole that reads as zeros.
TEST(OutOfCore, AFileLargerThanMemoryIsFolded) {
#ifdef RLSLAB_SANITIZED
    GTEST_SKIP() << "the sanitizer's own memory is beyond any limit";
#else
    Records const records = laws::noise_records(31, 5000, Seed{54});
    Folder const folder;
    std::string const path = file_of(folder, records);
    constexpr long row = 32 * 8, megabyte = 1 << 20;
    fs::resize_file(path, 160 * megabyte / row * row);
    F expected(laws::problem(31));
    expected.update_block(records.psi, records.y);

    pid_t const child = fork();
    ASSERT_GE(child, 0);
    if (child == 0) {
        long pages = 0;
        std::ifstream("/proc/self/statm") >> pages;
        rlim_t const limit = rlim_t(pages * sysconf(_SC_PAGESIZE) + 64 * megabyte);
        rlimit const both{limit, limit};
        if (setrlimit(RLIMIT_AS, &both) != 0) _exit(2);
        try {
            std::vector<char> const whole(160 * megabyte);
            _exit(3);  // no limit
        } catch (std::bad_alloc const&) {}
        try {
            RowFile const file(path, 31);
            Vector<double> const theta = fold_all<F>(laws::problem(31), file, 2).theta();
            _exit((theta - expected.theta()).norm() <= 60 * epsilon<double>() * theta.norm() ? 0 : 4);
        } catch (...) {
            _exit(5);
        }
    }
    int status = 0;
    ASSERT_EQ(waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status));
    EXPECT_EQ(WEXITSTATUS(status), 0);
#endif
}

}  // namespace
}  // namespace rlslab
