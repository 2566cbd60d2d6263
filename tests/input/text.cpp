// Text in lines of a certain width.
#include <rlslab/input/text.hpp>

#include <gtest/gtest.h>

namespace rlslab {
namespace {

TEST(Wrapped, BreaksAtSpacesBeforeTheWidth) {
    EXPECT_EQ(wrapped("one two three", 0, 2, 7), "one two\n  three") << "a line may be as long as the width";
    EXPECT_EQ(wrapped("one two three", 0, 2, 6), "one\n  two\n  three") << "not longer";
    EXPECT_EQ(wrapped("one two", 1, 0, 7), "one\ntwo") << "what stands before the text counts";
    EXPECT_EQ(wrapped("one  two", 0, 0, 4), "one\ntwo") << "no line begins or ends with a space";
}
TEST(Wrapped, LeavesALongWordWhole) {
    EXPECT_EQ(wrapped("incompressible it is", 0, 1, 5), "incompressible\n it\n is");
    EXPECT_EQ(wrapped("incompressible", 0, 1, 5), "incompressible");
    EXPECT_EQ(wrapped("", 9, 1, 5), "");
}

}  // namespace
}  // namespace rlslab
