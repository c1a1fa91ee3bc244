#include <lefort/io/output_folder.h>
#include <lefort/pipeline/validate/cohort_folder.h>
#include <lefort/pipeline/validate/find_cases.h>

#include <fmt/format.h>

#include <system_error>

namespace lefort::pipeline {

namespace fs = std::filesystem;

bool is_inside(const fs::path& inner, const fs::path& outer) {
  std::error_code error;
  const fs::path inner_path = fs::weakly_canonical(inner, error);
  const fs::path outer_path = fs::weakly_canonical(outer, error);
  const fs::path relative = inner_path.lexically_relative(outer_path);
  return !relative.empty() && *relative.begin() != "..";
}

Result<std::vector<fs::path>> open_cohort(const fs::path& cohort, const fs::path& output,
                                          std::span<const char* const> reports) {
  LEFORT_TRY(std::vector<fs::path> folders, list_cases(cohort));
  if (is_inside(output, cohort))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the output {} is inside the cohort, must be another folder", output.string()));
  for (const fs::path& folder : folders)
    if (is_inside(folder, output))
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the cohort is inside the output {}, must be another folder",
                              output.string()));
  LEFORT_TRY_VOID(io::make_output_folder(output));
  std::vector<fs::path> earlier;
  for (const char* const name : reports) earlier.push_back(output / name);
  LEFORT_TRY_VOID(io::remove_earlier_files(earlier));
  return folders;
}

}  // namespace lefort::pipeline
