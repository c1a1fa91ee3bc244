/// \file
/// Writes DICOM slices for tests with GDCM, independently of lefort.
#pragma once

#include <lefort/image/volume.h>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lefort::test {

/// One file. Empty values are omitted.
struct DicomSlice {
  std::string series_uid = "1.2.826.0.1.3680043.2.1125.1";
  std::string instance_uid = "1.2.826.0.1.3680043.2.1125.1.1";
  std::string modality = "CT";
  std::string image_type = "ORIGINAL\\PRIMARY\\AXIAL";
  std::string patient_name = "DOE^JANE";
  std::string instance_number, position, orientation, pixel_spacing;
  std::string slope = "1", intercept = "-1024", gantry_tilt;
  std::uint16_t columns = 0, rows = 0, samples_per_pixel = 1;
  std::uint16_t bits_stored = 16;
  bool is_signed = true;
  std::string kernel, birth_date, patient_id, comment;
  std::string frames;
  std::vector<std::int16_t> stored;  ///< Row by row.
};

void write_dicom(const std::filesystem::path& file, const DicomSlice& slice);

/// The slices of `ct`, each stored as (HU - intercept) / slope.
[[nodiscard]] std::vector<DicomSlice> dicom_slices(const image::CtVolume& ct, double slope = 1.0,
                                                   double intercept = -1024.0);

/// Writes slice-000.dcm, ... into `folder`, which is created.
void write_dicom_series(const std::filesystem::path& folder, const std::vector<DicomSlice>& slices);

enum class Codec { kJpegLossless, kJpegLs, kJpeg2000, kRle };

/// Rewrites a file with losslessly compressed pixels.
void compress_dicom(const std::filesystem::path& file, Codec codec = Codec::kJpegLossless);

}  // namespace lefort::test
