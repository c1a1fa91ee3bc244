#include <lefort/io/internal/run_in_child.h>
#include <lefort/io/internal/volume_header.h>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace lefort::io {
namespace {

const std::string kVoxels = "the voxels";
/// Of the largest grid (image/check_grid.h) with values of eight bytes.
constexpr std::uint64_t kMaxVoxelBytes = std::uint64_t{8} << 31;
constexpr std::size_t kNiftiChunk = 1 << 20;
/// Relative tolerance of lengths and tolerance of angles, since files round both.
constexpr double kFormTolerance = 1e-3;
/// Max difference between the positions of a voxel by qform and sform [voxels].
constexpr double kMaxDistanceVoxels = 0.5;

/// Positions of the voxels in RAS.
struct NiftiPlace {
  Mat3 axes_mm;     ///< Columns: steps between voxels along i, j, k.
  Vec3 origin_RAS;  ///< Of voxel (0, 0, 0).
  [[nodiscard]] Vec3 at(const Vec3& index_V) const { return origin_RAS + axes_mm * index_V; }
};

/// The header of a NIfTI-1 file; offsets as in nifti1.h.
class NiftiHeader {
 public:
  static constexpr std::size_t kSize = 348;

  explicit NiftiHeader(const std::array<char, kSize>& bytes) : bytes_(bytes) {
    swapped_ = number<std::int32_t>(0) != std::int32_t{kSize};
  }

  [[nodiscard]] bool is_valid() const {
    return number<std::int32_t>(0) == std::int32_t{kSize} &&
           std::string_view(bytes_.data() + 344, 4) == std::string_view("n+1\0", 4);
  }
  [[nodiscard]] std::int16_t datatype() const { return number<std::int16_t>(70); }
  [[nodiscard]] bool is_swapped() const { return swapped_; }
  [[nodiscard]] int dimensions() const { return number<std::int16_t>(40); }
  [[nodiscard]] double scale() const { return real(112); }
  [[nodiscard]] double offset() const { return real(116); }
  /// The sform of the scanner, or the only one, as ITK prefers it.
  [[nodiscard]] NiftiPlace place() const {
    const std::int16_t code = number<std::int16_t>(254);
    return code == 1 || !has_qform() ? sform() : qform();
  }
  [[nodiscard]] bool has_qform() const { return number<std::int16_t>(252) > 0; }
  [[nodiscard]] bool has_sform() const { return number<std::int16_t>(254) > 0; }
  [[nodiscard]] double voxel_offset() const { return real(108); }
  [[nodiscard]] bool is_in_mm() const {  // Or unknown, as in many files.
    const int unit = bytes_[123] & 7;
    return unit == 2 || unit == 0;
  }
  [[nodiscard]] bool has_finite_scale() const {
    return std::isfinite(real(112)) && std::isfinite(real(116));
  }
  [[nodiscard]] Index size(std::size_t axis) const {
    return static_cast<std::int16_t>(axis) < number<std::int16_t>(40)
               ? number<std::int16_t>(42 + 2 * axis)
               : 1;
  }
  [[nodiscard]] Vec3 spacing_mm() const { return {real(80), real(84), real(88)}; }

  [[nodiscard]] NiftiPlace sform() const {
    NiftiPlace place;
    for (Index row = 0; row < 3; ++row) {
      const auto at = static_cast<std::size_t>(280 + 16 * row);
      place.axes_mm.row(row) << real(at), real(at + 4), real(at + 8);
      place.origin_RAS[row] = real(at + 12);
    }
    return place;
  }
  /// From the quaternion's b, c, d; qfac in pixdim[0] reverses the slices.
  [[nodiscard]] NiftiPlace qform() const {
    const Vec3 bcd(real(256), real(260), real(264));
    const double a = std::sqrt(std::max(0.0, 1.0 - bcd.squaredNorm()));
    Mat3 axes = Eigen::Quaterniond(a, bcd[0], bcd[1], bcd[2]).normalized().toRotationMatrix();
    if (real(76) < 0.0) axes.col(2) *= -1.0;
    return {axes * spacing_mm().asDiagonal(), Vec3(real(268), real(272), real(276))};
  }

  /// Number of dimensions without those of one voxel beyond the third; 0 if a size is invalid.
  [[nodiscard]] int used_dimensions() const {
    if (dimensions() < 1 || dimensions() > 7) return 0;
    int used = 1;
    for (int d = 1; d <= dimensions(); ++d) {
      const std::int16_t size = number<std::int16_t>(40 + 2 * static_cast<std::size_t>(d));
      if (size < 1) return 0;
      if (size > 1) used = d;
    }
    return std::max(used, std::min(dimensions(), 3));
  }

 private:
  [[nodiscard]] double real(std::size_t at) const { return static_cast<double>(number<float>(at)); }

  template <class T>
  [[nodiscard]] T number(std::size_t at) const {
    std::array<char, sizeof(T)> cell;
    std::copy_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at), sizeof(T), cell.begin());
    if (swapped_) std::reverse(cell.begin(), cell.end());
    T value;
    std::memcpy(&value, cell.data(), sizeof(T));
    return value;
  }

  std::array<char, kSize> bytes_;
  bool swapped_ = false;
};

/// Returns nothing for types that are not scalar numbers.
std::optional<ScalarType> nifti_type(std::int16_t datatype) {
  constexpr std::pair<int, ScalarType> kTypes[] = {
      {2, ScalarType::kUint8},    {4, ScalarType::kInt16},    {8, ScalarType::kInt32},
      {16, ScalarType::kFloat},   {64, ScalarType::kDouble},  {256, ScalarType::kInt8},
      {512, ScalarType::kUint16}, {768, ScalarType::kUint32}, {1024, ScalarType::kInt64},
      {1280, ScalarType::kUint64}};
  for (const auto& [number, type] : kTypes)
    if (number == datatype) return type;
  return std::nullopt;
}

/// Counts the values that are NaN or infinite.
std::uint64_t count_not_finite(const RawVolume& volume) {
  std::uint64_t count = 0;
  with_values(volume, [&]<class T>(std::span<const T> values) {
    if constexpr (std::is_floating_point_v<T>)
      for (const T value : values) count += std::isfinite(value) ? 0U : 1U;
  });
  return count;
}

/// Replaces the values by scale * value + offset as floats; doubles stay doubles.
Result<void> rescale(RawVolume& volume, double scale, double offset) {
  constexpr double kNoChange = std::numeric_limits<double>::epsilon();
  if (std::abs(scale) <= kNoChange ||
      (std::abs(scale - 1.0) <= kNoChange && std::abs(offset) <= kNoChange))
    return {};
  RawVolume scaled;
  scaled.type = volume.type == ScalarType::kDouble ? ScalarType::kDouble : ScalarType::kFloat;
  scaled.grid = volume.grid;
  const auto bytes = static_cast<std::size_t>(volume.value_count()) * scalar_bytes(scaled.type);
  scaled.bytes.reset(static_cast<std::byte*>(std::calloc(bytes, 1)));
  if (scaled.bytes == nullptr)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} bytes of voxels do not fit into memory", bytes));
  with_type(scaled.type, [&]<class T>(T) {
    with_values(volume, [&](const auto values) {
      for (std::size_t n = 0; n < values.size(); ++n) {
        const T value = static_cast<T>(static_cast<double>(values[n]) * scale + offset);
        std::memcpy(scaled.bytes.get() + n * sizeof(T), &value, sizeof(T));
      }
    });
  });
  volume = std::move(scaled);
  return {};
}

/// Checks that the axes of the sform have the lengths of the voxels and are orthogonal.
Result<void> check_sform(const NiftiHeader& header) {
  const NiftiPlace sform = header.sform();
  Mat3 unit = sform.axes_mm;
  for (Index axis = 0; axis < 3; ++axis) {
    const double length_mm = unit.col(axis).norm();
    const double spacing_mm = header.spacing_mm()[axis];
    if (!(std::abs(length_mm - spacing_mm) <= kFormTolerance * spacing_mm))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the voxels have {:.4g} mm along axis {} in the sform and {:.4g} mm "
                              "in the header, expected one size",
                              length_mm, axis + 1, spacing_mm));
    unit.col(axis) /= length_mm;
  }
  const double deviation = (unit.transpose() * unit - Mat3::Identity()).cwiseAbs().maxCoeff();
  if (!(deviation <= kFormTolerance))
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the axes of the sform are sheared by {:.2g}, expected right angles",
                            deviation));
  return {};
}

/// Checks that the header states the orientation of the voxels consistently.
Result<void> check_orientation(const NiftiHeader& header) {
  if (!header.has_qform() && !header.has_sform())
    return fail(
        ErrorCode::kFileUnsupported,
        "the qform and sform codes are 0, expected one of them so that left and right are known");
  if (!header.is_in_mm())
    return fail(ErrorCode::kFileUnsupported, "the unit of length is not mm, expected mm");
  for (Index axis = 0; axis < 3; ++axis)
    if (!(header.spacing_mm()[axis] > 0.0))
      return fail(ErrorCode::kFileCorrupt,
                  fmt::format("the voxels are {} mm long along axis {}, expected more than 0",
                              header.spacing_mm()[axis], axis + 1));
  if (header.has_sform()) LEFORT_TRY_VOID(check_sform(header));
  if (!header.has_qform() || !header.has_sform()) return {};
  double apart_mm = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    Vec3 corner_V;
    for (Index a = 0; a < 3; ++a)
      corner_V[a] = ((corner >> a) & 1) * static_cast<double>(header.size(std::size_t(a)) - 1);
    apart_mm =
        std::max(apart_mm, (header.sform().at(corner_V) - header.qform().at(corner_V)).norm());
  }
  if (!(apart_mm <= kMaxDistanceVoxels * header.spacing_mm().minCoeff()))
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the voxel positions of qform and sform differ by up to {:.3g} mm, "
                            "expected the same positions",
                            apart_mm));
  return {};
}

/// Checks all of the header, and returns a volume without voxels.
Result<RawVolume> volume_of(const NiftiHeader& header, std::uint64_t file_bytes) {
  const int dimensions = header.used_dimensions();
  if (!header.is_valid() || dimensions == 0 ||
      !(header.voxel_offset() >= 0.0 && header.voxel_offset() <= 1e9))
    return fail(ErrorCode::kFileCorrupt, "the header is damaged, expected that of a NIfTI file");
  if (dimensions != 3)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the image has {} dimensions, expected 3", dimensions));
  const std::optional<ScalarType> type = nifti_type(header.datatype());
  if (!type)
    return fail(
        ErrorCode::kFileUnsupported,
        fmt::format("the voxels have NIfTI type {}, expected scalar numbers", header.datatype()));
  if (!header.has_finite_scale())
    return fail(ErrorCode::kFileCorrupt,
                "the scale of the voxels is not finite, expected a number");
  LEFORT_TRY_VOID(check_orientation(header));

  RawVolume volume;
  volume.type = *type;
  const NiftiPlace place = header.place();
  for (Index axis = 0; axis < 3; ++axis)
    volume.grid.size[std::size_t(axis)] = header.size(std::size_t(axis));
  volume.grid.spacing_mm = header.spacing_mm();
  volume.grid.direction = place.axes_mm.colwise().normalized();
  volume.grid.origin_L = place.origin_RAS;
  volume.grid.direction.topRows<2>() *= -1.0;  // From RAS.
  volume.grid.origin_L.head<2>() *= -1.0;
  LEFORT_TRY_VOID(check_either_hand(volume.grid));
  const std::uint64_t bytes =
      static_cast<std::uint64_t>(volume.value_count()) * scalar_bytes(volume.type);
  if (bytes / kMaxGzipRatio > file_bytes)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the header states {} bytes of voxels, the file has {} bytes", bytes,
                            file_bytes));
  return volume;
}

/// Reads the next bytes of a gzip stream into all of `target`.
///
/// \returns the number of bytes that were read, smaller at the end of the stream.
std::uint64_t fill_from(gzFile stream, std::span<std::byte> target) {
  std::uint64_t found = 0;
  while (found < target.size()) {
    const std::size_t step = std::min(kNiftiChunk, target.size() - std::size_t(found));
    const int got = gzread(stream, target.data() + found, static_cast<unsigned>(step));
    if (got <= 0) break;
    found += static_cast<std::uint64_t>(got);
  }
  return found;
}

/// The task of a child.
Result<void> nifti_in_child(int input, std::string_view /*request*/, ResultWriter& result) {
  LEFORT_TRY(const RawVolume volume, decode_nifti(input));
  const image::Grid& grid = volume.grid;
  result.number(static_cast<std::int32_t>(volume.type));
  for (const Index size : grid.size) result.number(std::int64_t{size});
  for (const double spacing_mm : grid.spacing_mm) result.number(spacing_mm);
  for (const double coordinate : grid.origin_L) result.number(coordinate);
  for (const double cosine : grid.direction.reshaped()) result.number(cosine);
  result.bytes(volume.bytes.get(),
               static_cast<std::size_t>(volume.value_count()) * scalar_bytes(volume.type));
  return {};
}

/// Reads the result of nifti_in_child().
Result<RawVolume> take_volume(ResultReader& result) {
  const Error damaged = damaged_result(kVoxels);
  RawVolume volume;
  image::Grid& grid = volume.grid;
  std::int32_t type = -1;
  bool is_complete = result.number(type);
  for (Index& size : grid.size) is_complete = is_complete && result.number(size);
  for (double& spacing_mm : grid.spacing_mm) is_complete = is_complete && result.number(spacing_mm);
  for (double& coordinate : grid.origin_L) is_complete = is_complete && result.number(coordinate);
  for (double& cosine : grid.direction.reshaped())
    is_complete = is_complete && result.number(cosine);
  constexpr auto kLastType = static_cast<std::int32_t>(ScalarType::kDouble);
  if (!is_complete || type < 0 || type > kLastType) return tl::unexpected(damaged);
  volume.type = static_cast<ScalarType>(type);
  LEFORT_TRY_VOID(check_either_hand(grid));
  const std::size_t bytes =
      static_cast<std::size_t>(volume.value_count()) * scalar_bytes(volume.type);
  volume.bytes.reset(static_cast<std::byte*>(std::malloc(bytes)));
  if (volume.bytes == nullptr)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} bytes of voxels do not fit into memory", bytes));
  if (!result.bytes(volume.bytes.get(), bytes) || !result.at_end()) return tl::unexpected(damaged);
  return volume;
}

}  // namespace

Result<RawVolume> decode_nifti(int input) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzdopen(::dup(input), "rb"), gzclose);
  std::array<char, NiftiHeader::kSize> start{};
  if (stream == nullptr || gzread(stream.get(), start.data(), NiftiHeader::kSize) !=
                               static_cast<int>(NiftiHeader::kSize))
    return fail(ErrorCode::kFileCorrupt, "the header is incomplete, expected that of a NIfTI file");
  const NiftiHeader header(start);
  struct stat status {};
  if (::fstat(input, &status) != 0) return tl::unexpected(damaged_result(kVoxels));
  LEFORT_TRY(RawVolume volume, volume_of(header, static_cast<std::uint64_t>(status.st_size)));

  // Up to the voxels there are extensions, which are not read.
  const auto skipped = static_cast<std::uint64_t>(
      std::max(header.voxel_offset(), static_cast<double>(NiftiHeader::kSize)));
  if (gzseek(stream.get(), static_cast<z_off_t>(skipped), SEEK_SET) < 0)
    return fail(ErrorCode::kFileCorrupt, "the header is damaged, expected that of a NIfTI file");
  const std::size_t width = scalar_bytes(volume.type);
  const std::size_t bytes = static_cast<std::size_t>(volume.value_count()) * width;
  volume.bytes.reset(static_cast<std::byte*>(std::calloc(bytes, 1)));
  if (volume.bytes == nullptr)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} bytes of voxels do not fit into memory", bytes));
  const std::span<std::byte> target(volume.bytes.get(), bytes);
  const std::uint64_t found = fill_from(stream.get(), target);
  if (found < bytes) return tl::unexpected(missing_voxels(found, bytes));
  std::array<char, 4096> rest{};  // To the end of the stream, where zlib compares the checksum.
  if (gzread(stream.get(), rest.data(), static_cast<unsigned>(rest.size())) < 0)
    return fail(ErrorCode::kFileCorrupt, "the compressed voxels are damaged");
  if (header.is_swapped()) reverse_bytes(target, width);
  if (const std::uint64_t count = count_not_finite(volume); count > 0)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("{} of {} voxels are not finite numbers, expected none", count,
                            volume.value_count()));
  LEFORT_TRY_VOID(rescale(volume, header.scale(), header.offset()));
  return volume;
}

Result<RawVolume> read_nifti(const std::filesystem::path& file, Progress& progress) {
  LEFORT_TRY(const OpenedFile input, open_input(file, "the file"));
  const std::uint64_t unpacked = std::min(input.bytes * kMaxGzipRatio, kMaxVoxelBytes);
  // Voxels, those after rescaling, and a result of the same size.
  LEFORT_TRY(
      ReaderValues values,
      run_in_child(
          input.descriptor,
          {nifti_in_child, kVoxels, {}, limits_of(unpacked / kMaxInflatedPerText, 3 * unpacked)},
          progress));
  return take_volume(*values);
}

}  // namespace lefort::io
