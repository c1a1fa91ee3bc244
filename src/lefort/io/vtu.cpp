#include <lefort/core/escape_markup.h>
#include <lefort/io/internal/vtk_cell_types.h>
#include <lefort/io/vtu.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>

namespace lefort::io {

static_assert(std::endian::native == std::endian::little, "the files are little-endian");

namespace {

using internal::kCellTypes;
using mesh::ElementBlock;
using mesh::VolumeMesh;

Result<void> check_name(std::string_view kind, const std::string& name) {
  const bool printable =
      std::none_of(name.begin(), name.end(), [](char c) { return std::uint8_t(c) < 0x20; });
  if (!name.empty() && printable) return {};
  return fail(
      ErrorCode::kInvalidArgument,
      fmt::format("a {} is named \"{}\", expected a printable name", kind, printable ? name : "?"));
}

Result<void> check_mesh(const VolumeMesh& mesh) {
  const auto missing = [&](std::int32_t node) {
    return node < 0 || Index(node) >= mesh.node_count();
  };
  const auto check_nodes = [&](std::span<const std::int32_t> nodes,
                               const std::string& owner) -> Result<void> {
    const auto lost = std::find_if(nodes.begin(), nodes.end(), missing);
    if (lost == nodes.end()) return {};
    return fail(ErrorCode::kMeshInvalid, fmt::format("{} refers to node {}, there are {} nodes",
                                                     owner, *lost, mesh.node_count()));
  };
  for (std::size_t b = 0; b < mesh.blocks.size(); ++b) {
    const ElementBlock& block = mesh.blocks[b];
    const Index wanted = block.element_count() * mesh::node_count(block.shape);
    if (Index(block.nodes.size()) != wanted)
      return fail(ErrorCode::kMeshInvalid, fmt::format("element block {} has {} nodes, expected {}",
                                                       b, block.nodes.size(), wanted));
    LEFORT_TRY_VOID(check_nodes(block.nodes, fmt::format("element block {}", b)));
  }
  for (const auto& [name, nodes] : mesh.node_sets) {
    LEFORT_TRY_VOID(check_name("node set", name));
    LEFORT_TRY_VOID(check_nodes(nodes, fmt::format("node set {}", name)));
  }
  for (const auto& [name, faces] : mesh.face_sets) {
    LEFORT_TRY_VOID(check_name("face set", name));
    const std::string owner = fmt::format("face set {}", name);
    for (const mesh::Face& face : faces) LEFORT_TRY_VOID(check_nodes(nodes_of(face), owner));
  }
  return {};
}

/// \param count  number of nodes or elements.
/// \param names  used so far; those of `fields` are added.
Result<void> check_fields(std::span<const VtuArray> fields, Index count,
                          std::set<std::string>& names) {
  for (const VtuArray& field : fields) {
    LEFORT_TRY_VOID(check_name("field", field.name));
    if (!names.insert(field.name).second)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("two fields are named {}, names must differ", field.name));
    if (field.components != 1 && field.components != 3 && field.components != 9)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("field {} has {} components, expected 1, 3 or 9", field.name,
                              field.components));
    if (Index(field.values.size()) != count * field.components)
      return fail(ErrorCode::kInvalidArgument,
                  fmt::format("field {} has {} values, expected {}", field.name,
                              field.values.size(), count * field.components));
  }
  return {};
}

/// Builds the XML and the raw data of a file together.
class VtuFile {
 public:
  void xml(std::string_view text) { xml_ += text; }

  template <class T>
  void array(std::string_view name, int components, const std::vector<T>& values) {
    xml_ += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" "
        "offset=\"{}\"/>\n",
        type_name(T()), escape_markup(name), components, raw_.size());
    const std::uint64_t bytes = values.size() * sizeof(T);
    raw_.append(reinterpret_cast<const char*>(&bytes), sizeof bytes);
    raw_.append(reinterpret_cast<const char*>(values.data()), bytes);
  }

  [[nodiscard]] std::string finished() && {
    xml_ += "<AppendedData encoding=\"raw\">\n_";  // The data begin after the underscore.
    xml_ += raw_;
    xml_ += "\n</AppendedData>\n</VTKFile>\n";
    return std::move(xml_);
  }

 private:
  static std::string_view type_name(double /*unused*/) { return "Float64"; }
  static std::string_view type_name(std::int64_t /*unused*/) { return "Int64"; }
  static std::string_view type_name(std::int32_t /*unused*/) { return "Int32"; }
  static std::string_view type_name(std::uint8_t /*unused*/) { return "UInt8"; }

  std::string xml_;
  std::string raw_;
};

void add_nodes(VtuFile& file, const VolumeMesh& mesh) {
  file.xml("<Points>\n");
  file.array("points", 3, vtu_array("points", mesh.nodes_L).values);
  file.xml("</Points>\n");
}

/// The faces of all sets without repetition, and the members of each set.
struct WrittenFaces {
  std::vector<mesh::Face> faces;
  std::map<std::string, std::vector<std::size_t>> sets;
};

WrittenFaces find_faces(const VolumeMesh& mesh, VtuFaces wanted) {
  WrittenFaces found;
  if (wanted == VtuFaces::kLeaveOut) return found;
  std::map<std::pair<mesh::FaceShape, std::array<std::int32_t, 8>>, std::size_t> place;
  for (const auto& [name, faces] : mesh.face_sets) {
    std::vector<std::size_t>& members = found.sets[name];
    for (const mesh::Face& face : faces) {
      const auto [at, is_new] = place.try_emplace({face.shape, face.nodes}, found.faces.size());
      if (is_new) found.faces.push_back(face);
      members.push_back(at->second);
    }
  }
  return found;
}

void add_cells(VtuFile& file, const VolumeMesh& mesh, const WrittenFaces& written) {
  std::vector<std::int32_t> connectivity;
  std::vector<std::int64_t> ends;
  std::vector<std::uint8_t> types;
  for (const ElementBlock& block : mesh.blocks) {
    connectivity.insert(connectivity.end(), block.nodes.begin(), block.nodes.end());
    for (Index e = 0; e < block.element_count(); ++e)
      ends.push_back((ends.empty() ? 0 : ends.back()) + mesh::node_count(block.shape));
    types.resize(types.size() + block.region.size(), kCellTypes[std::size_t(block.shape)]);
  }
  for (const mesh::Face& face : written.faces) {
    const auto nodes = nodes_of(face);
    connectivity.insert(connectivity.end(), nodes.begin(), nodes.end());
    ends.push_back(std::int64_t(connectivity.size()));
    types.push_back(internal::kFaceCellTypes[std::size_t(face.shape)]);
  }
  file.xml("<Cells>\n");
  file.array("connectivity", 1, connectivity);
  file.array("offsets", 1, ends);
  file.array("types", 1, types);
  file.xml("</Cells>\n");
}

void add_node_fields(VtuFile& file, const VolumeMesh& mesh, std::span<const VtuArray> fields) {
  file.xml("<PointData>\n");
  for (const VtuArray& field : fields) file.array(field.name, field.components, field.values);
  for (const auto& [name, nodes] : mesh.node_sets) {
    std::vector<std::uint8_t> member(mesh.nodes_L.size(), 0);
    for (const std::int32_t node : nodes) member[std::size_t(node)] = 1;
    file.array("set:" + name, 1, member);
  }
  file.xml("</PointData>\n");
}

void add_cell_fields(VtuFile& file, const VolumeMesh& mesh, std::span<const VtuArray> fields,
                     const WrittenFaces& written) {
  const std::size_t faces = written.faces.size();
  std::vector<std::int32_t> regions;
  for (const ElementBlock& block : mesh.blocks)
    regions.insert(regions.end(), block.region.begin(), block.region.end());
  const std::size_t elements = regions.size();
  regions.resize(elements + faces, 0);
  file.xml("<CellData>\n");
  for (const VtuArray& field : fields) {
    std::vector<double> values = field.values;
    values.resize(values.size() + faces * std::size_t(field.components),
                  std::numeric_limits<double>::quiet_NaN());
    file.array(field.name, field.components, values);
  }
  file.array("region", 1, regions);
  for (const auto& [name, members] : written.sets) {
    std::vector<std::uint8_t> is_member(elements + faces, 0);
    for (const std::size_t face : members) is_member[elements + face] = 1;
    file.array("set:" + name, 1, is_member);
  }
  file.xml("</CellData>\n");
}

}  // namespace

VtuArray vtu_array(std::string name, std::span<const double> values) {
  return {std::move(name), 1, {values.begin(), values.end()}};
}

VtuArray vtu_array(std::string name, std::span<const Vec3> values) {
  VtuArray array{std::move(name), 3, {}};
  array.values.reserve(3 * values.size());
  for (const Vec3& value : values)
    array.values.insert(array.values.end(), value.data(), value.data() + 3);
  return array;
}

VtuArray vtu_array(std::string name, std::span<const Mat3> values) {
  VtuArray array{std::move(name), 9, {}};
  array.values.reserve(9 * values.size());
  for (const Mat3& value : values)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) array.values.push_back(value(row, column));
  return array;
}

Result<void> write_vtu(const std::filesystem::path& target, const VolumeMesh& mesh,
                       const VtuFields& fields, VtuFaces faces) {
  LEFORT_TRY_VOID(check_mesh(mesh));
  std::set<std::string> node_names;
  for (const auto& [name, nodes] : mesh.node_sets) node_names.insert("set:" + name);
  std::set<std::string> element_names{"region"};
  for (const auto& [name, of_set] : mesh.face_sets) element_names.insert("set:" + name);
  LEFORT_TRY_VOID(check_fields(fields.nodes, mesh.node_count(), node_names));
  LEFORT_TRY_VOID(check_fields(fields.elements, mesh.element_count(), element_names));

  const WrittenFaces written = find_faces(mesh, faces);
  VtuFile file;
  file.xml(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" "
      "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<UnstructuredGrid>\n");
  file.xml(fmt::format("<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n", mesh.node_count(),
                       mesh.element_count() + Index(written.faces.size())));
  add_node_fields(file, mesh, fields.nodes);
  add_cell_fields(file, mesh, fields.elements, written);
  add_nodes(file, mesh);
  add_cells(file, mesh, written);
  file.xml("</Piece>\n</UnstructuredGrid>\n");
  return write_text(target, std::move(file).finished());
}

Result<void> write_pvd(const std::filesystem::path& target, std::span<const PvdEntry> entries) {
  std::string xml =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" "
      "byte_order=\"LittleEndian\">\n<Collection>\n";
  for (const PvdEntry& entry : entries) {
    LEFORT_TRY_VOID(check_name("file of a series", entry.file));
    if (!std::isfinite(entry.time))
      return fail(
          ErrorCode::kInvalidArgument,
          fmt::format("the time of {} is {}, expected a finite number", entry.file, entry.time));
    xml += fmt::format("<DataSet timestep=\"{}\" part=\"0\" file=\"{}\"/>\n", entry.time,
                       escape_markup(entry.file));
  }
  return write_text(target, xml + "</Collection>\n</VTKFile>\n");
}

}  // namespace lefort::io
