#include <lefort/io/internal/vtk_cell_types.h>
#include <lefort/io/internal/vtk_xml.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

namespace lefort::io {
namespace {

using internal::find_array;
using internal::XmlArrays;
using mesh::ElementShape;

// Some ten million elements with a few fields.
constexpr std::uintmax_t kLargestFile = std::uintmax_t(4) << 30;

const std::vector<internal::WantedArray> kWanted{{"Points", ""},
                                                 {"Cells", "connectivity"},
                                                 {"Cells", "offsets"},
                                                 {"Cells", "types"},
                                                 {"CellData", "region"}};

/// The arrays of a piece.
struct Piece {
  const std::vector<double>& points;
  const std::vector<double>& connectivity;
  const std::vector<double>& offsets;  ///< Where the nodes of each cell end.
  const std::vector<double>& types;
  const std::vector<double>* regions;  ///< Null if the file has none.
};

Error corrupt(std::string why) { return {ErrorCode::kFileCorrupt, std::move(why)}; }

Result<Piece> find_piece(const XmlArrays& file, int number) {
  const auto* points = find_array(file, number, "Points", "");
  const auto* connectivity = find_array(file, number, "Cells", "connectivity");
  const auto* offsets = find_array(file, number, "Cells", "offsets");
  const auto* types = find_array(file, number, "Cells", "types");
  const auto* regions = find_array(file, number, "CellData", "region");
  if (points == nullptr || connectivity == nullptr || offsets == nullptr || types == nullptr)
    return tl::unexpected(corrupt("points or cells are missing, expected both"));
  if (points->size() % 3 != 0)
    return tl::unexpected(corrupt("the points have not three coordinates each"));
  if (types->size() != offsets->size() ||
      (regions != nullptr && regions->size() != offsets->size()))
    return tl::unexpected(corrupt(fmt::format(
        "there are {} cells, {} types and {} regions, expected as many", offsets->size(),
        types->size(), regions != nullptr ? regions->size() : offsets->size())));
  return Piece{*points, *connectivity, *offsets, *types, regions};
}

/// `value` as a whole number of 32 bits from `lowest` to below `end`.
Result<std::int32_t> whole(double value, double lowest, double end, const char* what) {
  if (!(value >= lowest && value < end) || value != std::floor(value))
    return tl::unexpected(
        corrupt(fmt::format("{} {} is none, expected a whole number from {} to "
                            "below {}",
                            what, value, lowest, end)));
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
  for (std::size_t n = 0; n < piece.points.size(); n += 3) {
    mesh.nodes_L.emplace_back(piece.points[n], piece.points[n + 1], piece.points[n + 2]);
    if (!mesh.nodes_L.back().allFinite())
      return tl::unexpected(corrupt(fmt::format("node {} is not finite", mesh.node_count() - 1)));
  }
  if (mesh.nodes_L.size() > std::size_t(std::numeric_limits<std::int32_t>::max()))
    return tl::unexpected(corrupt("there are more nodes than 32 bits can number"));
  return {};
}

/// Adds the cells of a piece whose first node is `first_node` of the mesh.
Result<void> add_cells(const Piece& piece, std::int32_t first_node, mesh::VolumeMesh& mesh) {
  const auto node_count = double(piece.points.size() / 3);
  std::size_t begin = 0;
  for (std::size_t cell = 0; cell < piece.offsets.size(); ++cell) {
    const auto shape = internal::shape_of_cell(piece.types[cell]);
    if (!shape)
      return fail(ErrorCode::kFileUnsupported,
                  fmt::format("element {} has VTK cell type {}, which is not solved with", cell,
                              piece.types[cell]));
    const auto end = begin + std::size_t(mesh::node_count(*shape));
    if (piece.offsets[cell] != double(end) || end > piece.connectivity.size())
      return tl::unexpected(corrupt(fmt::format("the nodes of element {} end at {}, expected {}",
                                                cell, piece.offsets[cell], end)));
    mesh::ElementBlock& block = block_of(mesh, *shape);
    for (std::size_t n = begin; n < end; ++n) {
      LEFORT_TRY(const std::int32_t node, whole(piece.connectivity[n], 0.0, node_count, "node"));
      block.nodes.push_back(first_node + node);
    }
    const double said = piece.regions != nullptr ? (*piece.regions)[cell] : 0.0;
    LEFORT_TRY(const std::int32_t region, whole(said, -0x1p31, 0x1p31, "region"));
    block.region.push_back(region);
    begin = end;
  }
  return {};
}

Result<mesh::VolumeMesh> convert(const XmlArrays& file) {
  mesh::VolumeMesh mesh;
  for (int number = 1; number <= file.pieces; ++number) {
    LEFORT_TRY(const Piece piece, find_piece(file, number));
    const auto first_node = std::int32_t(mesh.nodes_L.size());
    LEFORT_TRY_VOID(add_nodes(piece, mesh));
    LEFORT_TRY_VOID(add_cells(piece, first_node, mesh));
  }
  if (mesh.blocks.empty()) return tl::unexpected(corrupt("there are no elements, expected some"));
  return mesh;
}

}  // namespace

Result<mesh::VolumeMesh> read_vtu(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string bytes, read_text(file, kLargestFile));
  const std::string name = "mesh " + file.string();
  LEFORT_TRY(const XmlArrays arrays,
             internal::parse_vtk_xml(bytes, name, "UnstructuredGrid", kWanted));
  auto mesh = convert(arrays);
  if (!mesh) return fail(mesh.error().code, fmt::format("{}: {}", name, mesh.error().message));
  return mesh;
}

}  // namespace lefort::io
