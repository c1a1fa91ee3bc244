#include <lefort/core/check.h>
#include <lefort/fem/assembly/continuum_term.h>
#include <lefort/fem/assembly/element_term.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/locking/mean_dilatation_term.h>
#include <lefort/fem/locking/nodal_pressure.h>
#include <lefort/fem/locking/volumetric_split.h>
#include <lefort/mesh/element_quality.h>

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace lefort::fem {
namespace {

using TermPtr = std::unique_ptr<const ForceTerm>;

/// Checks node numbers, coordinates and list lengths, so that later code need not.
Result<void> check_block(const mesh::VolumeMesh& mesh, const mesh::ElementBlock& block) {
  const std::size_t wanted = block.region.size() * std::size_t(mesh::node_count(block.shape));
  if (block.nodes.size() != wanted)
    return fail(ErrorCode::kMeshInvalid,
                fmt::format("volume mesh: a block of {} elements lists {} nodes, must be {}",
                            block.region.size(), block.nodes.size(), wanted));
  for (std::size_t k = 0; k < block.nodes.size(); ++k) {
    const std::int32_t node = block.nodes[k];
    if (node < 0 || node >= mesh.node_count())
      return fail(ErrorCode::kMeshInvalid,
                  fmt::format("volume mesh: an element names node {}, must be 0 to {}", node,
                              mesh.node_count() - 1));
    if (!mesh.nodes_L[std::size_t(node)].allFinite())
      return fail(ErrorCode::kMeshInvalid,
                  fmt::format("volume mesh: node {} has a coordinate that is not finite", node));
  }
  return {};
}

/// Laws of one block, and the index of the law of each element.
struct BlockMaterials {
  std::vector<Material> laws;
  std::vector<std::int32_t> of_element;
};

Result<BlockMaterials> block_materials(const mesh::ElementBlock& block,
                                       const RegionMaterials& materials) {
  BlockMaterials found;
  std::map<std::int32_t, std::int32_t> law_of_region;
  for (const std::int32_t region : block.region) {
    const auto [known, is_new] = law_of_region.try_emplace(region, std::int32_t(found.laws.size()));
    if (is_new) {
      const auto material = materials.find(region);
      if (material == materials.end())
        return fail(ErrorCode::kInvalidArgument,
                    fmt::format("region {} of the volume mesh has no material", region));
      LEFORT_TRY_VOID(std::visit([](const auto& law) { return law.validate(); }, material->second));
      found.laws.push_back(material->second);
    }
    found.of_element.push_back(known->second);
  }
  return found;
}

/// \returns the error that names the inverted element.
tl::unexpected<Error> fault_of(const mesh::VolumeMesh& mesh, const mesh::ElementBlock& block,
                               Index e, Index first_number, const ElementFault& fault) {
  const int count = mesh::node_count(block.shape);
  std::vector<Vec3> X_L;
  Vec3 at = Vec3::Zero();
  for (int a = 0; a < count; ++a) {
    X_L.push_back(mesh.nodes_L[std::size_t(block.element(e)[a])]);
    at += X_L.back() / count;
  }
  const std::string which = fmt::format("element {} at ({:.3f}, {:.3f}, {:.3f}) mm",
                                        first_number + e, at.x(), at.y(), at.z());
  if (fault.node >= 0)
    return fail(ErrorCode::kElementInverted,
                fmt::format("{} is folded at its node {}, number {} of the mesh, its volume must "
                            "be > 0 everywhere",
                            which, fault.node, block.element(e)[fault.node]));
  return fail(ErrorCode::kElementInverted,
              fmt::format("{} is flat or inverted, its volume must be > 0; its scaled Jacobian is "
                          "{:.3g}",
                          which, mesh::scaled_jacobian(block.shape, X_L)));
}

template <class Element>
Result<TermPtr> element_term(const mesh::VolumeMesh& mesh, const mesh::ElementBlock& block,
                             BlockMaterials materials, Index first_number,
                             VolumetricIntegration volumetric_integration) {
  LEFORT_CHECK(block.shape == Element::kShape);
  std::vector<ReferenceElement<Element>> points;
  points.reserve(block.region.size());
  for (Index e = 0; e < block.element_count(); ++e) {
    ElementNodes<Element> X;
    for (int a = 0; a < Element::kNodes; ++a)
      X.col(a) = mesh.nodes_L[std::size_t(block.element(e)[a])];
    const auto reference = reference_element<Element>(X);
    if (!reference) return fault_of(mesh, block, e, first_number, reference.error());
    points.push_back(*reference);
  }
  ElementData<Element> data{.nodes = block.nodes,
                            .points = std::move(points),
                            .materials = std::move(materials.laws),
                            .material = std::move(materials.of_element)};
  const bool averages = volumetric_integration == VolumetricIntegration::kMeanDilatation &&
                        std::ranges::any_of(data.materials, [](const Material& law) {
                          return volumetric_part(law) != nullptr;
                        });
  if constexpr (kVolumeAverage<Element> == VolumeAverage::kElement)
    if (averages) return std::make_unique<const MeanDilatationTerm<Element>>(std::move(data));
  if constexpr (kVolumeAverage<Element> == VolumeAverage::kCornerNodes)
    if (averages)  // NodalPressure has the rest.
      for (Material& law : data.materials) law = law_at_points(law);
  return std::make_unique<const ContinuumTerm<Element>>(std::move(data));
}

Result<TermPtr> term_of_block(const mesh::VolumeMesh& mesh, const mesh::ElementBlock& block,
                              BlockMaterials materials, Index first_number,
                              VolumetricIntegration volumetric_integration) {
  return std::visit(
      [&]<class Element>(const Element&) {
        return element_term<Element>(mesh, block, std::move(materials), first_number,
                                     volumetric_integration);
      },
      element_of(block.shape));
}

}  // namespace

Result<std::vector<TermPtr>> make_element_terms(const mesh::VolumeMesh& mesh,
                                                const RegionMaterials& materials,
                                                VolumetricIntegration volumetric_integration) {
  for (const mesh::ElementBlock& block : mesh.blocks) LEFORT_TRY_VOID(check_block(mesh, block));
  std::vector<TermPtr> terms;
  Index first_number = 0;
  for (const mesh::ElementBlock& block : mesh.blocks) {
    const Index count = block.element_count();
    if (count == 0) continue;
    LEFORT_TRY(BlockMaterials of_block, block_materials(block, materials));
    LEFORT_TRY(TermPtr term, term_of_block(mesh, block, std::move(of_block), first_number,
                                           volumetric_integration));
    terms.push_back(std::move(term));
    first_number += count;
  }
  if (terms.empty()) return fail(ErrorCode::kMeshInvalid, "volume mesh has no element");
  if (volumetric_integration == VolumetricIntegration::kMeanDilatation)
    if (TermPtr volume = NodalPressure::build(mesh, materials)) terms.push_back(std::move(volume));
  return terms;
}

}  // namespace lefort::fem
