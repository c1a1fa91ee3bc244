// What a child writes is read as a file from an untrusted source.
#include <lefort/io/internal/descriptor.h>
#include <lefort/io/internal/reader_result.h>

#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace lefort::io::test_reader_result {
namespace {

std::vector<std::byte> written(const std::vector<double>& numbers, const std::string& text) {
  const Descriptor file(::memfd_create("test", MFD_CLOEXEC));
  ResultWriter writer(file.number(), 0);
  writer.number(std::int32_t{-7});
  writer.array(std::span<const double>(numbers));
  writer.text(text);
  EXPECT_TRUE(writer.flush());
  std::vector<std::byte> bytes(writer.position());
  EXPECT_EQ(::pread(file.number(), bytes.data(), bytes.size(), 0), std::ssize(bytes));
  return bytes;
}

bool read_all(std::span<const std::byte> bytes, std::vector<double>& numbers, std::string& text) {
  ResultReader reader(bytes);
  std::int32_t number = 0;
  return reader.number(number) && number == -7 && reader.array(numbers) && reader.text(text) &&
         reader.at_end();
}

TEST(ReaderResult, IsReadAsItWasWritten) {
  for (const std::size_t count : {0, 3, 100'000}) {
    const std::vector<double> numbers(count, 2.5);
    std::vector<double> found;
    std::string text;
    ASSERT_TRUE(read_all(written(numbers, "a\nb"), found, text));
    EXPECT_EQ(found, numbers);
    EXPECT_EQ(text, "a\nb");
  }
}

TEST(ReaderResult, RejectsEveryTruncation) {
  const std::vector<std::byte> bytes = written({1.0, 2.0}, "text");
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    std::vector<double> found;
    std::string text;
    EXPECT_FALSE(read_all(std::span(bytes).first(length), found, text)) << length;
  }
}

TEST(ReaderResult, RejectsSizesBeyondItsBytesWithoutAllocatingThem) {
  const auto count_of = [](std::uint64_t stated) {
    std::vector<std::byte> bytes(sizeof(stated) + 16);
    std::memcpy(bytes.data(), &stated, sizeof(stated));
    std::vector<double> found;
    ResultReader reader(bytes);
    return reader.array(found) ? std::ssize(found) : -1;
  };
  EXPECT_EQ(count_of(2), 2);
  EXPECT_EQ(count_of(3), -1);
  EXPECT_EQ(count_of(std::uint64_t{1} << 61), -1);  // Its size in bytes is 0 modulo 2^64.
  EXPECT_EQ(count_of(std::numeric_limits<std::uint64_t>::max()), -1);
}

}  // namespace
}  // namespace lefort::io::test_reader_result
