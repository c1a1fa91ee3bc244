#include <lefort/io/internal/multipart.h>

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

namespace lefort::io::test_multipart {
namespace {

struct Read {
  bool ok = true, complete = false;
  std::vector<std::string> parts;
  std::size_t ended = 0;
};

Read read(const std::string& body, std::size_t piece, const std::string& boundary = "b0") {
  Read found;
  MultipartReader reader(boundary, {[&]() -> Result<void> {
                                      found.parts.emplace_back();
                                      return {};
                                    },
                                    [&](std::string_view bytes) -> Result<void> {
                                      found.parts.back() += bytes;
                                      return {};
                                    },
                                    [&]() -> Result<void> {
                                      ++found.ended;
                                      return {};
                                    }});
  for (std::size_t at = 0; at < body.size() && found.ok; at += piece)
    found.ok = reader.feed(std::string_view(body).substr(at, piece)).has_value();
  found.complete = reader.is_complete();
  return found;
}

const std::string kBody =
    "--b0\r\nContent-Type: application/dicom\r\nContent-Length: 9\r\n\r\n\r\n--bx\r\n"
    "\r\n--b0  \r\n\r\nsecond\r\n--b\r\n--b0\r\nA: b\r\n\r\n\r\n--b0--\r\nepilogue";

TEST(Multipart, SplitsAtBoundariesForAnyPieces) {
  for (std::size_t piece = 1; piece <= kBody.size(); ++piece) {
    const Read found = read(kBody, piece);
    ASSERT_TRUE(found.ok && found.complete) << piece;
    EXPECT_EQ(found.parts, (std::vector<std::string>{"\r\n--bx\r\n", "second\r\n--b", ""}));
    EXPECT_EQ(found.ended, 3U);
  }
}

TEST(Multipart, PreservesEveryByteOfAPart) {
  std::mt19937 random(7);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::string> parts(1 + random() % 4);
    std::string body = round % 2 == 0 ? "" : "preamble\r\n";
    for (std::string& part : parts) {
      for (auto n = random() % 300; n > 0; --n) part.push_back("\r\n-b0\0x"[random() % 8]);
      while (part.find("--b0") != std::string::npos) part.erase(part.find("--b0"), 1);
      body += "--b0\r\nContent-Type: application/dicom\r\n\r\n" + part + "\r\n";
    }
    body += "--b0--";
    const Read found = read(body, 1 + random() % 50);
    ASSERT_TRUE(found.ok && found.complete) << round;
    EXPECT_EQ(found.parts, parts) << round;
    EXPECT_EQ(found.ended, parts.size());
    // A truncated body is not complete.
    const std::string cut = body.substr(0, random() % body.size());
    EXPECT_FALSE(read(cut, 17).complete) << round;
  }
}

TEST(Multipart, ReturnsAResultForAnyInput) {
  std::mt19937 random(11);
  for (int round = 0; round < 20'000; ++round) {
    std::string body = kBody;
    for (auto edits = 1 + random() % 6; edits > 0 && !body.empty(); --edits) {
      const std::size_t at = random() % body.size();
      if (random() % 3 == 0)
        body.erase(at, 1 + random() % 9);
      else if (random() % 2 == 0)
        body.insert(at, kBody, random() % kBody.size(), random() % 20);
      else
        body[at] = char(random() % 256);
    }
    const Read found = read(body, 1 + random() % 40);
    EXPECT_LE(found.ended, found.parts.size());
  }
}

TEST(Multipart, RejectsEndlessHeadersAndBodiesWithoutParts) {
  EXPECT_FALSE(read("--b0\r\n" + std::string(100'000, 'x'), 1000).ok);
  EXPECT_FALSE(read("--b0\r\n" + std::string(100'000, 'x') + "\r\n\r\nbody", 1 << 20).ok);
  EXPECT_FALSE(read(std::string(100'000, 'x'), 1000).ok);
  EXPECT_FALSE(read("--b0 what\r\n\r\n", 1000).ok);
  EXPECT_FALSE(read("--b0" + std::string(100'000, ' '), 1000).ok);
  EXPECT_FALSE(read("", 1).complete);
  EXPECT_TRUE(read("--b0--", 1).complete);
}

TEST(Multipart, FindsTheBoundaryInTheContentType) {
  EXPECT_EQ(multipart_boundary("multipart/related; boundary=abc"), "abc");
  EXPECT_EQ(multipart_boundary("Multipart/Related; type=\"application/dicom; boundary=x\"; "
                               "Boundary=\"a b;c\"; start=1"),
            "a b;c");
  EXPECT_EQ(multipart_boundary("multipart/related;boundary=abc;type=x"), "abc");
  for (const char* const none :
       {"", "application/dicom", "multipart/related",
        "multipart/related; boundary=", "multipart/related; boundary=\"",
        "multipart/mixed; boundary=a", "multipart/related; boundary=\"a\r\nb\""})
    EXPECT_EQ(multipart_boundary(none), "") << none;
  EXPECT_EQ(multipart_boundary("multipart/related; boundary=" + std::string(71, 'a')), "");
}

}  // namespace
}  // namespace lefort::io::test_multipart
