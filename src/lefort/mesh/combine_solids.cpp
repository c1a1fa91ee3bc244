#include <lefort/mesh/combine_solids.h>
#include <lefort/mesh/internal/boolean_operations.h>

namespace lefort::mesh {
namespace {

using geometry::TriangleMesh;

Result<TriangleMesh> checked(std::optional<TriangleMesh> combined) {
  if (combined) return std::move(*combined);
  return fail(ErrorCode::kMeshingFailed,
              "the surfaces of an osteotomy cannot be combined: they cross or touch along an edge");
}

}  // namespace

Result<TriangleMesh> unite(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.triangles.empty()) return b;
  if (b.triangles.empty()) return a;
  return checked(internal::boolean_operations(a, b, {.in_either = true}).in_either);
}

Result<TriangleMesh> intersect(const TriangleMesh& a, const TriangleMesh& b) {
  if (a.triangles.empty() || b.triangles.empty()) return TriangleMesh();
  return checked(internal::boolean_operations(a, b, {.in_both = true}).in_both);
}

}  // namespace lefort::mesh
