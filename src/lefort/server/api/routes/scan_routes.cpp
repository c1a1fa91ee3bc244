#include <lefort/io/segmentation_file.h>
#include <lefort/pipeline/json/json_values.h>
#include <lefort/server/api/request_parts.h>
#include <lefort/server/api/route.h>
#include <lefort/server/case/served_case.h>

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

namespace lefort::server {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr int kMaxEvery = 16;

/// Every n-th voxel along each axis.
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
Response voxels_reply(const std::shared_ptr<const image::Volume<Value>>& volume, int every) {
  Response reply =
      every == 1 ? binary_response({volume,
                                    {reinterpret_cast<const char*>(volume->values.data()),
                                     volume->values.size() * sizeof(Value)}})
                 : binary_response(shared_bytes(every_nth(volume->grid, volume->values, every)));
  const auto sent = [&](std::size_t axis) { return (volume->grid.size[axis] + every - 1) / every; };
  reply.headers.emplace_back("X-Lefort-Size", fmt::format("{},{},{}", sent(0), sent(1), sent(2)));
  return reply;
}

Response get_volume(ServedCase& served, const Request&, const PathValues&) {
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
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
  const auto etag = served.folder.etag(served.folder.ct());
  return with_etag(json_response({{"size", grid.size},
                                  {"spacing_mm", pipeline::as_json(grid.spacing_mm)},
                                  {"origin_mm", pipeline::as_json(grid.origin_L)},
                                  {"direction", direction},
                                  {"value_range_hu", {*lowest, *highest}},
                                  {"presets", presets},
                                  {"etag", etag.value_or("")}}),
                   etag);
}

Response get_volume_data(ServedCase& served, const Request& request, const PathValues&) {
  const auto every = query_number(request, "every", 1, 1, kMaxEvery);
  if (!every) return error_response(every.error(), "every");
  const auto etag = served.folder.etag(served.folder.ct());
  if (is_not_modified(request, etag)) return not_modified(etag);
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
  return with_etag(voxels_reply(*ct, *every), etag);
}

Response get_labels(ServedCase& served, const Request& request, const PathValues&) {
  const auto etag = served.folder.etag(served.folder.labels());
  if (!etag) return not_found("the case has no labels");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
  json names = json::array({{{"value", 0}, {"name", "background"}}});
  for (const anatomy::TissueStyle& style : anatomy::kTissueStyles)
    names.push_back({{"value", int(style.tissue)}, {"name", style.name}});
  return with_etag(json_response({{"size", (*ct)->grid.size}, {"names", names}}), etag);
}

Response get_labels_data(ServedCase& served, const Request& request, const PathValues&) {
  const auto every = query_number(request, "every", 1, 1, kMaxEvery);
  if (!every) return error_response(every.error(), "every");
  const auto etag = served.folder.etag(served.folder.labels());
  if (!etag) return not_found("the case has no labels");
  if (is_not_modified(request, etag)) return not_modified(etag);
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
  auto labels = io::read_segmentation(served.folder.labels(), (*ct)->grid);
  if (!labels) return error_response(labels.error());
  return with_etag(
      voxels_reply(std::make_shared<const anatomy::LabelMap>(*std::move(labels)), *every), etag);
}

Response put_labels_data(ServedCase& served, const Request& request, const PathValues&) {
  const auto ct_etag = served.folder.etag(served.folder.ct());
  const auto ct = served.volume();
  if (!ct) return error_response(ct.error());
  const auto voxels = std::uint64_t((*ct)->grid.voxel_count());
  Body body = read_body(request, voxels, "application/octet-stream");
  if (!body.text) return body.error;
  if (body.text->size() != voxels)
    return error_response(422, "invalid",
                          fmt::format("the body must have {} bytes, one per voxel, it "
                                      "has {}",
                                      voxels, body.text->size()));
  anatomy::LabelMap labels{(*ct)->grid, {}};
  labels.values.reserve(voxels);
  for (const char c : *body.text) {
    if (static_cast<unsigned char>(c) > anatomy::kTissueStyles.size())
      return error_response(422, "invalid", fmt::format("label {} is none", int(std::uint8_t(c))));
    labels.values.push_back(anatomy::Tissue(c));
  }
  const std::scoped_lock lock(served.writing);
  if (!served.jobs.is_idle())
    return error_response(409, "busy", "a job is running: labels can be changed when it has ended");
  if (served.folder.etag(served.folder.ct()) != ct_etag)
    return error_response(409, "stale", "the scan was replaced meanwhile: reload it");
  if (auto refused = check_precondition(request, served.folder.etag(served.folder.labels())))
    return *refused;
  std::error_code error;
  fs::create_directories(served.folder.anatomy(), error);
  if (const auto written = io::write_segmentation(served.folder.labels(), labels); !written)
    return error_response(written.error());
  served.report_stages();
  return with_etag(empty_reply(), served.folder.etag(served.folder.labels()));
}

}  // namespace

std::span<const Route> scan_routes() {
  static constexpr Route kRoutes[] = {{"GET", "/volume", get_volume},
                                      {"GET", "/volume/data", get_volume_data},
                                      {"GET", "/labels", get_labels},
                                      {"GET", "/labels/data", get_labels_data},
                                      {"PUT", "/labels/data", put_labels_data}};
  return kRoutes;
}

}  // namespace lefort::server
