#include <lefort/bench/field_process.h>
#include <lefort/bench/measure_field.h>
#include <lefort/bench/run_process.h>
#include <lefort/bench/skull_surface.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/surface_files.h>

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

namespace lefort::bench {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The same surface with each triangle divided into parts^2 similar ones.
geometry::TriangleMesh split(const geometry::TriangleMesh& mesh, int parts) {
  geometry::TriangleMesh fine;
  const auto corner_of = [&](const Vec3& a, const Vec3& b, const Vec3& c, int i, int j) -> Vec3 {
    return a + (double(i) / parts) * (b - a) + (double(j) / parts) * (c - a);
  };
  for (Index t = 0; t < mesh.triangle_count(); ++t) {
    const Vec3 &a = mesh.corner(t, 0), &b = mesh.corner(t, 1), &c = mesh.corner(t, 2);
    const auto first = std::int32_t(fine.vertices.size());
    // Row j has parts + 1 - j corners.
    const auto vertex_index = [&](int i, int j) {
      return first + std::int32_t(j * (parts + 1) - j * (j - 1) / 2 + i);
    };
    for (int j = 0; j <= parts; ++j)
      for (int i = 0; i + j <= parts; ++i) fine.vertices.push_back(corner_of(a, b, c, i, j));
    for (int j = 0; j < parts; ++j)
      for (int i = 0; i + j < parts; ++i) {
        fine.triangles.push_back(
            {vertex_index(i, j), vertex_index(i + 1, j), vertex_index(i, j + 1)});
        if (i + j + 1 < parts)
          fine.triangles.push_back(
              {vertex_index(i + 1, j), vertex_index(i + 1, j + 1), vertex_index(i, j + 1)});
      }
  }
  return fine;
}

}  // namespace

Result<fs::path> prepare_skull(const fs::path& ct, const fs::path& folder, Progress& progress) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    return fail(ErrorCode::kFileUnwritable,
                fmt::format("cannot create {}: {}", folder.string(), error.message()));
  const fs::path path = folder / "skull.vtp";
  if (fs::is_regular_file(path, error)) return path;
  progress.begin_stage("read the scan");
  LEFORT_TRY(const io::ImportedVolume scan, io::import_volume(ct, progress));
  LEFORT_TRY(const geometry::TriangleMesh skull, extract_skull(scan.ct, {}, progress));
  LEFORT_TRY_VOID(io::write_surface(path, skull));
  return path;
}

Result<Json> measure_in_process(const fs::path& surface, const Json& task, Progress& progress) {
  LEFORT_TRY(const std::string output,
             run_process({"/proc/self/exe", "bench", "field-task", surface.string(), task.dump(),
                          "--quiet", "--json"},
                         progress));
  const Json result = Json::parse(output, nullptr, false);
  if (result.is_discarded())
    return fail(ErrorCode::kFileCorrupt, fmt::format("the task {} printed no JSON", task.dump()));
  return result;
}

Result<Json> run_field_task(const fs::path& surface, const std::string& task) {
  const Json json = Json::parse(task, nullptr, false);
  if (!json.is_object()) return fail(ErrorCode::kInvalidArgument, "the task is not a JSON object");
  FieldTask parsed;
  try {
    parsed.method = json.at("method").get<std::string>();
    parsed.resolution = json.at("resolution").get<int>();
    parsed.relative_tolerance = json.value("relative_tolerance", parsed.relative_tolerance);
    parsed.half_band_cells = json.value("half_band_cells", parsed.half_band_cells);
    parsed.side_mm = json.value("side_mm", parsed.side_mm);
    parsed.threads = json.value("threads", parsed.threads);
    parsed.repeats = std::max(1, json.value("repeats", parsed.repeats));
    parsed.query_points = std::max<Index>(1, json.value("query_points", parsed.query_points));
    parsed.error_points = std::max<Index>(1, json.value("error_points", parsed.error_points));
    parsed.parts = std::clamp(json.value("parts", parsed.parts), 1, 32);
    parsed.only_build = json.value("only_build", parsed.only_build);
  } catch (const Json::exception& wrong) {
    return fail(ErrorCode::kInvalidArgument, fmt::format("invalid task: {}", wrong.what()));
  }
  LEFORT_TRY(const geometry::TriangleMesh skull, io::read_surface(surface));
  return measure_field(parsed.parts > 1 ? split(skull, parsed.parts) : skull, parsed);
}

}  // namespace lefort::bench
