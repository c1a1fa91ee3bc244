/// \file
/// The plan of a case of a cohort, completed for its prediction.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/types.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/io/parameter_sets.h>
#include <lefort/pipeline/validate/find_cases.h>

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <vector>

namespace lefort::pipeline {

/// Where the scan of a case is, and its plan will be.
struct CaseFiles {
  std::filesystem::path scan;
  std::optional<std::filesystem::path> labels{};  ///< Instead of a segmentation.
  std::filesystem::path work;                     ///< Folder of the completed plan.
  /// The plan does not name the scan, and names links in the work folder, which are named by the
  /// contents of the files: its text does not depend on the place of the case.
  bool link_inputs = false;
};

struct CasePlan {
  nlohmann::ordered_json json;  ///< Valid; paths are relative to the work folder.
  /// For each segment: the plan has no path for it, and in `json` it stays in place.
  std::vector<bool> lacks_movement{};
};

/// The plan of the case; without one, that of the cohort; without both, a plan that moves the
/// mandible as a whole.
///
/// \param one              the case.
/// \param files            named in the plan.
/// \param element_size_mm  of the mesh near the segments, instead of the plan's. The element size
///   far from the segments is then at least twice as large.
/// \param parameters       merged into the plan before.
/// \returns the plan, kFileNotFound, kFileCorrupt, kFileUnwritable, or kPlanInvalid.
[[nodiscard]] Result<CasePlan> draft_plan(const CohortCase& one, const CaseFiles& files,
                                          std::optional<double> element_size_mm,
                                          const io::ParameterSet& parameters = io::default_set());

/// Replaces the path of a segment by a straight one, with one step per millimeter of the largest
/// displacement of a vertex (4 to 60 steps).
///
/// \param plan       of draft_plan().
/// \param segment    number of the segment.
/// \param X_LB       its pose at the end of the path.
/// \param segment_B  its surface.
void set_movement(CasePlan& plan, std::size_t segment, const RigidTransform& X_LB,
                  const geometry::TriangleMesh& segment_B);

}  // namespace lefort::pipeline
