#include <lefort/io/earlier_check_files.h>
#include <lefort/io/output_folder.h>
#include <lefort/io/plan_inputs.h>
#include <lefort/io/predicted_poses.h>
#include <lefort/io/read_text.h>
#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>
#include <lefort/server/case/case_folder.h>
#include <lefort/server/case/measure_stages.h>
#include <lefort/server/case/variants.h>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <system_error>
#include <vector>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::size_t kEtagDigits = 16;
constexpr int kMaxDepth = 64;  // Of JSON in a case folder; those of the program have 12 levels.

json state(const char* name, std::string why, const std::optional<std::string>& etag) {
  return {{"state", name}, {"why", std::move(why)}, {"etag", etag ? json(*etag) : json()}};
}

const json& member(const json& object, const char* key) {
  static const json nothing;
  if (!object.is_object()) return nothing;
  const auto found = object.find(key);
  return found == object.end() ? nothing : *found;
}

/// The parts of a plan that decide how bones are cut.
json cutting_part(const json& plan) {
  json part{{"segmentation", member(plan, "segmentation")},
            {"landmarks", member(plan, "landmarks")},
            {"field", member(plan, "field")},
            {"segments", json::array()}};
  for (const json& segment : member(plan, "segments"))
    part["segments"].push_back({{"name", member(segment, "name")},
                                {"cut_from", member(segment, "cut_from")},
                                {"from", member(segment, "from")},  // Its deprecated name.
                                {"osteotomy", member(segment, "osteotomy")}});
  return part;
}

/// Why a check, a prediction or a band does not match the plan; empty if it matches.
std::string plan_mismatch(const json& inputs, const CaseFolder& folder) {
  const auto now = folder.fingerprint(folder.plan());
  if (!now) return "the plan was removed";
  const auto text = io::read_text(folder.plan(), kMaxDocument);
  if (!text || member(inputs, "plan_sha256") != io::Sha256().add(*text).hex())
    return "the plan changed after this was computed";
  for (const json& file : member(inputs, "plan_files")) {
    const json& name = member(file, "file");
    if (!name.is_string()) continue;
    const auto sha256 = folder.fingerprint(folder.root() / name.get<std::string>());
    if (!sha256 || member(file, "sha256") != *sha256)
      return fmt::format("{} changed after this was computed", name.get<std::string>());
  }
  return "";
}

/// Whether brackets outside of strings are open more than kMaxDepth deep.
bool is_deep(std::string_view text) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t at = 0; at < text.size() && depth <= kMaxDepth; ++at) {
    const char c = text[at];
    if (in_string && c == '\\') ++at;
    if (c == '"') in_string = !in_string;
    if (in_string) continue;
    if (c == '[' || c == '{') ++depth;
    if (c == ']' || c == '}') --depth;
  }
  return depth > kMaxDepth;
}

/// Removes files that a killed process was writing (io/write_atomically).
void remove_partial_files(const fs::path& root) {
  std::error_code error;
  std::vector<fs::path> partial;
  for (fs::recursive_directory_iterator entry(root, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->is_regular_file(error) &&
        entry->path().filename().string().starts_with(io::kPartialPrefix))
      partial.push_back(entry->path());
  for (const fs::path& file : partial) fs::remove(file, error);
}

const char* in_words(const std::string& input) {
  if (input == "ct") return "the scan was replaced after this was computed";
  if (input == "labels")
    return "the labels changed after the surfaces were made: make the surfaces again";
  if (input == "tissues") return "the labels changed after this was computed";
  if (input == "plan") return "the plan changed after this was computed";
  if (input == "landmarks") return "the landmarks changed after this was computed";
  if (input == "numbers") return "numbers of teeth were corrected after this was computed";
  if (input == "points") return "points on the canals were corrected after this was computed";
  if (input == "arches") return "the registered intraoral scans changed, or are out of date";
  if (input == "teeth") return "the numbers of the teeth changed, or are out of date";
  if (input == "occlusion") return "the occlusion changed, or is out of date";
  if (input == "check") return "the check of the plan changed, or is out of date";
  if (input == "nerve") return "the canals of the nerves changed after this was computed";
  if (input == "prediction") return "the prediction changed after this was computed";
  if (input.starts_with("variant ")) return "a variant was replaced after this was computed";
  if (input == "cut")
    return "the plan's cuts, landmarks or thresholds changed after this was computed";
  return "the plan's tissue or boundaries changed after this was computed";
}

/// Why results of `lefort uncertainty` do not match the case; empty if they match. Their document
/// names all of their inputs, because the command line may have written them.
std::string band_mismatch(const json& document, const CaseFolder& folder) {
  const json& made_of = member(document, "provenance");
  const json& scan = member(made_of, "ct_file_sha256");
  if (member(document, "lefort_uncertainty") != 1 || !scan.is_string() ||
      !member(made_of, "plan_files").is_array())
    return "the inputs of this band are not known: compute it with ct.nrrd of the case";
  if (scan != folder.fingerprint(folder.ct()).value_or("")) return in_words("ct");
  return plan_mismatch(made_of, folder);
}

}  // namespace

bool there_is(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

json parse_limited(std::string_view text) {
  return is_deep(text) ? json(json::value_t::discarded) : json::parse(text, nullptr, false);
}

json read_object(const fs::path& file) {
  const auto text = io::read_text(file, kMaxDocument);
  json object = text ? parse_limited(*text) : json();
  return object.is_object() ? object : json::object();
}

Result<CaseFolder> CaseFolder::open(const fs::path& folder) {
  std::error_code error;
  const bool is_new = !fs::exists(folder, error);
  LEFORT_TRY_VOID(io::make_output_folder(folder));
  if (is_new)
    fs::permissions(folder, fs::perms::owner_all, error);  // Patient data: for the owner alone.
  const fs::path root = fs::canonical(folder, error);
  if (error)
    return fail(ErrorCode::kFileUnwritable, fmt::format("case folder {} cannot be opened: {}",
                                                        folder.string(), error.message()));
  const int lock = ::open((root / "lock").c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
  if (lock < 0)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("case folder {} cannot be locked", folder.string()));
  if (::flock(lock, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock);
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("case folder {} is in use by another lefort serve", folder.string()));
  }
  CaseFolder opened(root, lock);
  // Left by a server that was killed.
  fs::remove_all(opened.uploads(), error);
  fs::remove_all(opened.import_folder(), error);
  fs::remove_all(opened.prepared_variant(), error);
  if (fs::exists(opened.imported(), error)) LEFORT_TRY_VOID(opened.finish_import());
  remove_partial_files(root);
  return opened;
}

CaseFolder::CaseFolder(fs::path root, int lock)
    : root_(std::move(root)), lock_(lock), mutex_(std::make_unique<std::mutex>()) {}

CaseFolder::CaseFolder(CaseFolder&& other) noexcept
    : root_(std::move(other.root_)),
      lock_(std::exchange(other.lock_, -1)),
      mutex_(std::move(other.mutex_)),
      known_(std::move(other.known_)) {}

CaseFolder::~CaseFolder() {
  if (lock_ < 0) return;
  std::error_code error;
  fs::remove_all(uploads(), error);  // The lock is still held.
  ::close(lock_);
}

std::optional<std::string> CaseFolder::fingerprint(const fs::path& file) const {
  struct stat found {};
  if (::stat(file.c_str(), &found) != 0 || !S_ISREG(found.st_mode)) return std::nullopt;
  const Identity identity{.device = found.st_dev,
                          .inode = found.st_ino,
                          .size = std::uintmax_t(found.st_size),
                          .modified_s = found.st_mtim.tv_sec,
                          .modified_ns = found.st_mtim.tv_nsec,
                          .changed_s = found.st_ctim.tv_sec,
                          .changed_ns = found.st_ctim.tv_nsec};
  {
    const std::scoped_lock lock(*mutex_);
    const auto known = known_.find(file);
    if (known != known_.end() && known->second.identity == identity) return known->second.sha256;
  }
  auto sha256 = io::sha256_of_file(file);  // Without the lock: a large file takes time.
  if (!sha256) return std::nullopt;
  const std::scoped_lock lock(*mutex_);
  known_[file] = {identity, *sha256};
  return *std::move(sha256);
}

std::optional<std::string> CaseFolder::etag(const fs::path& file) const {
  const auto sha256 = fingerprint(file);
  if (!sha256) return std::nullopt;
  return '"' + sha256->substr(0, kEtagDigits) + '"';
}

std::optional<CaseFolder::Inputs> CaseFolder::inputs_of(std::string_view stage) const {
  const auto ct_sha256 = fingerprint(ct());
  if (!ct_sha256) return std::nullopt;
  Inputs inputs{{"ct", *ct_sha256}};
  if (is_measure(stage)) {
    const auto others = inputs_of_measure(*this, stage);
    if (!others) return std::nullopt;
    inputs.insert(others->begin(), others->end());
    return inputs;
  }
  if (stage == "variants") return inputs_of_variants(*this);
  if (stage == "anatomy") {
    const auto labels_sha256 = fingerprint(labels());
    if (!labels_sha256) return std::nullopt;
    inputs["labels"] = *labels_sha256;
    return inputs;
  }
  if (stage == "comparison") {
    const auto prediction_sha256 = fingerprint(prediction() / "prediction.json");
    if (!prediction_sha256) return std::nullopt;
    inputs["prediction"] = *prediction_sha256;
    return inputs;
  }
  const auto text = io::read_text(plan(), kMaxDocument);
  if (!text) return std::nullopt;
  const json plan_json = parse_limited(*text);
  if (!check_files_of_plan(*text)) return std::nullopt;
  if (stage == "check" && this->stage("nerve")["state"] == "fresh")
    inputs["nerve"] = fingerprint(nerve() / "nerve.json").value_or("");
  if (const auto numbers = server::tooth_corrections(*this); stage == "check" && numbers)
    inputs["numbers"] = fingerprint(*numbers).value_or("");
  if (stage == "cut" || stage == "preview") {
    io::Sha256 sum;
    sum.add(cutting_part(plan_json).dump());
    for (const std::string& name : io::files_of_plan(*text))
      if (name != kBoundaryFile) sum.add(name).add(fingerprint(root_ / name).value_or(""));
    inputs["cut"] = sum.hex();
  }
  if (stage == "preview") {
    io::Sha256 sum;
    for (const char* part : {"tissue", "boundary", "contact", "solver"})
      sum.add(member(plan_json, part).dump());
    if (names_boundary(plan_json)) sum.add(fingerprint(boundary()).value_or(""));
    inputs["tissue"] = sum.hex();
  }
  return inputs;
}

Result<void> CaseFolder::record_inputs(std::string_view stage, const Inputs& inputs) {
  const std::scoped_lock lock(*mutex_);  // Requests and jobs record.
  json all = read_object(root_ / "stages.json");
  all[std::string(stage)] = inputs;
  return io::write_text(root_ / "stages.json", all.dump(1) + "\n");
}

Result<void> CaseFolder::record_scan(std::string_view stage) {
  const auto ct_sha256 = fingerprint(ct());
  return record_inputs(stage, ct_sha256 ? Inputs{{"ct", *ct_sha256}} : Inputs{});
}

bool CaseFolder::is_of_scan(std::string_view stage) const {
  const json recorded = read_object(root_ / "stages.json");
  const json& scan = member(member(recorded, std::string(stage).c_str()), "ct");
  return !scan.is_string() || scan == fingerprint(ct()).value_or("");
}

Result<void> CaseFolder::replace_scan(const fs::path& prepared) {
  const json recorded = read_object(root_ / "stages.json");
  const std::pair<const char*, fs::path> made_on_scan[] = {{"landmarks", landmarks()},
                                                           {"plan", plan()},
                                                           {"boundary", boundary()},
                                                           {"anatomy", labels()},
                                                           {kToothCorrections, tooth_corrections()},
                                                           {kNervePoints, nerve_points()}};
  for (const auto& [stage, file] : made_on_scan)  // Without a record: of the scan until now.
    if (there_is(file) && !member(member(recorded, stage), "ct").is_string())
      LEFORT_TRY_VOID(record_scan(stage));
  std::error_code error;
  fs::remove_all(imported(), error);
  fs::rename(prepared, imported(), error);  // From now on, the new scan is that of the case.
  if (error)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("the scan cannot be stored: {}", error.message()));
  return finish_import();
}

Result<void> CaseFolder::finish_import() const {
  std::error_code error, failure;
  for (const fs::path& file : {ct(), description()}) {
    const fs::path from = imported() / file.filename();
    if (!fs::exists(from, error)) continue;  // Moved before an interruption.
    fs::rename(from, file, error);
    if (error) failure = error;
  }
  if (failure)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("the scan cannot be stored: {}", failure.message()));
  fs::remove_all(imported(), error);
  return {};
}

json CaseFolder::describe() const {
  json found = read_object(description());
  const json& sha256 = member(found, "ct_sha256");
  if (sha256.is_string() && sha256 != fingerprint(ct()).value_or("")) return json::object();
  return found;
}

Result<void> CaseFolder::forget_result(std::string_view stage) const {
  std::vector<fs::path> documents;
  if (stage == "cut") documents = {cut() / "cut.json"};
  // A check replaces the files that check.json lists, and no others: they are removed with it.
  if (stage == "check")
    documents =
        io::earlier_check_files(check()).value_or(std::vector<fs::path>{check() / "check.json"});
  if (stage == "preview") documents = {preview() / "preview.json"};
  if (stage == "prediction")
    documents = {prediction() / "prediction.json", prediction() / "failure.json"};
  return io::remove_earlier_files(documents);
}

fs::path CaseFolder::document_of(std::string_view stage) const {
  if (stage == "scan") return ct();
  if (stage == "anatomy") return anatomy() / "skin.vtp";
  if (stage == "landmarks") return landmarks();
  if (stage == "plan") return plan();
  if (stage == "boundary") return boundary();
  if (stage == "cut") return cut() / "cut.json";
  if (stage == "check") return check() / "check.json";
  if (stage == "preview") return preview() / "preview.json";
  if (stage == "uncertainty") return uncertainty() / "uncertainty.json";
  if (stage == "comparison") return comparison() / "compare.json";
  if (stage == "variants") return side_by_side() / "variants.json";
  if (is_measure(stage)) return document_of_measure(*this, stage);
  const fs::path failure = prediction() / "failure.json";
  return there_is(failure) ? failure : prediction() / "prediction.json";
}

json CaseFolder::stage(std::string_view stage) const {
  constexpr const char* kNothing = "does not exist yet";
  const fs::path document = document_of(stage);
  if (!there_is(document)) return state("missing", kNothing, std::nullopt);
  const auto tag = etag(document);
  if (stage == "scan") return state("fresh", "", tag);
  if (stage == "uncertainty") {
    std::string why = band_mismatch(read_object(document), *this);
    return why.empty() ? state("fresh", "", tag) : state("stale", std::move(why), tag);
  }

  const json recorded_inputs = read_object(root_ / "stages.json");
  if (stage == "landmarks" || stage == "plan" || stage == "boundary") {
    const json& scan = member(member(recorded_inputs, std::string(stage).c_str()), "ct");
    if (scan.is_string() && scan != fingerprint(ct()).value_or(""))
      return state("stale", "made on another scan: check each against this one and save it", tag);
    return state("fresh", "", tag);
  }
  if (const json& then = member(recorded_inputs, std::string(stage).c_str()); then.is_object()) {
    const auto now = inputs_of(stage);
    if (!now) return state("stale", "an input of this result was removed", tag);
    for (const auto& [input, sha256] : *now)
      if (member(then, input.c_str()) != sha256) return state("stale", in_words(input), tag);
  } else if (stage != "check" && stage != "prediction") {
    return state("stale", "the inputs of this result are not known", tag);
  }
  if (stage == "prediction")
    if (const auto current = io::check_prediction_version(read_object(document)); !current)
      return state("stale", current.error().message, tag);
  if (stage == "check" || stage == "prediction") {
    const std::string why = plan_mismatch(member(read_object(document), "inputs"), *this);
    if (!why.empty()) return state("stale", why, tag);
    if (document.filename() == "failure.json")
      return state("unconverged", "the solver found no equilibrium along the path", tag);
  }
  return state("fresh", "", tag);
}

bool names_boundary(const json& plan) {
  return member(member(plan, "boundary"), "labels") == kBoundaryFile;
}

bool names_canals(const std::string& text) {
  const std::vector<std::string> names = io::files_of_plan(text);
  return std::find(names.begin(), names.end(), kNerveFile) != names.end();
}

Result<void> check_files_of_plan(const std::string& text) {
  json plan = parse_limited(text);
  if (!plan.is_object() || !member(plan, "segments").is_array())
    return fail(ErrorCode::kPlanInvalid, "the plan is not a JSON object with segments");
  for (const json& segment : plan["segments"])
    if (!segment.is_object())
      return fail(ErrorCode::kPlanInvalid, "segments: an entry is not an object");
  if (const json& labels = member(member(plan, "boundary"), "labels"); labels.is_string()) {
    if (!names_boundary(plan))
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("boundary.labels: in a case it is {}", kBoundaryFile));
    plan["boundary"].erase("labels");
  }
  std::vector<std::string> names;
  try {
    names = io::files_of_plan(plan.dump());
  } catch (const json::exception&) {
    return fail(ErrorCode::kPlanInvalid, "the plan does not match its schema");
  }
  if (const json& ct = member(plan, "ct"); ct.is_string() && ct != "ct.nrrd")
    return fail(ErrorCode::kPlanInvalid, "ct: in a case it is ct.nrrd");
  for (const std::string& name : names)
    if (name != "landmarks.mrk.json" && name != "anatomy/labels.seg.nrrd" && name != kNerveFile)
      return fail(ErrorCode::kPlanInvalid,
                  fmt::format("the plan names the file {}; in a case it may name ct.nrrd, "
                              "landmarks.mrk.json, anatomy/labels.seg.nrrd, {} and {} as "
                              "boundary.labels",
                              name, kNerveFile, kBoundaryFile));
  return {};
}

}  // namespace lefort::server
