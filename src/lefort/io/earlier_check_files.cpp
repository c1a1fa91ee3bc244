#include <lefort/io/earlier_check_files.h>
#include <lefort/io/read_text.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <regex>
#include <system_error>

namespace lefort::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxCheck = 64 << 20;  // Bytes.

/// Whether a check writes files of this name; names of segments as in contract/plan.schema.json.
bool is_of_a_check(const std::string& name) {
  static const std::regex ours(
      R"(cephalometry\.csv|planned_movements\.csv|worksheet\.pdf|landmarks_after\.(mrk\.json|csv)|)"
      R"(remainder\.vtp|)"
      R"(segment_[A-Za-z0-9_-]{1,40}\.(vtp|tfm)|pictures/plan_(cut|after)_[a-z_]{1,40}\.png)");
  return name.size() < 100 && std::regex_match(name, ours);
}

bool are_same(const fs::path& a, const fs::path& b) {
  std::error_code error;
  return fs::equivalent(a, b, error) && !error;
}

}  // namespace

Result<std::vector<fs::path>> earlier_check_files(const fs::path& folder) {
  const fs::path file = folder / "check.json";
  std::error_code error;
  if (!fs::exists(fs::symlink_status(file, error))) return std::vector<fs::path>();
  const Result<std::string> text = read_text(file, kMaxCheck);
  const auto json = text ? nlohmann::json::parse(*text, nullptr, false) : nlohmann::json();
  if (!json.is_object() || !json.contains("lefort_plan_check"))
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("{} is not a file of an earlier check and would be overwritten, choose "
                            "another output folder",
                            file.string()));
  std::vector<fs::path> files{file};
  const auto names = json.find("files");
  if (names == json.end() || !names->is_array()) return files;
  for (const auto& name : *names)
    if (name.is_string() && is_of_a_check(name.get<std::string>()))
      files.push_back(folder / name.get<std::string>());
  return files;
}

Result<void> check_inputs_are_distinct(std::span<const fs::path> inputs,
                                       std::span<const fs::path> files) {
  for (const fs::path& input : inputs)
    if (std::any_of(files.begin(), files.end(),
                    [&](const fs::path& file) { return are_same(input, file); }))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("{} is an input of this check and would be overwritten by its "
                              "results, choose another output folder",
                              input.string()));
  return {};
}

Result<void> check_overwrites_only_earlier(const fs::path& folder,
                                           std::span<const std::string> names,
                                           std::span<const fs::path> earlier) {
  std::error_code error;
  for (const std::string& name : names) {
    const fs::path file = folder / name;
    if (!fs::exists(fs::symlink_status(file, error)) ||
        std::find(earlier.begin(), earlier.end(), file) != earlier.end())
      continue;
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("{} is not a file of an earlier check and would be overwritten, choose "
                            "another output folder",
                            file.string()));
  }
  return {};
}

}  // namespace lefort::io
