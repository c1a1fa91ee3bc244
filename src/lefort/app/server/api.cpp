#include <lefort/app/cephalometric_table.h>
#include <lefort/app/preview_file.h>
#include <lefort/app/server/api.h>
#include <lefort/app/server/contract.h>
#include <lefort/app/server/surface_bytes.h>
#include <lefort/core/check.h>
#include <lefort/core/version.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/plan_file.h>
#include <lefort/io/segmentation_file.h>
#include <lefort/io/surface_files.h>
#include <lefort/io/write_atomically.h>
#include <lefort/plan/bone_path.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

namespace lefort::app::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uint64_t kLargestBody = 4 << 20;         // Bytes of JSON, as the contract says.
constexpr std::uintmax_t kLargestDocument = 256 << 20;  // Bytes of a file of ours.
constexpr const char* kPreviewNote = "preview, not a prediction";
constexpr int kMostEvery = 16;
constexpr std::size_t kKeptSurfaces = 24;  // All there are: five, and those of 16 segments.

/// A file that pages may have as it is.
struct NamedFile {
  std::string_view name;
  const char* stage;
  fs::path (*path)(const CaseFolder&);
};

#define LEFORT_IN(folder, file) [](const CaseFolder& c) -> fs::path { return c.folder() / (file); }
const NamedFile kFiles[] = {
    {"ct.nrrd", "scan", [](const CaseFolder& c) { return c.ct(); }},
    {"labels.seg.nrrd", "anatomy", [](const CaseFolder& c) { return c.labels(); }},
    {"skull.vtp", "anatomy", LEFORT_IN(anatomy, "skull.vtp")},
    {"skin.vtp", "anatomy", LEFORT_IN(anatomy, "skin.vtp")},
    {"landmarks.mrk.json", "landmarks", [](const CaseFolder& c) { return c.landmarks(); }},
    {"plan.json", "plan", [](const CaseFolder& c) { return c.plan(); }},
    {"check.json", "check", LEFORT_IN(check, "check.json")},
    {"cephalometry.csv", "check", LEFORT_IN(check, "cephalometry.csv")},
    {"landmarks_after.mrk.json", "check", LEFORT_IN(check, "landmarks_after.mrk.json")},
    {"landmarks_after.csv", "check", LEFORT_IN(check, "landmarks_after.csv")},
    {"report.html", "prediction", LEFORT_IN(prediction, "report.html")},
    {"prediction.json", "prediction", LEFORT_IN(prediction, "prediction.json")},
    {"failure.json", "prediction", LEFORT_IN(prediction, "failure.json")},
    {"predicted_skin.vtp", "prediction", LEFORT_IN(prediction, "predicted_skin.vtp")},
    {"predicted_skin.stl", "prediction", LEFORT_IN(prediction, "predicted_skin.stl")},
    {"skin_before.vtp", "prediction", LEFORT_IN(prediction, "skin_before.vtp")},
    {"bone_remainder.vtp", "prediction", LEFORT_IN(prediction, "bone_remainder.vtp")},
    {"bone_segment_moved.vtp", "prediction", LEFORT_IN(prediction, "bone_segment_moved.vtp")},
    {"bone_overlap.vtp", "prediction", LEFORT_IN(prediction, "bone_overlap.vtp")},
    {"compare.json", "comparison", LEFORT_IN(comparison, "compare.json")},
    {"regions.csv", "comparison", LEFORT_IN(comparison, "regions.csv")},
    {"landmark_shifts.csv", "comparison", LEFORT_IN(comparison, "landmark_shifts.csv")},
    {"difference.vtp", "comparison", LEFORT_IN(comparison, "difference.vtp")}};

const NamedFile kSurfaces[] = {
    {"skin", "anatomy", LEFORT_IN(anatomy, "skin.vtp")},
    {"skull", "anatomy", LEFORT_IN(anatomy, "skull.vtp")},
    {"remainder", "cut", LEFORT_IN(cut, "remainder.vtp")},
    {"skin_before", "prediction", LEFORT_IN(prediction, "skin_before.vtp")},
    {"predicted", "prediction", LEFORT_IN(prediction, "predicted_skin.vtp")}};
#undef LEFORT_IN

bool there_is(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

Reply empty_reply() {
  Reply reply;
  reply.status = 204;
  return reply;
}

Reply with_etag(Reply reply, const std::optional<std::string>& etag) {
  if (etag) reply.headers.emplace_back("ETag", *etag);
  return reply;
}

/// Whether the client has it already.
bool is_known(const Request& request, const std::optional<std::string>& etag) {
  return etag && request.header_or_empty("if-none-match") == *etag;
}

Reply not_modified(const std::optional<std::string>& etag) {
  Reply reply;
  reply.status = 304;
  return with_etag(std::move(reply), etag);
}

Reply not_there(std::string_view what) {
  return refusal(404, "not_found", fmt::format("{}", what));
}

/// A whole number in decimal digits within bounds.
std::optional<int> number_of(std::string_view text, int lowest, int highest) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size() || number < lowest ||
      number > highest)
    return std::nullopt;
  return number;
}

/// A query's whole number, or `otherwise` if it is not there.
Result<int> query_number(const Request& request, const std::string& name, int otherwise, int lowest,
                         int highest) {
  const auto found = request.query.find(name);
  if (found == request.query.end()) return otherwise;
  if (const auto number = number_of(found->second, lowest, highest)) return *number;
  return fail(ErrorCode::kInvalidArgument,
              fmt::format("{} must be a whole number from {} to {}", name, lowest, highest));
}

/// Whether a page may name a segment so: as in contract/plan.schema.json.
bool is_segment_name(std::string_view name) {
  return !name.empty() && name.size() <= 40 &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) {
           return (c >= '0' && c <= '9') || (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') ||
                  c == '_' || c == '-';
         });
}

struct Body {
  std::optional<std::string> text;
  Reply refused;
};

Body read_body(const Request& request, std::uint64_t most_bytes, std::string_view type) {
  const std::string& sent = request.header_or_empty("content-type");
  if (sent.substr(0, sent.find(';')) != type)
    return {std::nullopt,
            refusal(415, "wrong_type", fmt::format("the body must be {}", type), "Content-Type")};
  if (request.content_length > most_bytes)
    return {std::nullopt, refusal(413, "too_large",
                                  fmt::format("the body must have at most {} bytes", most_bytes))};
  std::string text;
  const bool is_whole = request.read_body && request.read_body([&](std::string_view piece) {
    if (text.size() + piece.size() > request.content_length) return false;
    text += piece;
    return true;
  });
  if (!is_whole || text.size() != request.content_length)
    return {std::nullopt, refusal(400, "bad_request", "the body did not arrive whole")};
  return {std::move(text), {}};
}

struct JsonBody {
  std::optional<json> value;
  std::string text;
  Reply refused;
};

JsonBody read_json(const Request& request, const std::string& schema) {
  Body body = read_body(request, kLargestBody, "application/json");
  if (!body.text) return {std::nullopt, {}, std::move(body.refused)};
  auto value = parse_by_contract(*body.text, schema);
  if (!value) return {std::nullopt, {}, refusal(value.error(), "body")};
  return {*std::move(value), *std::move(body.text), {}};
}

/// Nothing if the client knows what it replaces; else why it is refused.
std::optional<Reply> check_precondition(const Request& request,
                                        const std::optional<std::string>& etag) {
  const std::string& sent = request.header_or_empty("if-match");
  if (sent.empty())
    return refusal(428, "no_precondition", "If-Match must say what this replaces", "If-Match");
  if (sent == "*" || sent == etag) return std::nullopt;
  return with_etag(
      refusal(412, "stale", "another page has changed this since: fetch it again", "If-Match"),
      etag);
}

plan::Landmarks as_landmarks(const json& points) {
  plan::Landmarks landmarks;
  for (const auto& [name, point] : points.items())
    landmarks.push_back({name, Vec3(point[0], point[1], point[2])});
  return landmarks;
}

json as_points(const plan::Landmarks& landmarks) {
  json points = json::object();
  for (const plan::Landmark& landmark : landmarks)
    points[landmark.name] = {landmark.point_L.x(), landmark.point_L.y(), landmark.point_L.z()};
  return points;
}

json as_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

json as_json(const RigidTransform& pose) {
  json numbers = json::array();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
  return numbers;
}

/// Poses of a body that fits the contract; or why they are none.
Result<Poses> as_poses(const json& poses) {
  constexpr double kRigid = 1e-5;  // Pages send what they multiplied in single precision.
  Poses result;
  for (const auto& [name, numbers] : poses.items()) {
    Eigen::Matrix4d matrix;
    for (int k = 0; k < 16; ++k) matrix(k / 4, k % 4) = numbers[std::size_t(k)].get<double>();
    const Mat3 turn = matrix.topLeftCorner<3, 3>();
    const bool is_rigid = matrix.allFinite() &&
                          (turn.transpose() * turn - Mat3::Identity()).norm() < kRigid &&
                          turn.determinant() > 0.0 &&
                          (matrix.row(3) - Eigen::RowVector4d(0, 0, 0, 1)).norm() < kRigid &&
                          matrix.topRightCorner<3, 1>().norm() < 1e5;
    if (!is_rigid)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("poses.{} is no rigid motion: rows of a 4 by 4 matrix, translation "
                              "in the last column",
                              name));
    RigidTransform pose = RigidTransform::Identity();
    pose.linear() = turn;
    pose.translation() = matrix.topRightCorner<3, 1>();
    result.emplace(name, pose);
  }
  return result;
}

/// Each n-th voxel along each axis.
template <class Value>
std::string every_nth(const image::Grid& grid, const std::vector<Value>& values, Index every) {
  std::string bytes;
  for (Index k = 0; k < grid.size[2]; k += every)
    for (Index j = 0; j < grid.size[1]; j += every)
      for (Index i = 0; i < grid.size[0]; i += every)
        bytes.append(reinterpret_cast<const char*>(&values[std::size_t(grid.offset(i, j, k))]),
                     sizeof(Value));
  return bytes;
}

template <class Value>
Reply voxels_reply(const std::shared_ptr<const image::Volume<Value>>& volume, int every) {
  Reply reply = every == 1
                    ? binary_reply({volume,
                                    {reinterpret_cast<const char*>(volume->values.data()),
                                     volume->values.size() * sizeof(Value)}})
                    : binary_reply(shared_bytes(every_nth(volume->grid, volume->values, every)));
  const auto sent = [&](std::size_t axis) { return (volume->grid.size[axis] + every - 1) / every; };
  reply.headers.emplace_back("X-Lefort-Size", fmt::format("{},{},{}", sent(0), sent(1), sent(2)));
  return reply;
}

const NamedFile* find_named(std::span<const NamedFile> files, std::string_view name) {
  const auto found =
      std::find_if(files.begin(), files.end(), [&](const auto& file) { return file.name == name; });
  return found == files.end() ? nullptr : &*found;
}

json read_object(const fs::path& file) {
  const auto text = io::read_text(file, kLargestDocument);
  json object = text ? json::parse(*text, nullptr, false) : json();
  return object.is_object() ? object : json::object();
}

/// The parts of a path, between slashes.
std::vector<std::string_view> parts_of(std::string_view path) {
  std::vector<std::string_view> parts;
  while (!path.empty()) {
    path.remove_prefix(1);  // The slash.
    const std::size_t end = std::min(path.find('/'), path.size());
    parts.push_back(path.substr(0, end));
    path.remove_prefix(end);
  }
  return parts;
}

/// Values of the parameters if the path fits the pattern.
std::optional<PathValues> match(std::string_view pattern, std::string_view path) {
  const auto wanted = parts_of(pattern), given = parts_of(path);
  if (wanted.size() != given.size()) return std::nullopt;
  PathValues values;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (wanted[k].starts_with('{'))
      values.emplace_back(given[k]);
    else if (wanted[k] != given[k])
      return std::nullopt;
  }
  return values;
}

}  // namespace

struct Api::Route {
  RouteName name;
  Reply (Api::*handle)(const Request&, const PathValues&);
};

std::span<const Api::Route> Api::table() {
  static const Route kRoutes[] = {
      {{"GET", "/case"}, &Api::get_case},
      {{"POST", "/uploads"}, &Api::post_upload},
      {{"PUT", "/uploads/{upload}/files/{index}"}, &Api::put_upload_file},
      {{"DELETE", "/uploads/{upload}"}, &Api::delete_upload},
      {{"GET", "/jobs"}, &Api::get_jobs},
      {{"POST", "/jobs"}, &Api::post_job},
      {{"GET", "/jobs/{job}"}, &Api::get_job},
      {{"DELETE", "/jobs/{job}"}, &Api::delete_job},
      {{"GET", "/events"}, &Api::get_events},
      {{"GET", "/volume"}, &Api::get_volume},
      {{"GET", "/volume/data"}, &Api::get_volume_data},
      {{"GET", "/labels"}, &Api::get_labels},
      {{"GET", "/labels/data"}, &Api::get_labels_data},
      {{"PUT", "/labels/data"}, &Api::put_labels_data},
      {{"GET", "/surfaces"}, &Api::get_surfaces},
      {{"GET", "/surfaces/{surface}"}, &Api::get_surface},
      {{"GET", "/surfaces/segments/{segment}"}, &Api::get_segment_surface},
      {{"GET", "/landmarks"}, &Api::get_landmarks},
      {{"PUT", "/landmarks"}, &Api::put_landmarks},
      {{"POST", "/measurements"}, &Api::post_measurements},
      {{"GET", "/plan"}, &Api::get_plan},
      {{"PUT", "/plan"}, &Api::put_plan},
      {{"GET", "/plan/poses"}, &Api::get_plan_poses},
      {{"POST", "/osteotomies"}, &Api::post_osteotomy},
      {{"POST", "/poses"}, &Api::post_poses},
      {{"POST", "/preview"}, &Api::post_preview},
      {{"GET", "/preview/distance"}, &Api::get_preview_distance},
      {{"GET", "/prediction"}, &Api::get_prediction},
      {{"GET", "/prediction/steps/{step}"}, &Api::get_prediction_step},
      {{"GET", "/files"}, &Api::get_files},
      {{"GET", "/files/{file}"}, &Api::get_file}};
  return kRoutes;
}

std::vector<Api::RouteName> Api::routes() {
  std::vector<RouteName> names;
  for (const Route& route : table()) names.push_back(route.name);
  return names;
}

Api::Api(CaseFolder folder, std::optional<fs::path> example, UploadLimits upload_limits)
    : folder_(std::move(folder)),
      uploads_(folder_.uploads(), upload_limits),
      example_(std::move(example)),
      events_(random_hex(8)),
      volume_(1),
      bones_(1),
      preview_(1),
      steps_(1),
      surfaces_(kKeptSurfaces),
      jobs_(
          folder_.jobs(), events_,
          [this](const JobRecord& job, Progress& progress) {
            auto outcome = run_job({folder_, uploads_, events_, example_}, job, progress);
            if (outcome && job.kind == "preview-factor") warm_preview();
            return outcome;
          },
          [this] { tell_stages(); }) {}

Api::~Api() { stop(); }

void Api::stop() {
  events_.stop();
  jobs_.stop();
}

Result<void> Api::begin_with_example() {
  if (there_is(folder_.ct())) return {};
  if (!example_)
    return fail(ErrorCode::kFileNotFound,
                "the example's scan is not there: install Debian's invesalius-examples, or name "
                "it with --example");
  LEFORT_TRY_VOID(jobs_.submit("import", {{"example", true}}));
  LEFORT_TRY_VOID(jobs_.submit("segment", json::object()));
  return {};
}

Reply Api::handle(const Request& request) {
  LEFORT_CHECK(request.path.starts_with(kApiPrefix));
  const std::string_view path = std::string_view(request.path).substr(kApiPrefix.size());
  bool is_other_method = false;
  for (const Route& route : table()) {
    const auto values = match(route.name.path, path);
    if (!values) continue;
    if (route.name.method == request.method) return (this->*route.handle)(request, *values);
    is_other_method = true;
  }
  if (is_other_method)
    return refusal(405, "not_allowed", "this cannot be done with what is there", "method");
  return refusal(404, "not_found", "there is nothing of that name", "path");
}

json Api::stages() const {
  json stages = json::object();
  for (const char* name : kStages) {
    json stage = folder_.stage(name);
    const std::string kind = job_of_stage(name);
    if (const auto job = kind.empty() ? std::nullopt : jobs_.last_of(kind)) {
      if (job->state == "running") {
        stage["state"] = "running";
        stage["why"] = "";
      } else if (stage["state"] == "missing" && job->state == "failed") {
        stage["state"] = "failed";
        stage["why"] = job->message;
      } else if (stage["state"] == "missing" && job->state != "done" && job->is_over()) {
        stage["why"] = job->message;
      }
    }
    stages[name] = std::move(stage);
  }
  return stages;
}

void Api::tell_stages() { events_.publish("case", {{"stages", stages()}}); }

Reply Api::get_case(const Request&, const PathValues&) {
  const json description = read_object(folder_.description());
  const bool has_scan = there_is(folder_.ct()) && description.contains("scan");
  return json_reply({{"lefort_case", 1},
                     {"title", description.value("title", "")},
                     {"version", kVersion},
                     {"notice", kNotForClinicalUse},
                     {"start", events_.start()},
                     {"scan", has_scan ? description["scan"] : json()},
                     {"stages", stages()},
                     {"example_available", example_.has_value()},
                     {"job_kinds", job_kinds()},
                     {"limits",
                      {{"upload_file_bytes", uploads_.limits().file_bytes},
                       {"upload_files", uploads_.limits().files},
                       {"json_bytes", kLargestBody}}}});
}

Reply Api::post_upload(const Request&, const PathValues&) { return uploads_.begin(); }

Reply Api::put_upload_file(const Request& request, const PathValues& values) {
  const auto index = number_of(values[1], 0, uploads_.limits().files - 1);
  if (!index) return refusal(422, "invalid", "the index must be a small whole number", "index");
  const auto name = request.query.find("name");
  if (name == request.query.end())
    return refusal(422, "invalid", "the file's name must be given", "name");
  return uploads_.put(values[0], *index, name->second, request);
}

Reply Api::delete_upload(const Request&, const PathValues& values) {
  return uploads_.remove(values[0]);
}

Reply Api::get_jobs(const Request&, const PathValues&) {
  json list = json::array();
  for (const JobRecord& job : jobs_.all()) list.push_back(server::as_json(job));
  return json_reply({{"jobs", list}});
}

Reply Api::post_job(const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "JobRequest");
  if (!body.value) return body.refused;
  const std::string kind = (*body.value)["kind"];
  const auto kinds = job_kinds();
  if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end())
    return refusal(501, "unavailable", fmt::format("this lefort cannot {} yet", kind), "kind");
  body.value->erase("kind");
  const std::scoped_lock lock(writing_);  // Not amid a change that waits for jobs to be done.
  const auto job = jobs_.submit(kind, *std::move(body.value));
  if (!job) return refusal(429, "limit", job.error().message);
  return json_reply(server::as_json(*job), 202);
}

Reply Api::get_job(const Request&, const PathValues& values) {
  const auto id = number_of(values[0], 1, 1'000'000'000);
  const auto job = id ? jobs_.find(*id) : std::nullopt;
  return job ? json_reply(server::as_json(*job)) : not_there("there is no such job");
}

Reply Api::delete_job(const Request&, const PathValues& values) {
  const auto id = number_of(values[0], 1, 1'000'000'000);
  const auto job = id ? jobs_.cancel(*id) : std::nullopt;
  return job ? json_reply(server::as_json(*job)) : not_there("there is no such job");
}

Reply Api::get_events(const Request& request, const PathValues&) {
  Reply reply;
  reply.type = "text/event-stream";
  reply.events_after = request.header_or_empty("last-event-id");
  return reply;
}

Result<std::shared_ptr<const image::CtVolume>> Api::volume() {
  const auto etag = folder_.etag(folder_.ct());
  if (!etag) return fail(ErrorCode::kFileNotFound, "there is no scan yet: import one first");
  return volume_.get("ct", *etag, [&]() -> Result<image::CtVolume> {
    LEFORT_TRY(io::ImportedVolume scan, io::import_volume(folder_.ct()));
    return std::move(scan.ct);
  });
}

Reply Api::get_volume(const Request&, const PathValues&) {
  const auto ct = volume();
  if (!ct) return refusal(ct.error());
  const image::Grid& grid = (*ct)->grid;
  const auto [lowest, highest] = std::minmax_element((*ct)->values.begin(), (*ct)->values.end());
  json direction = json::array();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) direction.push_back(grid.direction(row, column));
  // Windows as radiologists set them for CT.
  const json presets{{{"name", "bone"}, {"level_hu", 500}, {"window_hu", 2000}},
                     {{"name", "soft tissue"}, {"level_hu", 50}, {"window_hu", 400}},
                     {{"name", "air and skin"}, {"level_hu", -300}, {"window_hu", 1400}},
                     {{"name", "brain"}, {"level_hu", 40}, {"window_hu", 80}}};
  const auto etag = folder_.etag(folder_.ct());
  return with_etag(json_reply({{"size", grid.size},
                               {"spacing_mm", as_json(grid.spacing_mm)},
                               {"origin_mm", as_json(grid.origin_L)},
                               {"direction", direction},
                               {"value_range_hu", {*lowest, *highest}},
                               {"presets", presets},
                               {"etag", etag.value_or("")}}),
                   etag);
}

Reply Api::get_volume_data(const Request& request, const PathValues&) {
  const auto every = query_number(request, "every", 1, 1, kMostEvery);
  if (!every) return refusal(every.error(), "every");
  const auto etag = folder_.etag(folder_.ct());
  if (is_known(request, etag)) return not_modified(etag);
  const auto ct = volume();
  if (!ct) return refusal(ct.error());
  return with_etag(voxels_reply(*ct, *every), etag);
}

Reply Api::get_labels(const Request& request, const PathValues&) {
  const auto etag = folder_.etag(folder_.labels());
  if (!etag) return not_there("there are no labels yet");
  if (is_known(request, etag)) return not_modified(etag);
  const auto ct = volume();
  if (!ct) return refusal(ct.error());
  json names = json::array({{{"value", 0}, {"name", "background"}}});
  for (const anatomy::TissueStyle& style : anatomy::kTissueStyles)
    names.push_back({{"value", int(style.tissue)}, {"name", style.name}});
  return with_etag(json_reply({{"size", (*ct)->grid.size}, {"names", names}}), etag);
}

Reply Api::get_labels_data(const Request& request, const PathValues&) {
  const auto every = query_number(request, "every", 1, 1, kMostEvery);
  if (!every) return refusal(every.error(), "every");
  const auto etag = folder_.etag(folder_.labels());
  if (!etag) return not_there("there are no labels yet");
  if (is_known(request, etag)) return not_modified(etag);
  const auto ct = volume();
  if (!ct) return refusal(ct.error());
  auto labels = io::read_segmentation(folder_.labels(), (*ct)->grid);
  if (!labels) return refusal(labels.error());
  return with_etag(
      voxels_reply(std::make_shared<const anatomy::LabelMap>(*std::move(labels)), *every), etag);
}

Reply Api::put_labels_data(const Request& request, const PathValues&) {
  const auto ct_etag = folder_.etag(folder_.ct());
  const auto ct = volume();
  if (!ct) return refusal(ct.error());
  const auto voxels = std::uint64_t((*ct)->grid.voxel_count());
  Body body = read_body(request, voxels, "application/octet-stream");
  if (!body.text) return body.refused;
  if (body.text->size() != voxels)
    return refusal(422, "invalid",
                   fmt::format("the body must have {} bytes, one per voxel, it "
                               "has {}",
                               voxels, body.text->size()));
  anatomy::LabelMap labels{(*ct)->grid, {}};
  labels.values.reserve(voxels);
  for (const char c : *body.text) {
    if (static_cast<unsigned char>(c) > anatomy::kTissueStyles.size())
      return refusal(422, "invalid", fmt::format("label {} is none", int(std::uint8_t(c))));
    labels.values.push_back(anatomy::Tissue(c));
  }
  const std::scoped_lock lock(writing_);
  if (!jobs_.is_idle())
    return refusal(409, "busy", "a job is at work: labels can be changed when it is done");
  if (folder_.etag(folder_.ct()) != ct_etag)
    return refusal(409, "stale", "the scan was replaced meanwhile: fetch it again");
  if (auto refused = check_precondition(request, folder_.etag(folder_.labels()))) return *refused;
  std::error_code error;
  fs::create_directories(folder_.anatomy(), error);
  if (const auto written = io::write_segmentation(folder_.labels(), labels); !written)
    return refusal(written.error());
  tell_stages();
  return with_etag(empty_reply(), folder_.etag(folder_.labels()));
}

Reply Api::get_surfaces(const Request&, const PathValues&) {
  json list = json::array();
  for (const NamedFile& surface : kSurfaces)
    if (const auto etag = folder_.etag(surface.path(folder_)))
      list.push_back({{"name", surface.name}, {"etag", *etag}});
  const json cut = read_object(folder_.cut() / "cut.json");
  if (cut.contains("bones") && cut["bones"].is_array())
    for (const json& bone : cut["bones"]) {
      if (!bone.is_object()) continue;
      const std::string name = bone.value("name", "");
      if (!is_segment_name(name)) continue;
      if (const auto etag = folder_.etag(folder_.cut() / fmt::format("segment_{}.vtp", name)))
        list.push_back({{"name", "segments/" + name}, {"etag", *etag}});
    }
  return json_reply({{"surfaces", list}});
}

Reply Api::surface_reply(const Request& request, const fs::path& file) {
  const auto etag = folder_.etag(file);
  if (!etag) return not_there("there is no such surface yet");
  if (is_known(request, etag)) return not_modified(etag);
  const auto bytes = surfaces_.get(file.string(), *etag, [&]() -> Result<std::string> {
    LEFORT_TRY(const geometry::TriangleMesh mesh, io::read_surface(file));
    return surface_bytes(mesh);
  });
  if (!bytes) return refusal(bytes.error());
  Reply reply = binary_reply({*bytes, **bytes});
  reply.headers.emplace_back("X-Lefort-Scalars", "");
  return with_etag(std::move(reply), etag);
}

Reply Api::get_surface(const Request& request, const PathValues& values) {
  const NamedFile* const surface = find_named(kSurfaces, values[0]);
  if (surface == nullptr) return not_there("there is no surface of that name");
  return surface_reply(request, surface->path(folder_));
}

Reply Api::get_segment_surface(const Request& request, const PathValues& values) {
  if (!is_segment_name(values[0])) return not_there("no segment is called so");
  return surface_reply(request, folder_.cut() / fmt::format("segment_{}.vtp", values[0]));
}

Reply Api::get_landmarks(const Request& request, const PathValues&) {
  const auto etag = folder_.etag(folder_.landmarks());
  if (!etag) return not_there("there are no landmarks yet");
  if (is_known(request, etag)) return not_modified(etag);
  const auto landmarks = io::read_landmarks(folder_.landmarks());
  if (!landmarks) return refusal(landmarks.error());
  return with_etag(json_reply({{"landmarks", as_points(*landmarks)}}), etag);
}

Reply Api::put_landmarks(const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "Landmarks");
  if (!body.value) return body.refused;
  plan::Landmarks landmarks = as_landmarks((*body.value)["landmarks"]);
  const std::scoped_lock lock(writing_);
  if (auto refused = check_precondition(request, folder_.etag(folder_.landmarks())))
    return *refused;
  if (landmarks.empty()) {
    std::error_code error;
    fs::remove(folder_.landmarks(), error);
  } else {
    const auto checked = io::checked_landmarks(std::move(landmarks));
    if (!checked) return refusal(checked.error(), "landmarks");
    if (const auto written = io::write_landmarks(folder_.landmarks(), *checked); !written)
      return refusal(written.error());
  }
  tell_stages();
  return with_etag(json_reply(*body.value), folder_.etag(folder_.landmarks()));
}

Reply Api::post_measurements(const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "MeasurementsRequest");
  if (!body.value) return body.refused;
  const auto before = plan::measure(as_landmarks((*body.value)["before"]));
  if (!before) return refusal(before.error(), "before");
  std::vector<plan::Measurement> after_table;
  if (body.value->contains("after")) {
    auto after = plan::measure(as_landmarks((*body.value)["after"]));
    if (!after) return refusal(after.error(), "after");
    after_table = *std::move(after);
  }
  return json_reply({{"measurements", cephalometric_json(*before, after_table)}});
}

Reply Api::get_plan(const Request& request, const PathValues&) {
  const auto etag = folder_.etag(folder_.plan());
  if (!etag) return not_there("there is no plan yet");
  if (is_known(request, etag)) return not_modified(etag);
  auto text = io::read_text(folder_.plan(), kLargestDocument);
  if (!text) return refusal(text.error());
  Reply reply;
  reply.text = *std::move(text);
  return with_etag(std::move(reply), etag);
}

Reply Api::put_plan(const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "Plan");
  if (!body.value) return body.refused;
  if (const auto files = check_files_of_plan(body.text); !files) return refusal(files.error());
  const auto plan = io::parse_plan(body.text, folder_.root());
  if (!plan) return refusal(422, "invalid", plan.error().message, "plan");
  const std::scoped_lock lock(writing_);
  if (auto refused = check_precondition(request, folder_.etag(folder_.plan()))) return *refused;
  if (const auto written = io::write_text(folder_.plan(), body.text); !written)
    return refusal(written.error());
  tell_stages();
  json names = json::array();
  for (const plan::PlannedSegment& segment : plan->segments)
    names.push_back(segment.osteotomy.segment);
  return with_etag(json_reply({{"segments", names}, {"can_predict", plan->segments.size() == 1}}),
                   folder_.etag(folder_.plan()));
}

Reply Api::get_plan_poses(const Request& request, const PathValues&) {
  const auto count = query_number(request, "count", 12, 1, 1000);
  if (!count) return refusal(count.error(), "count");
  const auto text = io::read_text(folder_.plan(), kLargestDocument);
  if (!text) return not_there("there is no plan yet");
  if (const auto files = check_files_of_plan(*text); !files) return refusal(files.error());
  const auto plan = io::parse_plan(*text, folder_.root());
  if (!plan) return refusal(plan.error(), "plan");
  json segments = json::object();
  for (const plan::PlannedSegment& segment : plan->segments) {
    json poses = json::array();
    for (int k = 0; k <= *count; ++k)
      poses.push_back(as_json(plan::pose_at(segment.path, double(k) / *count)));
    segments[segment.osteotomy.segment] = std::move(poses);
  }
  return json_reply({{"count", *count}, {"segments", segments}});
}

Reply Api::post_osteotomy(const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "OsteotomyRequest");
  if (!body.value) return body.refused;
  // As a plan that has it would be read.
  const json plan_json{{"lefort_plan", 1},
                       {"landmarks", (*body.value)["landmarks"]},
                       {"segments",
                        {{{"name", "segment"},
                          {"osteotomy", {{"template", (*body.value)["template"]}}},
                          {"path", {{"keyframes", {{{"at", 1}}}}}}}}}};
  const auto plan = io::parse_plan(plan_json.dump(), folder_.root());
  if (!plan) return refusal(422, "invalid", plan.error().message, "template");
  const auto as_planes = [](const std::vector<plan::CutPlane>& planes) {
    json list = json::array();
    for (const plan::CutPlane& plane : planes)
      list.push_back(
          {{"point_mm", as_json(plane.point_L)}, {"towards_segment", as_json(plane.normal_L)}});
    return list;
  };
  const plan::Osteotomy& cut = plan->segments.front().osteotomy;
  json osteotomy{{"planes", as_planes(cut.planes)}};
  for (const plan::CutRegion& region : cut.also)
    osteotomy["also"].push_back({{"planes", as_planes(region.planes)}});
  for (const Vec3& point : cut.holds_L) osteotomy["holds"].push_back(as_json(point));
  return json_reply({{"osteotomy", osteotomy}});
}

Reply Api::post_poses(const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "Poses");
  if (!body.value) return body.refused;
  const auto poses = as_poses((*body.value)["poses"]);
  if (!poses) return refusal(poses.error(), "poses");
  const auto etag = folder_.etag(folder_.cut() / "cut.json");
  if (!etag) return refusal(409, "not_ready", "no bone was cut yet: run the job cut first");
  const auto bones =
      bones_.get("bones", *etag, [&] { return LiveBones::read(folder_.cut(), folder_.cache()); });
  if (!bones) return refusal(bones.error());
  const auto depths = (*bones)->depths(*poses);
  if (!depths) return refusal(depths.error(), "poses");
  Reply reply = binary_reply(shared_bytes(float_bytes(depths->depth_mm)));
  std::string segments;
  for (const auto& [name, vertices] : depths->segments)
    segments += fmt::format("{}{}={}", segments.empty() ? "" : ",", name, vertices);
  reply.headers.emplace_back("X-Lefort-Segments", segments);
  reply.headers.emplace_back("X-Lefort-Deepest-Mm", fmt::format("{:.3f}", depths->deepest_mm));
  reply.headers.emplace_back("X-Lefort-Beyond-Reach", depths->is_beyond_reach ? "1" : "0");
  return reply;
}

Result<std::shared_ptr<const predict::FacePreview>> Api::preview() {
  // By the model: preview.json says the same of one with other materials.
  const auto etag = folder_.etag(folder_.preview() / "face.preview");
  if (!etag || !there_is(folder_.preview() / "preview.json"))
    return fail(ErrorCode::kFileNotFound, "no preview was prepared yet");
  return preview_.get("preview", *etag, [&]() -> Result<predict::FacePreview> {
    LEFORT_TRY(predict::PreviewModel model, read_preview_model(folder_.preview() / "face.preview"));
    return predict::FacePreview(std::move(model));
  });
}

void Api::warm_preview() {
  RigidTransform little = RigidTransform::Identity();
  little.translation().y() = -1.0;
  // What is wrong with it, if anything, the first who asks is told.
  if (const auto face = preview()) static_cast<void>((*face)->displacement_mm(little));
}

Reply Api::post_preview(const Request& request, const PathValues&) {
  JsonBody body = read_json(request, "Poses");
  if (!body.value) return body.refused;
  const auto poses = as_poses((*body.value)["poses"]);
  if (!poses) return refusal(poses.error(), "poses");
  const json document = read_object(folder_.preview() / "preview.json");
  const std::string segment = document.value("segment", "");
  if (segment.empty())
    return refusal(409, "not_ready", "no preview was prepared yet: run the job preview-factor");
  if (poses->size() != 1 || !poses->contains(segment))
    return refusal(422, "invalid", fmt::format("the preview is of segment {} alone", segment),
                   "poses");
  const auto face = preview();
  if (!face) return refusal(face.error());
  const auto displacement_mm = (*face)->displacement_mm(poses->at(segment));
  if (!displacement_mm) return refusal(displacement_mm.error());
  Reply reply = binary_reply(shared_bytes(float_bytes(*displacement_mm)));
  reply.headers.emplace_back("X-Lefort-Note", kPreviewNote);
  return reply;
}

Reply Api::get_preview_distance(const Request&, const PathValues&) {
  if (!folder_.etag(folder_.prediction() / "prediction.json"))
    return refusal(409, "not_ready", "there is no prediction to hold the preview against yet");
  const auto face = preview();
  if (!face) return refusal(409, "not_ready", face.error().message);
  const auto before = io::read_surface(folder_.prediction() / "skin_before.vtp");
  const auto after = io::read_surface(folder_.prediction() / "predicted_skin.vtp");
  const json document = read_object(folder_.prediction() / "prediction.json");
  const auto last = document.find("steps") == document.end() || document["steps"].empty()
                        ? json()
                        : document["steps"].back().value("pose_4x4_row_major_mm_lps", json());
  if (!before || !after || before->vertices.size() != after->vertices.size() || last.size() != 4)
    return refusal(422, "invalid", "the prediction's files are damaged: predict again");
  if (Index(before->vertices.size()) != (*face)->vertex_count())
    return refusal(409, "not_ready", "preview and prediction are of different skins");
  RigidTransform X_LB = RigidTransform::Identity();
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column)
      X_LB.matrix()(row, column) = last[std::size_t(row)][std::size_t(column)].get<double>();
  const auto preview_mm = (*face)->displacement_mm(X_LB);
  if (!preview_mm) return refusal(preview_mm.error());
  const PreviewDistance distance = measure_preview(*preview_mm, before->vertices, after->vertices);
  return json_reply({{"note", kPreviewNote},
                     {"moved_vertices", distance.moved_vertices},
                     {"p50_mm", distance.p50_mm},
                     {"p99_mm", distance.p99_mm},
                     {"max_mm", distance.max_mm},
                     {"largest_shift_mm", distance.largest_shift_mm}});
}

Reply Api::get_prediction_step(const Request&, const PathValues& values) {
  const auto step = number_of(values[0], 1, 1000);
  const auto etag = folder_.etag(folder_.prediction() / "prediction.json");
  if (!step || !etag) return not_there("there is no such step");
  const auto ct = volume();
  if (!ct) return refusal(ct.error());
  const auto steps = steps_.get(
      "steps", *etag, [&] { return StepSkin::read(folder_.prediction(), (*ct)->grid.spacing_mm); });
  if (!steps) return refusal(steps.error());
  const auto displacement_mm = (*steps)->displacement_mm(*step);
  if (!displacement_mm) {
    if (displacement_mm.error().code == ErrorCode::kFileNotFound)
      return not_there("there is no such step");
    return refusal(displacement_mm.error());
  }
  return binary_reply(shared_bytes(float_bytes(*displacement_mm)));
}

Reply Api::get_prediction(const Request& request, const PathValues&) {
  const fs::path failure = folder_.prediction() / "failure.json";
  const fs::path file = there_is(failure) ? failure : folder_.prediction() / "prediction.json";
  const auto etag = folder_.etag(file);
  if (!etag) return not_there("there is no prediction yet");
  if (is_known(request, etag)) return not_modified(etag);
  const json document = read_object(file);
  json steps = json::array();
  try {
    for (const json& step : document.at("steps")) {
      json pose = json::array();
      for (const json& row : step.at("pose_4x4_row_major_mm_lps"))
        for (const json& number : row) pose.push_back(number);
      std::size_t iterations = 0;
      for (const json& attempt : step.at("attempts"))
        iterations += std::max<std::size_t>(attempt.at("newton").size(), 1) - 1;
      steps.push_back({{"step", steps.size() + 1},
                       {"share", step.at("share")},
                       {"pose", pose},
                       {"newton_iterations", iterations},
                       {"relative_residual", step.at("relative_residual")},
                       {"contact_nodes", step.at("contact_nodes")},
                       {"contact_area_mm2", step.at("contact_area_mm2")},
                       {"p99_depth_mm", step.at("p99_depth_from_rest_mm")},
                       {"max_depth_mm", step.at("max_depth_from_rest_mm")},
                       {"largest_displacement_mm", step.at("largest_displacement_mm")}});
    }
    const bool converged = document.at("converged").get<bool>();
    const json& skin = document.at("skin");
    return with_etag(
        json_reply(
            {{"converged", converged},
             {"failure", document.value("failure", "")},
             {"skin_largest_shift_mm", converged ? skin.at("largest_shift_mm") : json()},
             {"skin_mean_shift_mm", converged ? skin.at("mean_shift_where_moved_mm") : json()},
             {"elements", document.at("mesh").at("elements")},
             {"steps", steps},
             {"document", document}}),
        etag);
  } catch (const json::exception&) {
    return refusal(422, "invalid", "prediction.json is damaged: predict again");
  }
}

Reply Api::get_files(const Request&, const PathValues&) {
  json list = json::array();
  for (const NamedFile& file : kFiles) {
    std::error_code error;
    const auto bytes = fs::file_size(file.path(folder_), error);
    if (error) continue;
    list.push_back({{"name", file.name}, {"bytes", bytes}, {"stage", file.stage}});
  }
  return json_reply({{"files", list}});
}

Reply Api::get_file(const Request&, const PathValues& values) {
  const NamedFile* const file = find_named(kFiles, values[0]);
  if (file == nullptr) return not_there("there is no file of that name");
  const fs::path path = file->path(folder_);
  if (!there_is(path)) return not_there("there is no such file yet");
  Reply reply;
  reply.type = "application/octet-stream";
  reply.file = path;
  reply.headers.emplace_back("Content-Disposition",
                             fmt::format("attachment; filename=\"{}\"", file->name));
  return reply;
}

}  // namespace lefort::app::server
