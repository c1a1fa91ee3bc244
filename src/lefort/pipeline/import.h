/// \file
/// Import of scans from a file, a DICOM folder or a server, and the synthetic head.
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/pipeline/summary.h>

#include <cstdint>
#include <filesystem>
#include <string>

namespace lefort::pipeline {

struct ImportJob {
  std::filesystem::path source;    ///< A file, a DICOM folder, or the address of a study.
  std::filesystem::path output;    ///< .nrrd, .nii.gz, .nii or .mha.
  int series = 0;                  ///< Of a DICOM folder or study; 0: the only CT.
  std::string user{}, password{};  ///< Of a DICOMweb server, unless they are in its address.
};

/// Reads a scan in any format; writes a volume in HU and frame L.
///
/// \returns the summary, or
///   - kFileNotFound      the source does not exist;
///   - kFileUnsupported   its format, dimensions or modality are not supported;
///   - kFileCorrupt       it is truncated or damaged, slices are missing, or the grid is invalid;
///   - kInvalidArgument   several series and none chosen, or `output` has another ending;
///   - kAccessDenied, kConnectionFailed  from io::read_dicomweb();
///   - kFileUnwritable    the volume cannot be written;
///   - kCancelled         `progress` requested a stop.
[[nodiscard]] Result<Summary> import_scan(const ImportJob& job, Progress& progress);

/// Lists the series of a DICOM folder or study. The output of the job is not used.
///
/// \returns the list as text and JSON, or the errors of import_scan() except kFileUnwritable.
[[nodiscard]] Result<Summary> list_scans(const ImportJob& job, Progress& progress);

/// How the synthetic head is scanned.
enum class PhantomVariant {
  kPlain,     ///< Axial slices.
  kTilted,    ///< With gantry tilt.
  kShuffled,  ///< The names of files are not in the order of slices.
  kOblique,   ///< Slices oblique to the axes of the patient.
  kFeetFirst  ///< The patient lies with the feet towards the gantry.
};

/// Which synthetic head.
enum class PhantomHead {
  kSimple,    ///< Simple shapes, asymmetric (anatomy/synthetic_head.h).
  kTeeth,     ///< With orbits, nose, teeth and lips (anatomy/parametric_head.h): the mean head.
  kOpenBite,  ///< The same with the mandible opened by 4 degrees: open bite, closed lips.
  /// With single teeth (anatomy/dentition.h), marrow, canals, and a mandible not in occlusion.
  kDentition
};

struct PhantomJob {
  std::filesystem::path output;  ///< A folder; made if missing.
  PhantomHead head = PhantomHead::kSimple;
  PhantomVariant variant = PhantomVariant::kPlain;
  double voxel_mm = 1.4;   ///< Edge of a voxel; > 0.
  double noise_hu = 12.0;  ///< Standard deviation of the noise of the scan.
  // Of kDentition:
  std::uint64_t shape = 0;  ///< 0: the mean head; else a random one (anatomy::draw_head_shape()).
  double retrusion_mm =
      5.0;  ///< Of the body of the mandible with its teeth; negative: to anterior.
  double deviation_mm = 2.0;  ///< The same to the left.
};

/// Writes DICOM files of a synthetic head and its true labels; of a head with teeth also its true
/// landmarks; of kDentition also intraoral scans and `truth.json` (scan/dentition_files.h).
///
/// The mandible of kDentition is opened until the distance of the teeth is 1 mm.
///
/// \returns the summary; kFileUnwritable if `output`/dicom is not empty or a file cannot be
///   written; kInvalidArgument for a head with teeth that is not scanned as kPlain; or kCancelled.
[[nodiscard]] Result<Summary> make_phantom(const PhantomJob& job, Progress& progress);

}  // namespace lefort::pipeline
