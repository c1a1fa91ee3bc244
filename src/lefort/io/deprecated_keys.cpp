#include <lefort/io/deprecated_keys.h>

namespace lefort::io {
namespace {

constexpr DeprecatedKey kPlanKeys[] = {
    {"segments[]", "from", "cut_from"},
    {"segments[].osteotomy", "also", "additional_regions"},
    {"segments[].osteotomy", "holds", "anchor_points"},
    {"segments[].osteotomy", "smallest_piece_ml", "min_piece_ml"},
    {"segments[].osteotomy", "smallest_piece_share", "min_piece_fraction"},
    {"segments[].path.keyframes[]", "at", "path_fraction"},
    {"boundary", "moved_bone", "interface"},
    {"boundary", "segment_interface", "interface"},
    {"boundary", "scan_edge", "scan_boundary"},
    {"boundary", "release_mm", "elevation_margin_mm"},
    {"boundary", "capture_mm", "contact_snap_mm"},
    {"contact", "reconstruction", "detection"},
    {"solver", "smallest_step", "min_increment_ratio"},
};

constexpr DeprecatedValue kPlanValues[] = {
    {"boundary", "interface", "sliding", "contact"},
    {"boundary", "interface", "attached", "bonded"},
};

constexpr DeprecatedKey kDeckKeys[] = {
    {"materials[]", "fibres", "fibers"},
    {"motions[].keyframes[]", "at", "time"},
    {"obstacles[].keyframes[]", "at", "time"},
    {"obstacles[]", "capture_mm", "contact_snap_mm"},
    {"obstacles[]", "reconstruction", "detection"},
    {"steps", "initial", "initial_increment"},
    {"steps", "smallest", "min_increment"},
    {"steps", "largest", "max_increment"},
    {"steps", "growth", "growth_factor"},
    {"steps", "easy_iterations", "target_iterations"},
    {"steps", "most_attempts", "max_attempts"},
    {"steps", "at", "times"},
};

constexpr DeprecatedValue kDeckValues[] = {{"output", "every", "at", "times"}};

constexpr DeprecatedOption kOptions[] = {
    {"bench scaling", "--parts", "--subdivisions"},
    {"bench solve", "--pairs", "--repeats"},
    {"bench solve", "--pair-cells", "--comparison-cells"},
    {"field build", "--side", "--domain-size"},
    {"field export", "--every", "--stride"},
    {"field slice", "--every", "--stride"},
    {"plan check", "--support-share", "--support-fraction"},
    {"segment", "--triangles", "--max-triangles"},
};

}  // namespace

DeprecatedNames deprecated_in_plans() { return {kPlanKeys, kPlanValues}; }
DeprecatedNames deprecated_in_decks() { return {kDeckKeys, kDeckValues}; }

void note_warnings(std::span<const std::string> warnings, Progress& progress) {
  for (const std::string& warning : warnings) progress.note("warning: " + warning);
}

std::span<const DeprecatedOption> deprecated_options() { return kOptions; }

}  // namespace lefort::io
