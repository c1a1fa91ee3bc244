/// \file
/// What every reader of scans hands back.
#pragma once

#include <lefort/image/volume.h>

#include <string>
#include <vector>

namespace lefort::io {

/// A head scan in Hounsfield units, in L, with what the user should know of it.
///
/// No name, date, identifier or text of the patient is in it, whatever the file held.
struct ImportedVolume {
  image::CtVolume ct;
  std::vector<std::string> warnings;  ///< One sentence each; what was repaired or looks odd.
  std::string source_kind;            ///< "DICOM series", "NRRD", "NIfTI", "MetaImage", ...
};

}  // namespace lefort::io
