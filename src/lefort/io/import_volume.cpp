#include <lefort/io/dicom.h>
#include <lefort/io/import_volume.h>
#include <lefort/io/inv3.h>
#include <lefort/io/volume_files.h>

#include <cctype>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

bool ends_in_inv3(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".inv3";
}

}  // namespace

Result<ImportedVolume> import_volume(const fs::path& source, const ImportOptions& options,
                                     Progress& progress) {
  if (is_dicomweb(source.string()))
    return read_dicomweb(source.string(), options.credentials, options.series, progress);
  std::error_code error;
  const fs::file_status status = fs::status(source, error);
  if (!fs::exists(status))
    return fail(ErrorCode::kFileNotFound, "the scan does not exist: no such file or folder");
  if (fs::is_directory(status)) return read_dicom_series(source, options.series, progress);
  if (ends_in_inv3(source)) return read_inv3(source, progress);
  if (is_volume_file(source)) return read_volume(source, progress);
  return fail(
      ErrorCode::kFileUnsupported,
      "the scan has an unsupported format, expected a folder of DICOM files, .nrrd, .nhdr, .nii, "
      ".nii.gz, .mha, .mhd or .inv3");
}

Result<std::vector<DicomSeriesInfo>> list_scans(const fs::path& source,
                                                const ImportOptions& options, Progress& progress) {
  if (is_dicomweb(source.string()))
    return list_dicomweb(source.string(), options.credentials, progress);
  std::error_code error;
  if (!fs::is_directory(source, error))
    return fail(ErrorCode::kFileUnsupported,
                "the scan is not a folder of DICOM files, so it has no series to list");
  return list_dicom_series(source, progress);
}

Result<ImportedVolume> import_volume(const fs::path& source, Progress& progress) {
  return import_volume(source, ImportOptions{}, progress);
}

}  // namespace lefort::io
