#include <lefort/io/internal/vtk_cell_types.h>
#include <lefort/io/internal/vtk_xml.h>
#include <lefort/io/internal/wedge_order.h>
#include <lefort/io/read_text.h>
#include <lefort/io/read_vtu.h>
#include <lefort/mesh/element_faces.h>
#include <lefort/mesh/match_faces_to_elements.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace lefort::io {
namespace {

using internal::find_array;
using internal::XmlArrays;
using mesh::ElementShape;

constexpr std::string_view kSet = "set:";
const std::string kRegion = "region";

/// Without the array of regions.
const std::vector<internal::WantedArray> kVtuArrays{
    {"Points", ""},
    {"Cells", "connectivity"},
    {"Cells", "offsets"},
    {"Cells", "types"},
    {"CellData", std::string(kSet), internal::NameMatch::kBeginning},
    {"PointData", std::string(kSet), internal::NameMatch::kBeginning}};

/// A 0-1 array that selects nodes or cells of a piece.
struct SetArray {
  std::string name;  ///< Of the set.
  const std::vector<double>& members;
};

/// The arrays of a piece.
struct Piece {
  const std::vector<double>& points;
  const std::vector<double>& connectivity;
  const std::vector<double>& offsets;  ///< End of the nodes of each cell.
  const std::vector<double>& types;
  const std::vector<double>* regions;  ///< Null if the file has none.
  std::vector<SetArray> node_sets{};
  std::vector<SetArray> face_sets{};
};

Error corrupt_vtu(std::string why) { return {ErrorCode::kFileCorrupt, std::move(why)}; }

/// Returns the sets in `parent`, PointData or CellData, with `count` nodes or cells.
Result<std::vector<SetArray>> find_sets(const XmlArrays& file, int number, std::string_view parent,
                                        std::size_t count) {
  std::vector<SetArray> sets;
  for (const internal::XmlArray& array : file.arrays) {
    if (array.piece != number || array.parent != parent || !array.name.starts_with(kSet)) continue;
    if (std::any_of(array.name.begin(), array.name.end(),
                    [](char c) { return std::uint8_t(c) < 0x20; }))
      return tl::unexpected(corrupt_vtu("a set has an unprintable name"));
    const bool is_0_or_1 = std::all_of(array.values.begin(), array.values.end(),
                                       [](double value) { return value == 0.0 || value == 1.0; });
    if (array.values.size() != count || array.name.size() == kSet.size() || !is_0_or_1)
      return tl::unexpected(corrupt_vtu(fmt::format(
          "array \"{}\" must have a name and one 0 or 1 for each of {}", array.name, count)));
    sets.push_back({array.name.substr(kSet.size()), array.values});
  }
  return sets;
}

Result<Piece> find_piece(const XmlArrays& file, int number, const std::string& region_array) {
  const auto* points = find_array(file, number, "Points", "");
  const auto* connectivity = find_array(file, number, "Cells", "connectivity");
  const auto* offsets = find_array(file, number, "Cells", "offsets");
  const auto* types = find_array(file, number, "Cells", "types");
  const auto* regions = find_array(file, number, "CellData", region_array);
  if (points == nullptr || connectivity == nullptr || offsets == nullptr || types == nullptr)
    return tl::unexpected(corrupt_vtu("points or cells are missing, expected both"));
  if (points->size() % 3 != 0)
    return tl::unexpected(corrupt_vtu("the points do not have three coordinates each"));
  if (types->size() != offsets->size() ||
      (regions != nullptr && regions->size() != offsets->size()))
    return tl::unexpected(corrupt_vtu(fmt::format(
        "there are {} cells, {} types and {} regions, expected equal numbers", offsets->size(),
        types->size(), regions != nullptr ? regions->size() : offsets->size())));
  Piece piece{*points, *connectivity, *offsets, *types, regions};
  LEFORT_TRY(piece.node_sets, find_sets(file, number, "PointData", points->size() / 3));
  LEFORT_TRY(piece.face_sets, find_sets(file, number, "CellData", types->size()));
  return piece;
}

/// Converts `value` to a 32-bit integer from `lowest` to below `end`.
Result<std::int32_t> whole(double value, double lowest, double end, const char* what) {
  if (!(value >= lowest && value < end) || value != std::floor(value))
    return tl::unexpected(corrupt_vtu(fmt::format(
        "{} {} is invalid, expected an integer from {} to below {}", what, value, lowest, end)));
  return std::int32_t(value);
}

mesh::ElementBlock& block_of(mesh::VolumeMesh& mesh, ElementShape shape) {
  const auto found = std::find_if(mesh.blocks.begin(), mesh.blocks.end(),
                                  [&](const auto& block) { return block.shape == shape; });
  if (found != mesh.blocks.end()) return *found;
  mesh.blocks.push_back({.shape = shape, .nodes = {}, .region = {}});
  return mesh.blocks.back();
}

Result<void> add_nodes(const Piece& piece, mesh::VolumeMesh& mesh) {
  const auto first = std::int32_t(mesh.nodes_L.size());
  for (std::size_t n = 0; n < piece.points.size(); n += 3) {
    mesh.nodes_L.emplace_back(piece.points[n], piece.points[n + 1], piece.points[n + 2]);
    if (!mesh.nodes_L.back().allFinite())
      return tl::unexpected(
          corrupt_vtu(fmt::format("node {} is not finite", mesh.node_count() - 1)));
  }
  if (mesh.nodes_L.size() > std::size_t(std::numeric_limits<std::int32_t>::max()))
    return tl::unexpected(corrupt_vtu("there are more nodes than 32-bit indices allow"));
  for (const SetArray& set : piece.node_sets) {
    std::vector<std::int32_t>& nodes = mesh.node_sets[set.name];
    for (std::size_t n = 0; n < set.members.size(); ++n)
      if (set.members[n] == 1.0) nodes.push_back(first + std::int32_t(n));
  }
  return {};
}

/// Adds a face to its sets, or to the set of its region.
void add_face(const Piece& piece, std::size_t cell, const mesh::Face& face, std::int32_t region,
              mesh::VolumeMesh& mesh) {
  bool is_in_a_set = false;
  for (const SetArray& set : piece.face_sets) {
    if (set.members[cell] != 1.0) continue;
    mesh.face_sets[set.name].push_back(face);
    is_in_a_set = true;
  }
  if (!is_in_a_set) mesh.face_sets[fmt::format("region {}", region)].push_back(face);
}

Result<void> check_no_set(const Piece& piece, std::size_t cell) {
  for (const SetArray& set : piece.face_sets)
    if (set.members[cell] == 1.0)
      return fail(
          ErrorCode::kMeshInvalid,
          fmt::format(
              "cell set \"{}\" contains element {}, expected faces (two-dimensional cells) only",
              set.name, cell));
  return {};
}

/// Returns the end of the nodes of an ignored cell, which may have any number of them.
Result<std::size_t> end_of_line_cell(const Piece& piece, std::size_t cell, std::size_t begin) {
  const double end = piece.offsets[cell];
  if (end >= double(begin) && end <= double(piece.connectivity.size()) && end == std::floor(end))
    return std::size_t(end);
  return tl::unexpected(
      corrupt_vtu(fmt::format("the nodes of element {} end at {}, expected {} to {}", cell, end,
                              begin, piece.connectivity.size())));
}

/// Adds the cells of a piece whose first node is `first_node` of the mesh.
Result<void> add_cells(const Piece& piece, std::int32_t first_node, mesh::VolumeMesh& mesh) {
  const auto node_count = double(piece.points.size() / 3);
  std::vector<std::int32_t> nodes;
  std::size_t begin = 0;
  for (std::size_t cell = 0; cell < piece.offsets.size(); ++cell) {
    const auto shape = internal::shape_of_cell(piece.types[cell]);
    const auto face_shape = internal::face_shape_of_cell(piece.types[cell]);
    if (internal::is_point_or_line_cell(piece.types[cell])) {
      LEFORT_TRY(begin, end_of_line_cell(piece, cell, begin));
      continue;
    }
    if (!shape && !face_shape)
      return fail(ErrorCode::kFileUnsupported,
                  fmt::format("element {} has VTK cell type {}, which is not supported; expected "
                              "tetrahedra (10, 24), pyramids (14), wedges (13, 26), hexahedra (12, "
                              "25) or their faces (5, 9, 22, 23)",
                              cell, piece.types[cell]));
    const auto end =
        begin + std::size_t(shape ? mesh::node_count(*shape) : mesh::node_count(*face_shape));
    if (piece.offsets[cell] != double(end) || end > piece.connectivity.size())
      return tl::unexpected(corrupt_vtu(fmt::format(
          "the nodes of element {} end at {}, expected {}", cell, piece.offsets[cell], end)));
    nodes.clear();
    for (std::size_t n = begin; n < end; ++n) {
      const double node = piece.connectivity[n];
      if (!(node >= 0.0 && node < node_count) || node != std::floor(node))
        return tl::unexpected(corrupt_vtu(fmt::format(
            "element {} refers to node {}, expected an integer below {}", cell, node, node_count)));
      nodes.push_back(first_node + std::int32_t(node));
    }
    const double region_number = piece.regions != nullptr ? (*piece.regions)[cell] : 0.0;
    LEFORT_TRY(const std::int32_t region, whole(region_number, -0x1p31, 0x1p31, "region"));
    if (shape) {
      LEFORT_TRY_VOID(check_no_set(piece, cell));
      mesh::ElementBlock& block = block_of(mesh, *shape);
      block.nodes.insert(block.nodes.end(), nodes.begin(), nodes.end());
      block.region.push_back(region);
    } else {
      mesh::Face face{.shape = *face_shape, .nodes = {}};
      std::copy(nodes.begin(), nodes.end(), face.nodes.begin());
      add_face(piece, cell, face, region, mesh);
    }
    begin = end;
  }
  return {};
}

Result<mesh::VolumeMesh> convert(const XmlArrays& file, const std::string& regions) {
  mesh::VolumeMesh mesh;
  for (int number = 1; number <= file.pieces; ++number) {
    LEFORT_TRY(const Piece piece, find_piece(file, number, regions.empty() ? kRegion : regions));
    if (!regions.empty() && piece.regions == nullptr)
      return tl::unexpected(
          corrupt_vtu(fmt::format("there is no cell array {} of regions", regions)));
    const auto first_node = std::int32_t(mesh.nodes_L.size());
    LEFORT_TRY_VOID(add_nodes(piece, mesh));
    for (const SetArray& set : piece.face_sets) mesh.face_sets[set.name];  // May be empty.
    LEFORT_TRY_VOID(add_cells(piece, first_node, mesh));
  }
  if (mesh.blocks.empty())
    return tl::unexpected(corrupt_vtu("there are no elements, expected some"));
  for (mesh::ElementBlock& block : mesh.blocks)
    if (mesh::corner_count(block.shape) == 6) internal::renumber_wedges(block, mesh.nodes_L);
  for (auto& [name, faces] : mesh.face_sets) {
    auto attached = mesh::match_faces_to_elements(mesh, faces);
    if (!attached)
      return fail(attached.error().code,
                  fmt::format("face set \"{}\": {}", name, attached.error().message));
    faces = std::move(*attached);
  }
  return mesh;
}

}  // namespace

Result<mesh::VolumeMesh> read_vtu(const std::filesystem::path& file, const std::string& regions,
                                  Progress& progress) {
  const std::string name = "mesh " + file.string();
  std::vector<internal::WantedArray> wanted = kVtuArrays;
  wanted.push_back({"CellData", regions.empty() ? kRegion : regions});
  LEFORT_TRY(const XmlArrays arrays,
             internal::read_vtk_xml(file, name, "UnstructuredGrid", wanted, progress));
  auto mesh = convert(arrays, regions);
  if (!mesh) return fail(mesh.error().code, fmt::format("{}: {}", name, mesh.error().message));
  return mesh;
}

Result<std::vector<Vec3>> read_vtu_vectors(const std::filesystem::path& file,
                                           const std::string& name) {
  const std::string subject = "mesh " + file.string();
  LEFORT_TRY(const XmlArrays arrays,
             internal::read_vtk_xml(file, subject, "UnstructuredGrid", {{"PointData", name}}));
  const auto* values = find_array(arrays, 1, "PointData", name);
  if (arrays.pieces != 1 || values == nullptr || values->size() % 3 != 0 ||
      !std::all_of(values->begin(), values->end(), [](double v) { return std::isfinite(v); }))
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{}: there is no array {} of three numbers per node", subject, name));
  std::vector<Vec3> vectors;
  for (std::size_t n = 0; n < values->size(); n += 3)
    vectors.emplace_back((*values)[n], (*values)[n + 1], (*values)[n + 2]);
  return vectors;
}

}  // namespace lefort::io
