/// \file
/// A CT from a PACS by DICOMweb: QIDO-RS lists the series, WADO-RS fetches one (DICOM PS3.18).
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

/// User name and password of a server; both empty for no authentication.
struct Credentials {
  std::string user{}, password{};
};

/// Limits of what a server may send; the transfer ends when one is exceeded.
struct DicomWebLimits {
  /// Of a list as JSON text, which needs up to 20 times as much memory when parsed.
  std::size_t list_bytes = std::size_t{16} << 20;
  std::uint64_t series_bytes = std::uint64_t{16} << 30;  ///< Of a series, on disk.
  std::uint64_t image_bytes = std::uint64_t{2} << 30;    ///< Of one image.
  Index images = 100'000;
  std::chrono::seconds idle_timeout{30};     ///< To connect, and without data.
  std::chrono::seconds total_timeout{3600};  ///< Of one request.
};

/// Whether `source` begins with dicomweb:// or dicomwebs://.
[[nodiscard]] bool is_dicomweb(std::string_view source);

/// Reads one series of a study from
/// dicomweb[s]://[user[:password]@]host[:port][/root]/studies/UID[/series/UID].
///
/// The default port is 80, or 443 for dicomwebs://. dicomwebs:// requires a certificate that the
/// system trusts. The images are stored in a private temporary folder and read by
/// read_dicom_series(). The server must send as many images as it lists for the series.
///
/// \param address      of the study or series, as above. \pre is_dicomweb(address).
/// \param credentials  used if the address contains none.
/// \param series       number in list_dicomweb() with this address, from 1; 0: the only CT series.
/// \param progress     stages, progress of the transfer, requests to stop.
/// \param limits       of what the server may send.
/// \returns the scan, or an error whose message names neither patient, study nor password:
///   - kInvalidArgument   an invalid address, no series of this number, or several CT series and
///                        none chosen;
///   - kConnectionFailed  no server answers, its certificate is not trusted, or the connection was
///                        lost or timed out;
///   - kAccessDenied      the server rejects the user name or password;
///   - kFileNotFound      the server has no such study or series;
///   - kFileUnsupported   the answer is not DICOMweb, or no series is a CT;
///   - kFileCorrupt       images are missing, repeated or of another series, or a limit is
///                        exceeded;
///   - kFileUnwritable    the temporary folder cannot be created or written;
///   - the errors of read_dicom_series().
[[nodiscard]] Result<ImportedVolume> read_dicomweb(const std::string& address,
                                                   const Credentials& credentials, int series = 0,
                                                   Progress& progress = Progress::none(),
                                                   const DicomWebLimits& limits = {});

/// Lists the series of a study, sorted by identifier as in list_dicom_series(), without fetching
/// images.
///
/// \param address      of the study, as for read_dicomweb().
/// \param credentials  used if the address contains none.
/// \param progress     stage, requests to stop.
/// \param limits       of what the server may send.
/// \returns the series, or the errors of read_dicomweb() that do not concern images.
[[nodiscard]] Result<std::vector<DicomSeriesInfo>> list_dicomweb(
    const std::string& address, const Credentials& credentials,
    Progress& progress = Progress::none(), const DicomWebLimits& limits = {});

}  // namespace lefort::io
