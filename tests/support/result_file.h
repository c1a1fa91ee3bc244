/// \file
/// Result files of commands, checked against their schemas in contract/.
#pragma once

#include <lefort/io/validate_json.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <string>

namespace lefort::test {

/// A result as JSON. The test fails if the file is missing or breaks its schema.
///
/// \param kind  of the schema contract/KIND.schema.json.
inline nlohmann::json read_result(const std::filesystem::path& file, const std::string& kind) {
  const auto text = io::read_text(file, 1 << 28);
  EXPECT_TRUE(text) << file;
  if (!text) return {};
  const auto schema =
      io::read_text(std::filesystem::path(LEFORT_CONTRACT) / (kind + ".schema.json"), 1 << 24);
  EXPECT_TRUE(schema) << kind;
  if (schema) {
    const auto checked = io::validate_json(*text, *schema, file.filename().string());
    EXPECT_TRUE(checked) << file << ": " << checked.error().message;
  }
  return nlohmann::json::parse(*text);
}

}  // namespace lefort::test
