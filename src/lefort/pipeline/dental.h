/// \file
/// Intraoral scans in the frame of the CT, the occlusion of both arches, and splints.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/dental/find_occlusion.h>
#include <lefort/dental/renumber_teeth.h>
#include <lefort/dental/splint.h>
#include <lefort/pipeline/summary.h>

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::pipeline {

struct RegisterArchesJob {
  std::filesystem::path ct;                     ///< Anything `lefort import` reads.
  std::optional<std::filesystem::path> labels;  ///< .seg.nrrd; segmented unless given.
  std::optional<std::filesystem::path> upper;   ///< Intraoral scan of the upper jaw [mm].
  std::optional<std::filesystem::path> lower;   ///< The same of the lower jaw.
  std::filesystem::path output;                 ///< A folder; made if missing.
};

/// Registers intraoral scans with the crowns in a CT. Of each jaw writes `upper.stl` (the scan in
/// frame L), `upper.tfm` (its motion), `upper_crowns.vtp` (crowns of the CT with the distance to
/// the scan), and for both `arches.json`.
///
/// \returns the summary, or
///   - kInvalidArgument  no intraoral scan is given, or see dental::register_arch();
///   - the errors of scan_labels(), io::read_surface(), dental::find_crowns() and
///     dental::register_arch(); then nothing is written;
///   - kFileUnwritable   a result cannot be written.
[[nodiscard]] Result<Summary> register_arches(const RegisterArchesJob& job, Progress& progress);

struct TeethJob {
  std::filesystem::path ct;                        ///< Anything `lefort import` reads.
  std::optional<std::filesystem::path> labels;     ///< .seg.nrrd; segmented unless given.
  std::optional<std::filesystem::path> landmarks;  ///< What is missing is found.
  /// teeth_corrections.json: numbers that the user has corrected.
  std::optional<std::filesystem::path> corrections;
  std::vector<dental::ToothCorrection> more_corrections;  ///< Replace those of the file.
  std::filesystem::path output;                           ///< A folder; made if missing.
};

/// Finds, separates and numbers the teeth (dental::number_teeth()), and corrects their numbers.
/// Writes `teeth_corrections.json` if there are corrections, `teeth_numbered.seg.nrrd`,
/// `teeth.mrk.json` (crown and apex of each tooth), `teeth.csv` and `teeth.json`.
///
/// \returns the summary, or
///   - kInvalidArgument  a correction is not possible (dental::renumbered());
///   - kAnatomyMissing   no tooth is found, or no landmark of the mid-sagittal plane (N, ANS, A);
///   - the errors of oriented_head();
///   - kFileUnwritable   a result cannot be written.
[[nodiscard]] Result<Summary> number_teeth_of_scan(const TeethJob& job, Progress& progress);

struct OcclusionJob {
  std::filesystem::path upper;  ///< Surface of the upper arch in frame L.
  std::filesystem::path lower;  ///< Surface of the lower arch in frame L, at the start.
  /// arches.json of register_arches(), for the directions; without it those of the patient.
  std::optional<std::filesystem::path> arches;
  dental::OcclusionOptions options;  ///< The midlines of its requests are those of `teeth`.
  /// Scans of the teeth in occlusion, from the cheek: the occlusion is theirs.
  std::vector<std::filesystem::path> bites;
  /// The occlusion is that of the files of the intraoral scans, which the scanner has exported in
  /// occlusion; `arches` knows their motions.
  bool is_as_scanned = false;
  /// Cuts of the upper arch between adjacent teeth, by their FDI numbers: pieces that are moved on
  /// their own to the occlusion with the lower arch. `teeth` is needed.
  std::vector<std::array<int, 2>> cuts;
  /// teeth.json of number_teeth_of_scan(): for cuts, a requested midline, and the relations of
  /// midlines, canines and molars. Both arches must lie where they are in the CT.
  std::optional<std::filesystem::path> teeth;
  /// Planned motion of the upper jaw, .tfm. With it the motion of the lower jaw to the occlusion
  /// with the moved upper one is written, too.
  std::optional<std::filesystem::path> upper_transform;
  std::filesystem::path output;  ///< A folder; made if missing.
};

/// Finds the occlusion: the maximum intercuspation, or that of bite scans, or that of the scanner.
/// With cuts, also that of each piece of the upper arch, and writes `piece_N.stl` and
/// `piece_N.tfm`, from right to left. Writes `lower.stl` (the lower arch there),
/// `lower_to_occlusion.tfm` (its motion, for the path of a plan), `lower_contacts.vtp` (with the
/// gap to the upper arch) and `occlusion.json`; with `upper_transform` also `lower_with_upper.tfm`,
/// the motion to occlusion followed by that of the upper jaw.
///
/// \returns the summary, or
///   - the errors of io::read_surface(), io::read_transform(), dental::find_occlusion(),
///     dental::register_bite() and cut_arch();
///   - kInvalidArgument `arches` does not have the motions of both scans;
///   - kAnatomyMissing  a midline is requested, and a central incisor is missing;
///   - kFileCorrupt     `arches` or `teeth` is not of its format;
///   - kFileUnwritable  a result cannot be written.
[[nodiscard]] Result<Summary> find_arch_occlusion(const OcclusionJob& job, Progress& progress);

struct SplintJob {
  std::filesystem::path upper, lower;  ///< Surfaces of the arches in frame L, as planned.
  /// arches.json of register_arches(), for the directions; without it those of the patient.
  std::optional<std::filesystem::path> arches;
  /// Motions of the arches (.tfm) to the planned position; none unless given. The directions of
  /// `arches` move with the jaw they are of.
  std::optional<std::filesystem::path> upper_transform, lower_transform;
  double open_mm = 0.0;           ///< The lower arch is moved to inferior before.
  dental::SplintOptions options;  ///< Its text is that of `text`.
  std::string text;               ///< Engraved into the front; 16 letters or fewer. May be empty.
  std::filesystem::path output;   ///< A folder; made if missing.
};

/// Makes a splint. Writes `splint.stl`, `splint.3mf` and `splint.json`.
///
/// \returns the summary, with warnings if the splint has several parts, holes, or is thinner
///   than 1 mm, or
///   - kInvalidArgument the text is longer than 16 letters, or has control characters or blanks
///     only;
///   - the errors of io::read_surface(), io::read_transform() and dental::make_splint();
///   - kFileCorrupt     `arches` is not of its format;
///   - kFileUnwritable  a result cannot be written.
[[nodiscard]] Result<Summary> make_arch_splint(const SplintJob& job, Progress& progress);

}  // namespace lefort::pipeline
