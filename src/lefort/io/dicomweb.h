/// \file
/// A CT straight from a PACS, by DICOMweb: QIDO-RS finds the series, WADO-RS fetches it (PS3.18).
#pragma once

#include <lefort/core/error.h>
#include <lefort/core/progress.h>
#include <lefort/io/dicom.h>
#include <lefort/io/imported_volume.h>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::io {

/// Who asks a server; empty for nobody.
struct Credentials {
  std::string user{}, password{};
};

/// What a server may send before we stop listening, whatever it means by it.
struct DicomWebLimits {
  std::size_t list_bytes = std::size_t{16} << 20;  ///< Of a list; in memory up to 20 times that.
  std::uint64_t series_bytes = std::uint64_t{16} << 30;  ///< Of a series, on the disk.
  std::uint64_t image_bytes = std::uint64_t{2} << 30;
  Index images = 100'000;
  std::chrono::seconds idle_timeout{30};
  std::chrono::seconds total_timeout{3600};  ///< For one request.
};

/// Whether `source` begins with dicomweb:// or dicomwebs://.
[[nodiscard]] bool is_dicomweb(std::string_view source);

/// Reads one series of a study from
/// dicomweb[s]://[user[:password]@]host[:port][/root]/studies/UID[/series/UID].
///
/// The port is 80, or 443 for dicomwebs://, whose certificate must be one the system trusts. The
/// images are kept in a private temporary folder while they are read, and then go through
/// read_dicom_series(). The server must send as many as it says the series has.
///
/// \param credentials  unless the address has some.
/// \param series       as list_dicomweb() counts; 0: the only CT of the study.
/// \returns the scan, or, with a message that names neither patient, study nor password,
///   - kInvalidArgument  an address we do not understand, or several series and none chosen;
///   - kFileNotFound     no server answers, or it has no such study or series;
///   - kFileUnsupported  it refuses the password, or speaks something else;
///   - kFileCorrupt      the connection was lost, images are missing or of another series, or a
///                       limit is passed;
///   - the errors of read_dicom_series().
[[nodiscard]] Result<ImportedVolume> read_dicomweb(const std::string& address,
                                                   const Credentials& credentials, int series = 0,
                                                   Progress& progress = Progress::none(),
                                                   const DicomWebLimits& limits = {});

/// Lists the series of the study, in the order of their identifiers, as list_dicom_series() would
/// in a folder of them, without fetching an image.
[[nodiscard]] Result<std::vector<DicomSeriesInfo>> list_dicomweb(
    const std::string& address, const Credentials& credentials,
    Progress& progress = Progress::none(), const DicomWebLimits& limits = {});

}  // namespace lefort::io
