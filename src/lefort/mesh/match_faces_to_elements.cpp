#include <lefort/mesh/internal/face_key.h>
#include <lefort/mesh/match_faces_to_elements.h>

#include <fmt/format.h>

#include <algorithm>
#include <string>

namespace lefort::mesh {
namespace {

using internal::face_key;
using internal::FaceKey;

struct KeyedFace {
  FaceKey key;
  std::size_t index;  ///< In the list of faces.
};

std::string corners_of(const Face& face) {
  return fmt::format("{}",
                     fmt::join(nodes_of(face).first(std::size_t(corner_count(face.shape))), ", "));
}

/// Whether `b`, which has the same corners as `a`, has the same orientation.
bool have_same_orientation(const Face& a, const Face& b) {
  const int count = corner_count(a.shape);
  const auto* const start = std::find(b.nodes.begin(), b.nodes.begin() + count, a.nodes[0]);
  const auto next = std::size_t((start - b.nodes.begin() + 1) % count);
  return b.nodes[next] == a.nodes[1];
}

}  // namespace

Result<std::vector<Face>> match_faces_to_elements(const VolumeMesh& mesh,
                                                  std::span<const Face> faces) {
  std::vector<KeyedFace> wanted;
  for (const Face& face : faces) wanted.push_back({face_key(face), wanted.size()});
  const auto by_key = [](const KeyedFace& a, const KeyedFace& b) {
    return a.key != b.key ? a.key < b.key : a.index < b.index;
  };
  std::sort(wanted.begin(), wanted.end(), by_key);
  for (std::size_t n = 1; n < wanted.size(); ++n)
    if (wanted[n].key == wanted[n - 1].key)
      return fail(ErrorCode::kMeshInvalid, fmt::format("the face with corners {} occurs twice",
                                                       corners_of(faces[wanted[n].index])));

  std::vector<Face> matched_faces(faces.begin(), faces.end());
  std::vector<char> is_found(faces.size(), 0);
  internal::for_each_face(mesh, [&](const Face& face) {
    const FaceKey key = face_key(face);
    const auto at = std::lower_bound(wanted.begin(), wanted.end(), KeyedFace{key, 0}, by_key);
    if (at == wanted.end() || at->key != key) return;
    if (is_found[at->index] == 0 || have_same_orientation(faces[at->index], face))
      matched_faces[at->index] = face;
    is_found[at->index] = 1;
  });
  const auto lost = std::find(is_found.begin(), is_found.end(), 0);
  if (lost != is_found.end())
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("the face with corners {} belongs to no element",
                            corners_of(faces[std::size_t(lost - is_found.begin())])));
  return matched_faces;
}

}  // namespace lefort::mesh
