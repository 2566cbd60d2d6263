// SHA-256 against the examples of FIPS 180-4 (NIST's "Examples with Intermediate Values") and at the ends of blocks.
#include <rlslab/input/formats/open.hpp>
#include <rlslab/input/sha256.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

namespace rlslab {
namespace {

std::string of(std::string const& text, size_t at_once) {
    Sha256 digest;
    for (size_t i = 0; i < text.size(); i += at_once) digest.add(std::string_view(text).substr(i, at_once));
    return digest.hex();
}

TEST(Sha256, GivesTheStandardsDigests) {
    std::string const two_blocks = "abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq";
    for (size_t const at_once : {1u, 7u, 64u, 1000000u}) {
        EXPECT_EQ(of("", at_once), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
        EXPECT_EQ(of("abc", at_once), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
        EXPECT_EQ(of(two_blocks, at_once), "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
        EXPECT_EQ(of(std::string(1000000, 'a'), at_once),
                  "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    }
}
/// Where the padding begins a block, ends one, and just misses one; digests by coreutils' sha256sum.
TEST(Sha256, PadsAtTheEndsOfABlock) {
    EXPECT_EQ(of(std::string(55, 'x'), 64), "d5e285683cd4efc02d021a5c62014694958901005d6f71e89e0989fac77e4072");
    EXPECT_EQ(of(std::string(56, 'x'), 64), "04c26261370ee7541549d16dee320c723e3fd14671e66a099afe0a377c16888e");
    EXPECT_EQ(of(std::string(63, 'x'), 64), "75220b47218278e656f2013bb8f0c455a25eaf01e86c64924e9d48d89776d6f2");
    EXPECT_EQ(of(std::string(64, 'x'), 64), "7ce100971f64e7001e8fe5a51973ecdfe1ced42befe7ee8d5fd6219506b5393c");
}
TEST(Sha256, OfAFileIsThatOfItsBytes) {
    auto const path = std::filesystem::temp_directory_path() / "rlslab_sha256_test.csv";
    std::string const text = "u,y\n1,2\n3,4\n";
    std::ofstream(path, std::ios::binary) << text;
    EXPECT_EQ(read_data(path.string(), {"y"}).sha256, of(text, 64));
    std::filesystem::remove(path);
}

}  // namespace
}  // namespace rlslab
