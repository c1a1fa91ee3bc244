/// \file
/// Seeded damage to texts and bytes, bounded in count and time.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <functional>
#include <iostream>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <string_view>

namespace lefort::test {

/// Processor time per test; on a slow machine fewer files are tested. LEFORT_FUZZ_SECONDS sets a
/// longer time with more files.
inline double seconds_per_test() {
  const char* const wanted = std::getenv("LEFORT_FUZZ_SECONDS");
  return wanted != nullptr ? std::atof(wanted) : 1.2;
}
/// Wall-clock time of one file on a loaded machine; a longer time means that the reader hangs.
inline constexpr double kSecondsPerFile = 20.0;

inline double processor_seconds() { return double(std::clock()) / CLOCKS_PER_SEC; }

inline double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// One to a few edits of all kinds.
///
/// \param tokens  words that may break parsers of the format; not empty.
inline std::string damaged(std::string bytes, std::span<const std::string_view> tokens,
                           std::mt19937& random) {
  const auto place = [&] { return random() % (bytes.size() + 1); };
  for (auto edits = 1 + random() % 5; edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = std::min(place(), bytes.size() - 1);
    switch (random() % 9) {
      case 0:
        bytes[at] = char(random() % 256);
        break;
      case 1:
        bytes[at] = char(bytes[at] ^ char(1 << (random() % 8)));
        break;
      case 2:
        bytes.resize(at);
        break;
      case 3:
        bytes.erase(at, random() % 40);
        break;
      case 4:
        bytes.insert(at, bytes.substr(std::min(place(), bytes.size()), random() % 200));
        break;
      case 5:
      case 6: {
        const std::string_view token = tokens[random() % tokens.size()];
        if (random() % 2 == 0)
          bytes.insert(at, token);
        else
          bytes.replace(at, std::min(token.size(), bytes.size() - at), token);
        break;
      }
      case 7: {  // A count of four bytes, as in binary formats.
        constexpr std::uint32_t kNumbers[] = {0,          1,          0x7FFFFFFF, 0x80000000,
                                              0xFFFFFFFF, 0x7FC00000, 0x7F800000, 0x00000001};
        const std::uint32_t number = kNumbers[random() % std::size(kNumbers)];
        std::memcpy(bytes.data() + at, &number, std::min(sizeof(number), bytes.size() - at));
        break;
      }
      default:
        std::reverse(bytes.begin() + std::ptrdiff_t(at),
                     bytes.begin() + std::ptrdiff_t(std::min(bytes.size(), at + random() % 30)));
    }
  }
  return bytes;
}

/// Runs `attempt` with seeds from 0 until all are done or the time limit is reached.
inline void run_seeds(unsigned count, const std::function<void(unsigned seed)>& attempt) {
  const double stop = processor_seconds() + seconds_per_test();
  if (std::getenv("LEFORT_FUZZ_SECONDS") != nullptr) count = ~0U;
  unsigned seed = 0;
  for (; seed < count && processor_seconds() < stop; ++seed) {
    SCOPED_TRACE(seed);
    const auto begin = std::chrono::steady_clock::now();
    attempt(seed);
    EXPECT_LT(seconds_since(begin), kSecondsPerFile);
    if (testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GT(seed, 20U);
  testing::Test::RecordProperty("files", std::to_string(seed));
  std::cout << seed << " files\n";
}

}  // namespace lefort::test
