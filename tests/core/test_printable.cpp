#include <lefort/core/printable.h>

#include <gtest/gtest.h>

#include <string>

namespace lefort::test_printable {
namespace {

TEST(Printable, ReplacesWhatATerminalWouldExecute) {
  EXPECT_EQ(printable("A,\x1b]0;pwned\a\x1b[2J1,2,3"), "A,?]0;pwned??[2J1,2,3");
  EXPECT_EQ(printable("one\ntwo\r\x7f\x9b"
                      "1m"),
            "one?two??\x9b"
            "1m");
  EXPECT_EQ(printable("one\ntwo\r", LineBreaks::kKept), "one\ntwo?");
  EXPECT_EQ(printable("\xc2\x9b"
                      "1m"),
            "?1m");  // The escape sequence in one character.
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
}

TEST(Printable, KeepsText) {
  EXPECT_EQ(printable("Zoë\tist 3 mm weiter, „größer“"), "Zoë\tist 3 mm weiter, „größer“");
  EXPECT_EQ(printable("\xc2\xa0\xc2"), "\xc2\xa0\xc2");
  EXPECT_EQ(printable(""), "");
}

}  // namespace
}  // namespace lefort::test_printable
