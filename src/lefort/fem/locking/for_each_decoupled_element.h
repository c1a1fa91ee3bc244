/// \file
/// Visits the elements of a mesh in order. For those with a decoupled law, calls a function with
/// the type of their shape.
#pragma once

#include <lefort/core/check.h>
#include <lefort/fem/elements/all_elements.h>
#include <lefort/fem/materials/material_response.h>

#include <cstdint>
#include <variant>

namespace lefort::fem {

/// \param mesh       \pre every region has a material.
/// \param materials  laws of the regions.
/// \param take       take(Element{}, nodes, region): called for each element with a decoupled law.
/// \param after_each  after_each(): called after every element of the mesh, whatever its law.
template <class Take, class AfterEach>
void for_each_decoupled_element(const mesh::VolumeMesh& mesh, const RegionMaterials& materials,
                                const Take& take, const AfterEach& after_each) {
  for (const mesh::ElementBlock& block : mesh.blocks)
    for (Index e = 0; e < block.element_count(); ++e) {
      const std::int32_t region = block.region[std::size_t(e)];
      const auto material = materials.find(region);
      LEFORT_CHECK(material != materials.end());
      if (volumetric_part(material->second) != nullptr)
        std::visit([&](const auto& element) { take(element, block.element(e), region); },
                   element_of(block.shape));
      after_each();
    }
}

}  // namespace lefort::fem
