#include <lefort/io/gmsh.h>
#include <lefort/io/read_vtu.h>
#include <lefort/io/volume_mesh_files.h>

#include <fmt/format.h>

namespace lefort::io {

Result<mesh::VolumeMesh> read_volume_mesh(const std::filesystem::path& file,
                                          const std::string& regions) {
  const std::string ending = file.extension().string();
  if (ending == ".vtu") return read_vtu(file, regions);
  if (ending == ".msh" && !regions.empty())
    return fail(
        ErrorCode::kFileUnsupported,
        fmt::format("mesh {} has physical volumes and no cell array {}", file.string(), regions));
  if (ending == ".msh") return read_gmsh(file);
  return fail(ErrorCode::kFileUnsupported,
              fmt::format("mesh {} must end in .vtu or .msh", file.string()));
}

}  // namespace lefort::io
