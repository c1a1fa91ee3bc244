#include <lefort/core/check.h>
#include <lefort/image/check_grid.h>
#include <lefort/io/internal/raw_volume.h>
#include <lefort/io/internal/silence_libraries.h>
#include <lefort/io/internal/volume_header.h>
#include <lefort/io/internal/write_nrrd.h>
#include <lefort/io/write_atomically.h>

// ITK contains an older Eigen, which conflicts with the system's unless that is included first.
#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <itkImageIOBase.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <exception>
#include <new>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

using Component = itk::CommonEnums::IOComponent;

struct Ending {
  const char* text;
  VolumeFormat format;
  bool one_file;  ///< Header and voxels in one file: can be written.
};

constexpr std::array<Ending, 7> kEndings{{
    {".nrrd", VolumeFormat::kNrrd, true},
    {".nhdr", VolumeFormat::kNrrd, false},
    {".nii", VolumeFormat::kNifti, true},
    {".nii.gz", VolumeFormat::kNifti, true},
    {".mha", VolumeFormat::kMetaImage, true},
    {".mhd", VolumeFormat::kMetaImage, false},
    {"", VolumeFormat::kNone, false},
}};

std::string lower_case(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

const Ending& volume_ending(const fs::path& file) {
  const std::string name = lower_case(file.filename().string());
  return *std::find_if(kEndings.begin(), kEndings.end(),
                       [&](const Ending& ending) { return name.ends_with(ending.text); });
}

/// Created without ITK's factories, whose static registration objects are lost in a static library.
itk::ImageIOBase::Pointer make_image_io(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::kNifti:
      return itk::NiftiImageIO::New().GetPointer();
    case VolumeFormat::kMetaImage:
      return itk::MetaImageIO::New().GetPointer();
    default:
      break;
  }
  LEFORT_CHECK(!"unknown format");
  return nullptr;
}

Component component_type(ScalarType type) {
  switch (type) {
    case ScalarType::kUint8:
      return Component::UCHAR;
    case ScalarType::kInt16:
      return Component::SHORT;
    case ScalarType::kFloat:
      return Component::FLOAT;
    default:
      break;
  }
  LEFORT_CHECK(!"this type is not written");
  return Component::UNKNOWNCOMPONENTTYPE;
}

// Messages contain the format of the file but not its name, which may be that of a patient.
Error in_file(VolumeFormat format, const Error& error) {
  return {error.code, fmt::format("{} file: {}", name_of(format), error.message)};
}

Result<RawVolume> read_by_format(const fs::path& file, VolumeFormat format, Progress& progress) {
  if (format == VolumeFormat::kNifti) return read_nifti(file, progress);
  LEFORT_TRY(VolumeHeader header,
             format == VolumeFormat::kNrrd ? read_nrrd_header(file) : read_metaimage_header(file));
  LEFORT_TRY_VOID(check_either_hand(header.volume.grid));
  if (header.volume.components < 1 || header.volume.components > 256)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the voxels have {} values, expected 1", header.volume.components));
  LEFORT_TRY_VOID(read_voxels(header, progress));
  return std::move(header.volume);
}

}  // namespace

VolumeFormat volume_format(const fs::path& file) { return volume_ending(file).format; }

const char* name_of(VolumeFormat format) {
  switch (format) {
    case VolumeFormat::kNrrd:
      return "NRRD";
    case VolumeFormat::kNifti:
      return "NIfTI";
    case VolumeFormat::kMetaImage:
      return "MetaImage";
    case VolumeFormat::kNone:
      break;
  }
  return "unknown";
}

Result<RawVolume> read_raw_volume(const fs::path& file, Progress& progress) {
  const VolumeFormat format = volume_format(file);
  if (format == VolumeFormat::kNone)
    return fail(ErrorCode::kFileUnsupported,
                "the file must end in .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd");
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    return tl::unexpected(in_file(
        format, {ErrorCode::kFileNotFound, "the file does not exist or is not a regular file"}));
  Result<RawVolume> raw = read_by_format(file, format, progress);
  if (!raw) return tl::unexpected(in_file(format, raw.error()));
  return raw;
}

namespace {

Error disk_error(const fs::path& target) {
  return {ErrorCode::kFileUnwritable,
          fmt::format("{} cannot be written: the disk is full or failing", target.string())};
}

/// Writes NIfTI and MetaImage.
void write_by_itk(const fs::path& file, VolumeFormat format, const RawVolumeView& volume) {
  const SilenceLibraries silence;
  const itk::ImageIOBase::Pointer io = make_image_io(format);
  io->SetFileName(file.string());
  io->SetNumberOfDimensions(3);
  itk::ImageIORegion all(3);
  for (unsigned axis = 0; axis < 3; ++axis) {
    const auto size = static_cast<itk::SizeValueType>(volume.grid.size[axis]);
    const Vec3 column = volume.grid.direction.col(axis);
    io->SetDimensions(axis, size);
    io->SetSpacing(axis, volume.grid.spacing_mm[axis]);
    io->SetOrigin(axis, volume.grid.origin_L[axis]);
    io->SetDirection(axis, std::vector<double>(column.begin(), column.end()));
    all.SetIndex(axis, 0);
    all.SetSize(axis, size);
  }
  io->SetPixelType(itk::CommonEnums::IOPixel::SCALAR);
  io->SetNumberOfComponents(1);
  io->SetComponentType(component_type(volume.type));
  io->SetIORegion(all);
  io->SetUseCompression(true);
  io->Write(volume.values);
}

}  // namespace

Result<void> write_raw_volume(const fs::path& target, const RawVolumeView& volume) {
  const Ending& ending = volume_ending(target);
  if (!ending.one_file)
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("output file {} must end in .nrrd, .nii.gz, .nii or .mha", target.string()));
  if (auto good = image::check_grid(volume.grid); !good)
    return fail(ErrorCode::kInvalidArgument, good.error().message);

  return write_atomically(target, [&](const fs::path& temporary) -> Result<void> {
    if (ending.format == VolumeFormat::kNrrd) {
      if (!write_nrrd(temporary, volume)) return tl::unexpected(disk_error(target));
      return {};
    }
    write_by_itk(temporary, ending.format, volume);
    // ITK's writers do not report a full disk, so the file is read back.
    if (!read_raw_volume(temporary)) return tl::unexpected(disk_error(target));
    return {};
  });
}

}  // namespace lefort::io
