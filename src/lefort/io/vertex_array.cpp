#include <lefort/io/internal/vtk_xml.h>
#include <lefort/io/read_text.h>
#include <lefort/io/vertex_array.h>

#include <fmt/format.h>

namespace lefort::io {

Result<std::vector<double>> read_vertex_array(const std::filesystem::path& file,
                                              const std::string& name) {
  const std::string subject = "surface " + file.string();
  LEFORT_TRY(
      const internal::XmlArrays arrays,
      internal::read_vtk_xml(file, subject, "PolyData", {{"Points", ""}, {"PointData", name}}));
  const auto* const points = internal::find_array(arrays, 1, "Points", "");
  const auto* const values = internal::find_array(arrays, 1, "PointData", name);
  if (arrays.pieces != 1 || points == nullptr || values == nullptr ||
      points->size() != 3 * values->size())
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{}: there is no array {} with one number per vertex", subject, name));
  return *values;
}

}  // namespace lefort::io
