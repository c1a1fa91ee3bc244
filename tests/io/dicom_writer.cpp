#include "io/dicom_writer.h"

#include <fmt/format.h>
#include <gdcmDataElement.h>
#include <gdcmImageChangeTransferSyntax.h>
#include <gdcmImageReader.h>
#include <gdcmImageWriter.h>
#include <gdcmWriter.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

namespace lefort::test {

namespace {

void insert(gdcm::DataSet& data, std::uint16_t group, std::uint16_t element, gdcm::VR vr,
            std::string bytes) {
  if (bytes.empty()) return;
  if (bytes.size() % 2 == 1) bytes.push_back(vr == gdcm::VR::UI ? '\0' : ' ');
  gdcm::DataElement item(gdcm::Tag(group, element));
  item.SetVR(vr);
  item.SetByteValue(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  data.Replace(item);
}

std::string binary(std::uint16_t number) {
  std::string bytes(2, '\0');
  std::memcpy(bytes.data(), &number, 2);
  return bytes;
}

std::string binary(const std::vector<std::int16_t>& numbers) {
  std::string bytes(numbers.size() * 2, '\0');
  std::memcpy(bytes.data(), numbers.data(), bytes.size());
  return bytes;
}

}  // namespace

void write_dicom(const std::filesystem::path& file, const DicomSlice& slice) {
  using gdcm::VR;
  gdcm::Writer writer;
  gdcm::File& dicom = writer.GetFile();
  dicom.GetHeader().SetDataSetTransferSyntax(gdcm::TransferSyntax::ExplicitVRLittleEndian);
  gdcm::DataSet& data = dicom.GetDataSet();
  insert(data, 0x0008, 0x0008, VR::CS, slice.image_type);
  insert(data, 0x0008, 0x0016, VR::UI, "1.2.840.10008.5.1.4.1.1.2");
  insert(data, 0x0008, 0x0018, VR::UI, slice.instance_uid);
  insert(data, 0x0008, 0x0060, VR::CS, slice.modality);
  insert(data, 0x0010, 0x0010, VR::PN, slice.patient_name);
  insert(data, 0x0008, 0x0020, VR::DA, slice.birth_date);  // Also of the study.
  insert(data, 0x0010, 0x0020, VR::LO, slice.patient_id);
  insert(data, 0x0010, 0x0030, VR::DA, slice.birth_date);
  insert(data, 0x0020, 0x4000, VR::LT, slice.comment);
  insert(data, 0x0018, 0x1210, VR::SH, slice.kernel);
  insert(data, 0x0018, 0x1120, VR::DS, slice.gantry_tilt);
  insert(data, 0x0020, 0x000d, VR::UI, "1.2.826.0.1.3680043.2.1125.9");
  insert(data, 0x0020, 0x000e, VR::UI, slice.series_uid);
  insert(data, 0x0020, 0x0013, VR::IS, slice.instance_number);
  insert(data, 0x0020, 0x0032, VR::DS, slice.position);
  insert(data, 0x0020, 0x0037, VR::DS, slice.orientation);
  insert(data, 0x0028, 0x0008, VR::IS, slice.frames);
  insert(data, 0x0028, 0x0030, VR::DS, slice.pixel_spacing);
  insert(data, 0x0028, 0x1052, VR::DS, slice.intercept);
  insert(data, 0x0028, 0x1053, VR::DS, slice.slope);
  if (slice.columns > 0) {
    insert(data, 0x0028, 0x0002, VR::US, binary(slice.samples_per_pixel));
    insert(data, 0x0028, 0x0004, VR::CS, "MONOCHROME2");
    insert(data, 0x0028, 0x0010, VR::US, binary(slice.rows));
    insert(data, 0x0028, 0x0011, VR::US, binary(slice.columns));
    insert(data, 0x0028, 0x0100, VR::US, binary(16));
    insert(data, 0x0028, 0x0101, VR::US, binary(slice.bits_stored));
    insert(data, 0x0028, 0x0102, VR::US, binary(std::uint16_t(slice.bits_stored - 1)));
    insert(data, 0x0028, 0x0103, VR::US, binary(slice.is_signed ? 1 : 0));
    insert(data, 0x7fe0, 0x0010, VR::OW, binary(slice.stored));
  }
  writer.SetFileName(file.c_str());
  ASSERT_TRUE(writer.Write());
}

std::vector<DicomSlice> dicom_slices(const image::CtVolume& ct, double slope, double intercept) {
  const image::Grid& grid = ct.grid;
  const auto text = [](const Vec3& v) {
    return fmt::format("{:.9g}\\{:.9g}\\{:.9g}", v.x(), v.y(), v.z());
  };
  std::vector<DicomSlice> slices;
  for (Index k = 0; k < grid.size[2]; ++k) {
    DicomSlice slice;
    slice.instance_uid = fmt::format("1.2.826.0.1.3680043.2.1125.1.{}", k + 1);
    slice.instance_number = fmt::format("{}", k + 11);
    slice.position = text(grid.point_L(Vec3(0.0, 0.0, static_cast<double>(k))));
    slice.orientation = text(grid.direction.col(0)) + "\\" + text(grid.direction.col(1));
    slice.pixel_spacing = fmt::format("{}\\{}", grid.spacing_mm.y(), grid.spacing_mm.x());
    slice.slope = fmt::format("{}", slope);
    slice.intercept = fmt::format("{}", intercept);
    slice.columns = static_cast<std::uint16_t>(grid.size[0]);
    slice.rows = static_cast<std::uint16_t>(grid.size[1]);
    for (Index j = 0; j < grid.size[1]; ++j)
      for (Index i = 0; i < grid.size[0]; ++i)
        slice.stored.push_back(
            static_cast<std::int16_t>(std::lround((ct.at(i, j, k) - intercept) / slope)));
    slices.push_back(slice);
  }
  return slices;
}

void write_dicom_series(const std::filesystem::path& folder,
                        const std::vector<DicomSlice>& slices) {
  std::filesystem::create_directories(folder);
  for (std::size_t n = 0; n < slices.size(); ++n)
    write_dicom(folder / fmt::format("slice-{:03}.dcm", n), slices[n]);
}

void compress_dicom(const std::filesystem::path& file, Codec codec) {
  const auto syntax = [&] {
    switch (codec) {
      case Codec::kJpegLs:
        return gdcm::TransferSyntax::JPEGLSLossless;
      case Codec::kJpeg2000:
        return gdcm::TransferSyntax::JPEG2000Lossless;
      case Codec::kRle:
        return gdcm::TransferSyntax::RLELossless;
      default:
        return gdcm::TransferSyntax::JPEGLosslessProcess14_1;
    }
  };
  gdcm::ImageReader reader;
  reader.SetFileName(file.c_str());
  ASSERT_TRUE(reader.Read());
  gdcm::ImageChangeTransferSyntax change;
  change.SetTransferSyntax(syntax());
  change.SetInput(reader.GetImage());
  ASSERT_TRUE(change.Change());
  gdcm::ImageWriter writer;
  writer.SetFile(reader.GetFile());
  writer.SetImage(change.GetOutput());
  writer.SetFileName(file.c_str());
  ASSERT_TRUE(writer.Write());
}

}  // namespace lefort::test
