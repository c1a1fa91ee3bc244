#include <lefort/core/version.h>
#include <lefort/io/write_3mf.h>
#include <lefort/io/write_atomically.h>

#include <fmt/format.h>
#include <minizip/zip.h>
#include <zlib.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <string_view>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::string_view kContentTypes =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
 <Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
 <Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
)";
constexpr std::string_view kRelationships =
    R"(<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
 <Relationship Id="model" Target="/3D/3dmodel.model" )"
    R"(Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
)";

/// For character data of XML; control characters, which XML does not allow, become blanks.
std::string escaped(std::string_view text) {
  std::string xml;
  for (const char c : text) {
    if (c == '&')
      xml += "&amp;";
    else if (c == '<')
      xml += "&lt;";
    else if (c == '>')
      xml += "&gt;";
    else
      xml += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return xml;
}

std::string model_of(const geometry::TriangleMesh& mesh_L, const std::string& title) {
  std::string xml = fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en-US"
 xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">
 <metadata name="Title">{}</metadata>
 <metadata name="Description">{}</metadata>
 <resources>
  <object id="1" type="model" name="surface">
   <mesh>
    <vertices>
)",
      escaped(title), escaped(kNotForClinicalUse));
  auto out = std::back_inserter(xml);
  for (const Vec3& p : mesh_L.vertices)
    fmt::format_to(out, "<vertex x=\"{:.5f}\" y=\"{:.5f}\" z=\"{:.5f}\"/>\n", p.x(), p.y(), p.z());
  xml += "</vertices>\n<triangles>\n";
  for (const geometry::Triangle& t : mesh_L.triangles)
    fmt::format_to(out, "<triangle v1=\"{}\" v2=\"{}\" v3=\"{}\"/>\n", t[0], t[1], t[2]);
  xml +=
      "</triangles>\n</mesh>\n</object>\n</resources>\n"
      "<build><item objectid=\"1\"/></build>\n</model>\n";
  return xml;
}

bool add_part(zipFile archive, const char* name, std::string_view bytes) {
  constexpr std::size_t kBlock = std::size_t(1) << 30;
  const zip_fileinfo no_time{};
  bool is_written = zipOpenNewFileInZip(archive, name, &no_time, nullptr, 0, nullptr, 0, nullptr,
                                        Z_DEFLATED, Z_DEFAULT_COMPRESSION) == ZIP_OK;
  while (is_written && !bytes.empty()) {
    const std::string_view block = bytes.substr(0, kBlock);
    is_written = zipWriteInFileInZip(archive, block.data(), unsigned(block.size())) == ZIP_OK;
    bytes.remove_prefix(block.size());
  }
  return is_written && zipCloseFileInZip(archive) == ZIP_OK;
}

Result<void> write_parts(const fs::path& path, const std::string& model) {
  const auto full = [&] {
    return fail(ErrorCode::kFileUnwritable, fmt::format("{} cannot be written", path.string()));
  };
  const zipFile archive = zipOpen(path.c_str(), APPEND_STATUS_CREATE);
  if (archive == nullptr) return full();
  const bool is_written = add_part(archive, "[Content_Types].xml", kContentTypes) &&
                          add_part(archive, "_rels/.rels", kRelationships) &&
                          add_part(archive, "3D/3dmodel.model", model);
  if (zipClose(archive, nullptr) != ZIP_OK || !is_written) return full();
  return {};
}

}  // namespace

Result<void> write_3mf(const fs::path& path, const geometry::TriangleMesh& mesh_L,
                       const std::string& title) {
  if (mesh_L.triangles.empty())
    return fail(ErrorCode::kMeshInvalid, fmt::format("{}: the surface is empty", path.string()));
  const std::string model = model_of(mesh_L, title);
  return write_atomically(path,
                          [&](const fs::path& temporary) { return write_parts(temporary, model); });
}

}  // namespace lefort::io
