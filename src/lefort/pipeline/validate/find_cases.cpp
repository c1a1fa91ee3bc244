#include <lefort/io/plan_inputs.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/volume_files.h>
#include <lefort/pipeline/validate/find_cases.h>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <system_error>

namespace lefort::pipeline {
namespace {

namespace fs = std::filesystem;
using OptionalPath = std::optional<fs::path>;

constexpr const char* kParticipant = "sub-";  // How BIDS begins the name of a case's folder.
constexpr std::array kSurfaceEndings{".vtp", ".stl", ".ply", ".obj"};
constexpr std::array kLandmarkEndings{".mrk.json", ".csv"};
constexpr std::uintmax_t kMaxPlanBytes = 4 << 20;  // Bytes, as io/plan_file.

bool is_surface(const std::string& ending) {
  return std::find(kSurfaceEndings.begin(), kSurfaceEndings.end(), ending) != kSurfaceEndings.end();
}

bool is_landmarks(const std::string& ending) {
  return std::find(kLandmarkEndings.begin(), kLandmarkEndings.end(), ending) !=
         kLandmarkEndings.end();
}

bool is_scan(const std::string& ending) {
  return ending.empty() ||
         (ending.front() == '.' && (ending == ".inv3" || io::is_volume_file("scan" + ending)));
}

/// The entry STEM + ending of a folder. A folder has the ending "".
template <class Accepts>
Result<OptionalPath> find_one(const std::vector<fs::path>& entries, const std::string& stem,
                              const Accepts& accepts) {
  OptionalPath found;
  for (const fs::path& entry : entries) {
    const std::string name = entry.filename().string();
    if (!name.starts_with(stem)) continue;
    std::error_code error;
    const std::string ending = name.substr(stem.size());
    if (ending.empty() != fs::is_directory(entry, error) || !accepts(ending)) continue;
    if (found)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the case has {} and {}, must have one of them",
                              found->filename().string(), name));
    found = entry;
  }
  return found;
}

Result<SurfaceFiles> find_surfaces(const std::vector<fs::path>& entries,
                                   const std::string& prefix) {
  SurfaceFiles files;
  LEFORT_TRY(files.skin, find_one(entries, prefix + "_skin", is_surface));
  LEFORT_TRY(files.skull, find_one(entries, prefix + "_skull", is_surface));
  LEFORT_TRY(files.mandible, find_one(entries, prefix + "_mandible", is_surface));
  return files;
}

Result<std::vector<fs::path>> entries_of(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator();
       it.increment(error))
    entries.push_back(it->path());
  if (error)
    return fail(ErrorCode::kFileNotFound,
                fmt::format("{} cannot be listed: {}", folder.string(), error.message()));
  std::sort(entries.begin(), entries.end());
  return entries;
}

OptionalPath first_file(std::initializer_list<fs::path> files) {
  std::error_code error;
  for (const fs::path& file : files)
    if (fs::is_regular_file(file, error)) return file;
  return std::nullopt;
}

/// before.nrrd, after_skin.ply, plan.json, ...
Result<CohortCase> find_named_by_role(CohortCase one) {
  LEFORT_TRY(const std::vector<fs::path> entries, entries_of(one.folder));
  LEFORT_TRY(one.before_scan, find_one(entries, "before", is_scan));
  LEFORT_TRY(one.after_scan, find_one(entries, "after", is_scan));
  LEFORT_TRY(one.before, find_surfaces(entries, "before"));
  LEFORT_TRY(one.after, find_surfaces(entries, "after"));
  LEFORT_TRY(one.landmarks, find_one(entries, "landmarks", is_landmarks));
  one.plan = first_file({one.folder / "plan.json", one.folder.parent_path() / "plan.json"});
  return one;
}

/// ct/sub-LABEL_ct.nii.gz, or ses-before/ct/sub-LABEL_ses-before_ct.nii.gz and the same of
/// ses-after; plan and landmarks are beside the scan before surgery.
Result<CohortCase> find_named_by_bids(CohortCase one) {
  std::error_code error;
  const bool has_sessions = fs::is_directory(one.folder / "ses-before", error);
  const fs::path before = has_sessions ? one.folder / "ses-before" / "ct" : one.folder / "ct";
  const fs::path after = one.folder / "ses-after" / "ct";
  const std::string name = has_sessions ? one.name + "_ses-before" : one.name;
  LEFORT_TRY(const std::vector<fs::path> entries, entries_of(before));
  LEFORT_TRY(one.before_scan, find_one(entries, name + "_ct", is_scan));
  LEFORT_TRY(one.before, find_surfaces(entries, name));
  LEFORT_TRY(one.landmarks, find_one(entries, name + "_landmarks", is_landmarks));
  one.plan = first_file({before / (name + "_plan.json"), one.folder.parent_path() / "plan.json"});
  if (!fs::is_directory(after, error)) return one;
  LEFORT_TRY(const std::vector<fs::path> entries_after, entries_of(after));
  LEFORT_TRY(one.after_scan, find_one(entries_after, one.name + "_ses-after_ct", is_scan));
  LEFORT_TRY(one.after, find_surfaces(entries_after, one.name + "_ses-after"));
  return one;
}

Result<void> check_files(const CohortCase& one, AfterSurgery after) {
  const auto bad = [](const std::string& what) { return fail(ErrorCode::kInvalidArgument, what); };
  const bool has_surface = one.before.skin || one.before.skull || one.before.mandible;
  if (one.before_scan && has_surface)
    return bad("the case has a scan and surfaces before surgery, must have one of them");
  if (!one.before_scan && !(one.before.skin && one.before.skull))
    return bad(
        "the case has no head before surgery, must have before.nrrd (or another scan; in BIDS "
        "ct/sub-LABEL_ct.nii.gz), or before_skin and before_skull (.vtp, .stl, .ply, .obj)");
  if (one.after_scan && one.after.skin)
    return bad("the case has a scan and a skin after surgery, must have one of them");
  if (after == AfterSurgery::kRequired && !one.has_after())
    return bad(
        "the case has no face after surgery, must have after.nrrd (or another scan), or after_skin "
        "(.vtp, .stl, .ply, .obj)");
  return {};
}

/// Hash of all files in a folder, by name.
Result<std::string> sha256_of_folder(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error))
    if (it->is_regular_file(error)) files.push_back(it->path());
  std::sort(files.begin(), files.end());
  io::Sha256 hash;
  for (const fs::path& file : files) {
    LEFORT_TRY(const std::string sha256, io::sha256_of_file(file));
    hash.add(sha256);
  }
  return hash.hex();
}

Result<std::string> sha256_of(const fs::path& input) {
  std::error_code error;
  return fs::is_directory(input, error) ? sha256_of_folder(input) : io::sha256_of_file(input);
}

/// Hashes of the files that a plan names. A plan that is not valid names none; reading it fails
/// later, with a reason.
Result<std::string> sha256_of_plan_files(const fs::path& plan) {
  LEFORT_TRY(const std::string text, io::read_text(plan, kMaxPlanBytes));
  io::Sha256 hash;
  try {
    LEFORT_TRY(const std::vector<io::InputFile> files, io::fingerprints(text, plan));
    for (const io::InputFile& file : files) hash.add(file.name).add(file.sha256);
  } catch (const nlohmann::json::exception&) {  // Not a plan.
  }
  return hash.hex();
}

}  // namespace

std::vector<std::pair<std::string, fs::path>> CohortCase::inputs() const {
  std::vector<std::pair<std::string, fs::path>> found;
  const auto add = [&](const char* role, const OptionalPath& path) {
    if (path) found.emplace_back(role, *path);
  };
  add("before", before_scan);
  add("before_skin", before.skin);
  add("before_skull", before.skull);
  add("before_mandible", before.mandible);
  add("after", after_scan);
  add("after_skin", after.skin);
  add("after_skull", after.skull);
  add("after_mandible", after.mandible);
  add("plan", plan);
  add("landmarks", landmarks);
  return found;
}

bool is_bids_dataset(const fs::path& cohort) {
  const auto entries = entries_of(cohort);
  std::error_code error;
  return entries && std::any_of(entries->begin(), entries->end(), [&](const fs::path& entry) {
           return entry.filename().string().starts_with(kParticipant) &&
                  fs::is_directory(entry, error);
         });
}

Result<std::vector<fs::path>> list_cases(const fs::path& cohort) {
  std::error_code error;
  if (!fs::is_directory(cohort, error))
    return fail(ErrorCode::kFileNotFound,
                fmt::format("{} does not exist or is not the folder of a cohort", cohort.string()));
  LEFORT_TRY(const std::vector<fs::path> entries, entries_of(cohort));
  const std::string prefix = is_bids_dataset(cohort) ? kParticipant : "";
  std::vector<fs::path> folders;
  for (const fs::path& entry : entries) {
    const std::string name = entry.filename().string();
    if (fs::is_directory(entry, error) && !name.starts_with('.') && name.starts_with(prefix))
      folders.push_back(entry);
  }
  if (folders.empty())
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("{} has no case: it must contain one folder per case", cohort.string()));
  return folders;
}

Result<CohortCase> find_case(const fs::path& folder, AfterSurgery after) {
  CohortCase one;
  one.name = folder.filename().string();
  one.folder = folder;
  std::error_code error;
  const bool is_bids =
      one.name.starts_with(kParticipant) &&
      (fs::is_directory(folder / "ct", error) || fs::is_directory(folder / "ses-before", error));
  LEFORT_TRY(one, is_bids ? find_named_by_bids(one) : find_named_by_role(one));
  LEFORT_TRY_VOID(check_files(one, after));
  return one;
}

std::vector<fs::path> files_of_plan(const CohortCase& one) {
  std::vector<fs::path> files;
  if (!one.plan) return files;
  const Result<std::string> text = io::read_text(*one.plan, kMaxPlanBytes);
  if (!text) return files;
  try {
    for (const std::string& name : io::files_of_plan(*text)) {
      std::error_code error;
      const fs::path file = one.plan->parent_path() / name;
      if (fs::exists(file, error)) files.push_back(file);
    }
  } catch (const nlohmann::json::exception&) {  // Not a plan.
  }
  return files;
}

Result<std::string> fingerprint_case(const CohortCase& one) {
  io::Sha256 hash;
  for (const auto& [role, path] : one.inputs()) {
    LEFORT_TRY(const std::string sha256, sha256_of(path));
    hash.add(role).add(sha256);
  }
  if (one.plan) {
    LEFORT_TRY(const std::string of_plan, sha256_of_plan_files(*one.plan));
    hash.add(of_plan);
  }
  return hash.hex();
}

std::string without_paths(std::string message, const fs::path& cohort, const fs::path& output) {
  std::vector<std::string> prefixes;
  for (const fs::path& folder : {output, cohort}) {
    std::error_code error;
    for (const fs::path& form : {folder, fs::absolute(folder, error)}) {
      std::string prefix = form.lexically_normal().string();
      if (!prefix.ends_with('/')) prefix += '/';
      prefixes.push_back(std::move(prefix));
      prefixes.push_back(form.string() + "/");
    }
  }
  // Long prefixes first: one may be part of another.
  std::stable_sort(prefixes.begin(), prefixes.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  for (const std::string& prefix : prefixes)
    for (std::size_t at = 0; (at = message.find(prefix, at)) != std::string::npos;)
      message.erase(at, prefix.size());
  return message;
}

}  // namespace lefort::pipeline
