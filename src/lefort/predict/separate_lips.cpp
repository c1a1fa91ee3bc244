#include <lefort/mesh/boundary_faces.h>
#include <lefort/mesh/open_slit.h>
#include <lefort/predict/separate_lips.h>

#include <fmt/format.h>

#include <utility>

namespace lefort::predict {
namespace {

/// A smaller slit is a bridge of partial volume between open lips, or an error.
constexpr double kMinArea_mm2 = 50.0;

Vec3 normal_at(const OralFissure& fissure, const Vec3& p_L) {
  constexpr double kDifference_mm = 0.5;
  Vec3 gradient;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 d = kDifference_mm * Vec3::Unit(axis);
    gradient[axis] = fissure.level(p_L + d) - fissure.level(p_L - d);
  }
  return gradient.normalized();
}

}  // namespace

TissueWithLips separate_lips(mesh::VolumeMesh tissue, const TissueDomain& domain,
                             FissureSearch search) {
  TissueWithLips result{std::move(tissue), {}};
  LipSlit& lips = result.lips;
  lips.reason = std::move(search.reason);
  lips.fissure = std::move(search.fissure);
  if (!lips.fissure) return result;
  const OralFissure& fissure = *lips.fissure;
  mesh::SlitMesh slit = mesh::open_slit(result.tissue,
                                        {[&](const Vec3& p_L) { return fissure.level(p_L); },
                                         [&](const Vec3& p_L) { return fissure.extent(p_L); }},
                                        [&](const Vec3& p_L) { return domain.level(p_L) > 0.0; });
  if (slit.pairs.empty() || slit.area_mm2 < kMinArea_mm2) {
    lips.reason = fmt::format(
        "{:.0f} mm2 of tissue lie between the lips, less than {:.0f}: they are apart in the scan, "
        "or not meshed",
        slit.area_mm2, kMinArea_mm2);
    return result;
  }
  result.tissue = std::move(slit.mesh);
  lips.area_mm2 = slit.area_mm2;
  lips.rms_distance_mm = slit.rms_distance_mm;
  for (const auto& [upper, lower, area_mm2] : slit.pairs)
    lips.pairs.push_back(
        {upper, lower, area_mm2, normal_at(fissure, result.tissue.nodes_L[std::size_t(upper)])});
  for (auto [set, faces] : {std::pair{sets::kUpperLip, &slit.first_faces},
                            std::pair{sets::kLowerLip, &slit.second_faces}}) {
    result.tissue.node_sets[set] = mesh::nodes_of_faces(*faces);
    result.tissue.face_sets[set] = std::move(*faces);
  }
  return result;
}

std::string describe(const LipSlit& lips) {
  if (!lips.is_separated()) return fmt::format("lips: not separated: {}", lips.reason);
  const OralFissure& fissure = *lips.fissure;
  return fmt::format(
      "lips: separated over {:.0f} mm and {:.0f} mm2, {} pairs of nodes; height by {}, crease "
      "{:.1f} mm, confidence {:.2f}",
      fissure.width_mm(), lips.area_mm2, lips.pairs.size(), name_of(fissure.source),
      fissure.crease_depth_mm, fissure.confidence);
}

}  // namespace lefort::predict
