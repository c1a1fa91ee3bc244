#include <lefort/image/check_grid.h>
#include <lefort/io/internal/check_volume_file.h>
#include <lefort/io/internal/raw_volume.h>
#include <lefort/io/internal/silence_libraries.h>
#include <lefort/io/write_atomically.h>

// ITK contains an older Eigen, which conflicts with the system's unless that is included first.
#include <Eigen/Eigenvalues>
#include <fmt/format.h>
#include <itkImageIOBase.h>
#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

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
  bool one_file;  ///< Header and voxels in one file: can be written, and its size checked.
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
    case VolumeFormat::kNrrd:
      return itk::NrrdImageIO::New().GetPointer();
    case VolumeFormat::kNifti:
      return itk::NiftiImageIO::New().GetPointer();
    case VolumeFormat::kMetaImage:
      return itk::MetaImageIO::New().GetPointer();
    case VolumeFormat::kNone:
      break;
  }
  LEFORT_CHECK(!"unknown format");
  return nullptr;
}

std::optional<ScalarType> scalar_type(Component component) {
  static_assert(sizeof(long) == 8, "ITK's LONG must have 64 bits");  // NOLINT
  switch (component) {
    case Component::CHAR:
      return ScalarType::kInt8;
    case Component::UCHAR:
      return ScalarType::kUint8;
    case Component::SHORT:
      return ScalarType::kInt16;
    case Component::USHORT:
      return ScalarType::kUint16;
    case Component::INT:
      return ScalarType::kInt32;
    case Component::UINT:
      return ScalarType::kUint32;
    case Component::LONG:
    case Component::LONGLONG:
      return ScalarType::kInt64;
    case Component::ULONG:
    case Component::ULONGLONG:
      return ScalarType::kUint64;
    case Component::FLOAT:
      return ScalarType::kFloat;
    case Component::DOUBLE:
      return ScalarType::kDouble;
    default:
      return std::nullopt;
  }
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

std::map<std::string, std::string> text_fields(const itk::MetaDataDictionary& dictionary) {
  std::map<std::string, std::string> fields;
  for (const std::string& key : dictionary.GetKeys())
    if (std::string text; itk::ExposeMetaData(dictionary, key, text)) fields.emplace(key, text);
  return fields;
}

image::Grid grid_of(const itk::ImageIOBase& io) {
  image::Grid grid;
  for (unsigned axis = 0; axis < 3; ++axis) {
    grid.size[axis] = static_cast<Index>(io.GetDimensions(axis));
    grid.spacing_mm[axis] = io.GetSpacing(axis);
    grid.origin_L[axis] = io.GetOrigin(axis);
    const std::vector<double> column = io.GetDirection(axis);
    for (unsigned row = 0; row < 3; ++row) grid.direction(row, axis) = column[row];
  }
  return grid;
}

/// check_grid() that also allows left-handed grids.
Result<void> check_either_hand(image::Grid grid) {
  if (grid.direction.determinant() < 0.0) grid.direction.col(2) *= -1.0;
  return check_grid(grid);
}

// Messages contain the format of the file but not its name, which may be that of a patient.
Error in_file(VolumeFormat format, const Error& error) {
  return {error.code, fmt::format("{} file: {}", name_of(format), error.message)};
}

Error corrupt(VolumeFormat format, std::string why) {
  return in_file(format, {ErrorCode::kFileCorrupt, std::move(why)});
}

Error unsupported(VolumeFormat format, std::string why) {
  return in_file(format, {ErrorCode::kFileUnsupported, std::move(why)});
}

/// Reads the header before memory is allocated.
Result<RawVolume> read_header(itk::ImageIOBase& io, const fs::path& file, const Ending& ending) {
  Result<void> good;
  if (ending.format == VolumeFormat::kNifti) good = check_nifti(file);
  if (ending.format == VolumeFormat::kNrrd) good = check_nrrd_voxel_file(file);
  if (!good) return tl::unexpected(in_file(ending.format, good.error()));
  try {
    io.SetFileName(file.string());
    io.ReadImageInformation();
  } catch (const std::exception&) {
    return tl::unexpected(
        corrupt(ending.format, fmt::format("the header cannot be read, expected that of a {} file",
                                           name_of(ending.format))));
  }
  if (io.GetNumberOfDimensions() != 3)
    return tl::unexpected(unsupported(
        ending.format,
        fmt::format("the image has {} dimensions, expected 3", io.GetNumberOfDimensions())));
  const std::optional<ScalarType> type = scalar_type(io.GetComponentType());
  if (!type)
    return tl::unexpected(
        unsupported(ending.format, "the voxels are not numbers, expected numbers"));

  RawVolume raw;
  raw.grid = grid_of(io);
  raw.type = *type;
  raw.components = static_cast<Index>(io.GetNumberOfComponents());
  raw.fields = text_fields(io.GetMetaDataDictionary());
  if (good = check_either_hand(raw.grid); !good)
    return tl::unexpected(in_file(ending.format, good.error()));
  if (raw.components < 1 || raw.components > 256)
    return tl::unexpected(unsupported(
        ending.format, fmt::format("the voxels have {} values, expected 1", raw.components)));
  return raw;
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

Result<RawVolume> read_raw_volume(const fs::path& file) {
  const Ending& ending = volume_ending(file);
  if (ending.format == VolumeFormat::kNone)
    return fail(ErrorCode::kFileUnsupported,
                "the file must end in .nrrd, .nhdr, .nii, .nii.gz, .mha or .mhd");
  std::error_code error;
  if (!fs::is_regular_file(file, error))
    return tl::unexpected(
        in_file(ending.format,
                {ErrorCode::kFileNotFound, "the file does not exist or is not a regular file"}));
  const std::uintmax_t file_bytes = fs::file_size(file, error);

  const SilenceLibraries silence;
  const itk::ImageIOBase::Pointer io = make_image_io(ending.format);
  LEFORT_TRY(RawVolume raw, read_header(*io, file, ending));
  const auto bytes = static_cast<std::uintmax_t>(io->GetImageSizeInBytes());
  if (ending.one_file && (error || bytes / kMaxGzipRatio > file_bytes))
    return tl::unexpected(corrupt(
        ending.format, fmt::format("the header states {} bytes of voxels, the file has {} bytes",
                                   bytes, file_bytes)));
  Result<void> good;
  if (ending.format == VolumeFormat::kNrrd) good = check_nrrd(file, bytes);
  if (ending.format == VolumeFormat::kMetaImage)
    good = check_metaimage(file, bytes, raw.grid.direction);
  if (!good) return tl::unexpected(in_file(ending.format, good.error()));
  // Zeroed, so that no other memory of the process becomes voxels. The system provides zeroed pages
  // on first use, so a wrong size in the header costs no memory.
  raw.bytes.reset(static_cast<std::byte*>(std::calloc(std::max<std::size_t>(bytes, 1), 1)));
  if (raw.bytes == nullptr)
    return tl::unexpected(
        corrupt(ending.format, fmt::format("{} bytes of voxels do not fit into memory", bytes)));
  try {
    itk::ImageIORegion all(3);
    for (unsigned axis = 0; axis < 3; ++axis) {
      all.SetIndex(axis, 0);
      all.SetSize(axis, io->GetDimensions(axis));
    }
    io->SetIORegion(all);
    io->Read(raw.bytes.get());
  } catch (const std::bad_alloc&) {
    return tl::unexpected(corrupt(ending.format, "the voxels do not fit into memory"));
  } catch (const std::exception&) {
    return tl::unexpected(
        corrupt(ending.format, "the voxels cannot be read: truncated or damaged"));
  }
  return raw;
}

Result<void> write_raw_volume(const fs::path& target, const RawVolumeView& volume) {
  const Ending& ending = volume_ending(target);
  if (!ending.one_file)
    return fail(
        ErrorCode::kInvalidArgument,
        fmt::format("output file {} must end in .nrrd, .nii.gz, .nii or .mha", target.string()));
  if (auto good = image::check_grid(volume.grid); !good)
    return fail(ErrorCode::kInvalidArgument, good.error().message);

  return write_atomically(target, [&](const fs::path& temporary) -> Result<void> {
    const SilenceLibraries silence;
    const itk::ImageIOBase::Pointer io = make_image_io(ending.format);
    io->SetFileName(temporary.string());
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
    for (const auto& [key, text] : volume.fields)
      itk::EncapsulateMetaData<std::string>(io->GetMetaDataDictionary(), key, text);
    io->Write(volume.values);
    // ITK's writers do not report a full disk, so the file is read back.
    if (!read_raw_volume(temporary))
      return fail(
          ErrorCode::kFileUnwritable,
          fmt::format("{} cannot be written: the disk is full or failing", target.string()));
    return {};
  });
}

}  // namespace lefort::io
