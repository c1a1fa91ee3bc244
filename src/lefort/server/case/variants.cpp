#include <lefort/io/earlier_check_files.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>
#include <lefort/pipeline/plan.h>
#include <lefort/pipeline/predict/write_prediction.h>
#include <lefort/pipeline/variants.h>
#include <lefort/server/case/file_catalog.h>
#include <lefort/server/case/job_parts.h>
#include <lefort/server/case/variants.h>

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kVariantVersion = 1;
constexpr const char *kVariantDocument = "variant.json", *kCheckDocument = "check/check.json",
                     *kPredictionDocument = "prediction/prediction.json";

/// Why a name cannot be used.
constexpr const char* kNameRule =
    "the name of a variant has 1 to 40 letters, digits, - and _, and no others";

fs::path all_variants(const CaseFolder& folder) { return folder.root() / "variants"; }

Error unwritable(const std::error_code& error) {
  return {ErrorCode::kFileUnwritable,
          fmt::format("the files of a variant cannot be stored: {}", error.message())};
}

/// Results are linked if the file system has links: they are replaced, not changed, so that a link
/// keeps its content. What the user may edit in place is copied: the files of the case itself.
Result<void> link_or_copy(const fs::path& from, const fs::path& to, bool is_result) {
  std::error_code error;
  fs::create_directories(to.parent_path(), error);
  if (!error && is_result) fs::create_hard_link(from, to, error);
  if (!error && !is_result) fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) fs::copy_file(from, to, fs::copy_options::overwrite_existing, error);
  if (error) return tl::unexpected(unwritable(error));
  return {};
}

/// Files of a folder and its subfolders, relative to `root`, except the cache and unfinished files.
std::vector<std::string> files_below(const fs::path& folder, const fs::path& root) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code unreadable;
    const std::string name = entry->path().filename().string();
    if (entry->is_directory(unreadable) && (name == "cache" || name.starts_with(".")))
      entry.disable_recursion_pending();
    else if (entry->is_regular_file(unreadable) && !name.starts_with("."))
      names.push_back(entry->path().lexically_relative(root).string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Moves a document to the end: its existence shows that the others are there.
void put_last(std::vector<std::string>& names, const std::string& document) {
  std::stable_partition(names.begin(), names.end(),
                        [&](const std::string& name) { return name != document; });
}

/// Plan, landmarks and painted boundary, as far as the plan names them. Labels belong to the scan.
Result<std::vector<std::string>> files_of_planning(const CaseFolder& folder) {
  const auto text = io::read_text(folder.plan(), kMaxDocument);
  if (!text) return fail(ErrorCode::kInvalidArgument, "the case has no plan to keep");
  LEFORT_TRY_VOID(check_files_of_plan(*text));
  std::vector<std::string> names{folder.plan().filename()};
  for (const fs::path& file : {folder.landmarks(), folder.boundary()})
    for (const std::string& named : io::files_of_plan(*text))
      if (named == file.filename()) names.push_back(named);
  return names;
}

std::vector<std::string> segments_of(const json& check) {
  std::vector<std::string> names;
  if (const auto segments = check.find("segments"); segments != check.end())
    for (const json& one : *segments)
      if (one.is_object() && one.contains("name") && one["name"].is_string() &&
          is_segment_name(one["name"].get<std::string>()))
        names.push_back(one["name"]);
  return names;
}

/// Stops with one sentence if the check or the name cannot be kept.
Result<void> check_can_keep(const CaseFolder& folder, const std::string& name) {
  if (!is_variant_name(name)) return fail(ErrorCode::kInvalidArgument, kNameRule);
  std::error_code error;
  if (fs::exists(variant_folder(folder, name), error))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the case has a variant {}: choose another name, or delete it first", name));
  if (list_variants(folder)["variants"].size() >= kMaxKeptVariants)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("a case has at most {} variants: delete one first", kMaxKeptVariants));
  const json check = folder.stage("check");
  if (check["state"] == "missing")
    return fail(ErrorCode::kInvalidArgument, "the plan is not checked: check it first");
  if (check["state"] != "fresh")
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("the check is out of date ({}): check the plan first",
                            check["why"].get<std::string>()));
  return {};
}

/// Copies everything that a variant has, and its document, into a folder.
Result<void> store_variant(const CaseFolder& folder, const fs::path& into) {
  LEFORT_TRY(std::vector<std::string> files, files_of_planning(folder));
  LEFORT_TRY(const std::vector<fs::path> check, io::earlier_check_files(folder.check()));
  for (const fs::path& file : check)
    if (there_is(file)) files.push_back(file.lexically_relative(folder.root()).string());
  const bool has_prediction = folder.stage("prediction")["state"] == "fresh";
  if (has_prediction)
    for (std::string& name : files_below(folder.prediction(), folder.root()))
      files.push_back(std::move(name));
  for (const std::string& name : files)
    LEFORT_TRY_VOID(
        link_or_copy(folder.root() / name, into / name, fs::path(name).has_parent_path()));
  json inputs = json::object();
  for (const char* stage : {"check", "prediction"})
    if (const auto now = folder.inputs_of(stage)) inputs[stage] = *now;
  const json found = read_object(folder.check() / "check.json");
  const json findings = found.value("findings", json::array());
  const json document{{"lefort_variant", kVariantVersion},
                      {"kept", utc_now()},
                      {"ct_sha256", folder.fingerprint(folder.ct()).value_or("")},
                      {"segments", segments_of(found)},
                      {"findings", findings.size()},
                      {"has_prediction", has_prediction},
                      {"inputs", std::move(inputs)}};
  return io::write_text(into / kVariantDocument, document.dump(1) + "\n");
}

/// The document of a variant; nothing if it is damaged.
std::optional<json> document_of_variant(const CaseFolder& folder, const std::string& name) {
  json found = read_object(variant_folder(folder, name) / kVariantDocument);
  const auto is = [&](const char* key, json::value_t type) {
    const auto at = found.find(key);
    return at != found.end() && at->type() == type;
  };
  using Type = json::value_t;
  if (found.value("lefort_variant", json()) != kVariantVersion || !is("kept", Type::string) ||
      !is("ct_sha256", Type::string) || !is("segments", Type::array) ||
      !is("has_prediction", Type::boolean) || !is("inputs", Type::object) ||
      !is("findings", Type::number_unsigned))
    return std::nullopt;
  for (const json& segment : found["segments"])
    if (!segment.is_string() || !is_segment_name(segment.get<std::string>())) return std::nullopt;
  return found;
}

/// Whether plan, landmarks and painted boundary of the case are those of a variant.
bool is_present_plan(const CaseFolder& folder, const std::string& name) {
  const fs::path stored = variant_folder(folder, name);
  if (!folder.fingerprint(folder.plan())) return false;
  for (const fs::path& file : {folder.plan(), folder.landmarks(), folder.boundary()})
    if (const auto kept = folder.fingerprint(stored / file.filename());
        kept ? kept != folder.fingerprint(file) : file == folder.plan())
      return false;
  return true;
}

json describe_variant(const CaseFolder& folder, const std::string& name) {
  const auto document = document_of_variant(folder, name);
  if (!document)
    return {{"name", name},
            {"kept", ""},
            {"segments", json::array()},
            {"findings", 0},
            {"has_prediction", false},
            {"is_current", false},
            {"why", "it is damaged, or of another version of lefort"}};
  const bool is_of_scan = (*document)["ct_sha256"] == folder.fingerprint(folder.ct()).value_or("");
  return {{"name", name},
          {"kept", (*document)["kept"]},
          {"segments", (*document)["segments"]},
          {"findings", (*document)["findings"]},
          {"has_prediction", (*document)["has_prediction"]},
          {"is_current", is_of_scan && is_present_plan(folder, name)},
          {"why", is_of_scan ? "" : "it was made on another scan"}};
}

/// Moves files of a prepared folder to their places in the case.
Result<void> move_files(const CaseFolder& folder, const fs::path& prepared,
                        const std::vector<std::string>& names) {
  std::error_code error;
  for (const std::string& name : names) {
    const fs::path to = folder.root() / name;
    fs::create_directories(to.parent_path(), error);
    fs::rename(prepared / name, to, error);
    if (error) return tl::unexpected(unwritable(error));
  }
  return {};
}

/// Replaces the results of a stage by those of a variant, and what is recorded of their inputs.
Result<void> restore_results(CaseFolder& folder, const fs::path& prepared, const json& document,
                             const char* stage) {
  std::vector<std::string> files = files_below(prepared / stage, prepared);
  put_last(files, std::string_view(stage) == "check" ? kCheckDocument : kPredictionDocument);
  if (const auto inputs = document["inputs"].find(stage); inputs != document["inputs"].end()) {
    CaseFolder::Inputs recorded;
    for (const auto& [input, sha256] : inputs->items())
      if (sha256.is_string()) recorded[input] = sha256.get<std::string>();
    LEFORT_TRY_VOID(folder.record_inputs(stage, recorded));
  }
  return move_files(folder, prepared, files);
}

/// \param prepared  a copy of the variant, whose files are moved.
Result<void> restore_variant(CaseFolder& folder, const fs::path& prepared, const json& document) {
  LEFORT_TRY_VOID(folder.forget_result("check"));
  const bool has_prediction = there_is(prepared / kPredictionDocument);
  if (has_prediction) LEFORT_TRY_VOID(pipeline::remove_results(folder.prediction()));
  for (const auto& [file, stage] : {std::pair{folder.landmarks(), "landmarks"},
                                    {folder.boundary(), "boundary"},
                                    {folder.plan(), "plan"}}) {
    if (!there_is(prepared / file.filename())) continue;
    LEFORT_TRY_VOID(move_files(folder, prepared, {file.filename().string()}));
    LEFORT_TRY_VOID(folder.record_scan(stage));
  }
  // An earlier version of a check is not that of this plan: it is checked again.
  const json check = read_object(prepared / kCheckDocument);
  if (check.value("lefort_plan_check", json()) == pipeline::kPlanCheckVersion)
    LEFORT_TRY_VOID(restore_results(folder, prepared, document, "check"));
  if (has_prediction) return restore_results(folder, prepared, document, "prediction");
  return {};
}

}  // namespace

bool is_variant_name(std::string_view name) { return is_segment_name(name); }

fs::path variant_folder(const CaseFolder& folder, std::string_view name) {
  return all_variants(folder) / name;
}

fs::path face_of_variant(const CaseFolder& folder, std::string_view name) {
  return variant_folder(folder, name) / "prediction/predicted_skin.vtp";
}

json list_variants(const CaseFolder& folder) {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(all_variants(folder), error), end; !error && entry != end;
       entry.increment(error)) {
    std::error_code unreadable;
    const std::string name = entry->path().filename().string();
    if (entry->is_directory(unreadable) && is_variant_name(name)) names.push_back(name);
  }
  std::sort(names.begin(), names.end());
  json list = json::array();
  for (const std::string& name : names) list.push_back(describe_variant(folder, name));
  return {{"variants", list}, {"max_variants", kMaxKeptVariants}};
}

Result<void> keep_variant(const CaseFolder& folder, const std::string& name) {
  LEFORT_TRY_VOID(check_can_keep(folder, name));
  const fs::path prepared = folder.prepared_variant();
  std::error_code error;
  fs::remove_all(prepared, error);
  if (auto stored = store_variant(folder, prepared); !stored) {
    fs::remove_all(prepared, error);
    return stored;
  }
  fs::create_directories(all_variants(folder), error);
  fs::rename(prepared, variant_folder(folder, name), error);
  if (error) return tl::unexpected(unwritable(error));
  return {};
}

Result<void> load_variant(CaseFolder& folder, const std::string& name) {
  std::error_code error;
  const fs::path stored = is_variant_name(name) ? variant_folder(folder, name) : fs::path();
  if (stored.empty() || !fs::is_directory(stored, error))
    return fail(ErrorCode::kFileNotFound, "no variant of that name");
  const auto document = document_of_variant(folder, name);
  const auto plan = io::read_text(stored / folder.plan().filename(), kMaxDocument);
  if (!document || !plan || !check_files_of_plan(*plan))
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the variant {} is damaged, or of another version of lefort", name));
  if ((*document)["ct_sha256"] != folder.fingerprint(folder.ct()).value_or(""))
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("the variant {} was made on another scan: import that scan to load it", name));
  const fs::path prepared = folder.prepared_variant();
  fs::remove_all(prepared, error);
  auto restored = [&]() -> Result<void> {
    for (const std::string& file : files_below(stored, stored))
      LEFORT_TRY_VOID(
          link_or_copy(stored / file, prepared / file, fs::path(file).has_parent_path()));
    return restore_variant(folder, prepared, *document);
  }();
  fs::remove_all(prepared, error);
  return restored;
}

Result<void> delete_variant(const CaseFolder& folder, const std::string& name) {
  std::error_code error;
  if (!is_variant_name(name) || !fs::is_directory(variant_folder(folder, name), error))
    return fail(ErrorCode::kFileNotFound, "no variant of that name");
  fs::remove_all(folder.prepared_variant(), error);
  fs::rename(variant_folder(folder, name), folder.prepared_variant(), error);  // All or nothing.
  if (error) return tl::unexpected(unwritable(error));
  fs::remove_all(folder.prepared_variant(), error);
  return {};
}

std::optional<CaseFolder::Inputs> inputs_of_variants(const CaseFolder& folder) {
  const json document = read_object(folder.side_by_side() / "variants.json");
  const auto names = document.find("variants");
  if (names == document.end() || !names->is_array()) return std::nullopt;
  CaseFolder::Inputs inputs;
  for (const json& one : *names) {
    if (!one.is_string() || !is_variant_name(one.get<std::string>())) return std::nullopt;
    const std::string name = one.get<std::string>();
    const auto kept = folder.fingerprint(variant_folder(folder, name) / kVariantDocument);
    if (!kept) return std::nullopt;
    inputs["variant " + name] = *kept;
  }
  return inputs;
}

Result<JobOutcome> variants_job(const JobContext& context, const JobRecord& job,
                                Progress& progress) {
  CaseFolder& folder = context.folder;
  pipeline::VariantsJob variants;
  for (const json& one : job.parameters.value("names", json::array())) {
    const std::string name = one.is_string() ? one.get<std::string>() : std::string();
    if (!is_variant_name(name) || !there_is(variant_folder(folder, name) / kCheckDocument))
      return fail(ErrorCode::kFileNotFound, fmt::format("the case has no variant {}", name));
    const fs::path of_variant = variant_folder(folder, name);
    if (std::find(variants.folders.begin(), variants.folders.end(), of_variant) !=
        variants.folders.end())
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("the variant {} is named twice: name each once", name));
    const json described = describe_variant(folder, name);
    if (!described["why"].get<std::string>().empty())
      progress.note(
          fmt::format("warning: variant {}: {}", name, described["why"].get<std::string>()));
    if (described["has_prediction"] == false)
      progress.note(fmt::format("warning: variant {} has no predicted face", name));
    variants.folders.push_back(of_variant);
  }
  variants.output = folder.side_by_side();
  LEFORT_TRY(const pipeline::Summary summary, pipeline::compare_variants(variants, progress));
  if (const auto inputs = folder.inputs_of("variants"))
    LEFORT_TRY_VOID(folder.record_inputs("variants", *inputs));
  return JobOutcome{summary.text};
}

}  // namespace lefort::server
