#include <lefort/io/internal/check_volume_file.h>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kNiftiChunk = 1 << 20;  // A multiple of every voxel's size.
constexpr std::uint64_t kMaxNiftiBytes = std::uint64_t{1} << 40;
constexpr std::int16_t kFloat32 = 16, kFloat64 = 64;
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

  /// Returns the number of voxels; nothing if the dimensions are invalid.
  [[nodiscard]] std::optional<std::uint64_t> voxel_count() const {
    const std::int16_t dimensions = number<std::int16_t>(40);
    if (dimensions < 1 || dimensions > 7) return std::nullopt;
    std::uint64_t count = 1;
    for (std::size_t d = 1; d <= static_cast<std::size_t>(dimensions); ++d) {
      const std::int16_t size = number<std::int16_t>(40 + 2 * d);
      if (size < 1) return std::nullopt;
      count *= static_cast<std::uint64_t>(size);
      if (count > kMaxNiftiBytes) return std::nullopt;
    }
    return count;
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

/// Returns the bytes per voxel, 0 for types that are not scalar numbers.
std::uint64_t nifti_voxel_bytes(std::int16_t datatype) {
  switch (datatype) {
    case 2:
    case 256:
      return 1;  // clang-format off
    case 4: case 512: return 2;
    case 8: case 16: case 768: return 4;
    case 64: case 1024: case 1280: return 8;
    default: return 0;
  }  // clang-format on
}

/// Reads the next bytes of a gzip stream into `target`; returns their number, smaller at its end.
std::uint64_t read_some(gzFile stream, std::span<char> target) {
  const int got = gzread(stream, target.data(), static_cast<unsigned>(target.size()));
  return got < 0 ? 0 : static_cast<std::uint64_t>(got);
}

/// Whether a stored floating-point number is NaN or infinite: all bits of its exponent are set.
template <class Bits, Bits kExponent>
bool is_not_finite(const char* cell, bool is_swapped) {
  std::array<char, sizeof(Bits)> bytes;
  std::copy_n(cell, sizeof(Bits), bytes.begin());
  if (is_swapped) std::reverse(bytes.begin(), bytes.end());
  Bits bits{};
  std::memcpy(&bits, bytes.data(), sizeof bits);
  return (bits & kExponent) == kExponent;
}

/// Counts the voxels in `chunk` that are NaN or infinite.
std::uint64_t count_not_finite(std::span<const char> chunk, const NiftiHeader& header) {
  std::uint64_t count = 0;
  const auto with = [&](std::size_t width, auto&& test) {
    for (std::size_t at = 0; at + width <= chunk.size(); at += width)
      count += test(chunk.data() + at, header.is_swapped()) ? 1U : 0U;
  };
  if (header.datatype() == kFloat32) with(4, is_not_finite<std::uint32_t, 0x7f800000U>);
  if (header.datatype() == kFloat64) with(8, is_not_finite<std::uint64_t, 0x7ff0000000000000U>);
  return count;
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

}  // namespace

Result<void> check_nifti(const fs::path& file) {
  const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
  std::array<char, NiftiHeader::kSize> start{};
  if (stream == nullptr || gzread(stream.get(), start.data(), NiftiHeader::kSize) !=
                               static_cast<int>(NiftiHeader::kSize))
    return fail(ErrorCode::kFileCorrupt, "the header is incomplete, expected that of a NIfTI file");
  const NiftiHeader header(start);
  const std::optional<std::uint64_t> voxels = header.voxel_count();
  const double offset = header.voxel_offset();
  if (!header.is_valid() || !voxels || !(offset >= 0.0 && offset <= 1e9))
    return fail(ErrorCode::kFileCorrupt, "the header is damaged, expected that of a NIfTI file");
  const std::uint64_t voxel_bytes = nifti_voxel_bytes(header.datatype());
  if (voxel_bytes == 0)
    return fail(
        ErrorCode::kFileUnsupported,
        fmt::format("the voxels have NIfTI type {}, expected scalar numbers", header.datatype()));

  if (!header.has_finite_scale())
    return fail(ErrorCode::kFileCorrupt,
                "the scale of the voxels is not finite, expected a number");
  LEFORT_TRY_VOID(check_orientation(header));

  std::vector<char> chunk(kNiftiChunk);
  const auto start_of_voxels = static_cast<std::uint64_t>(offset);
  const std::uint64_t wanted = start_of_voxels + *voxels * voxel_bytes;
  std::uint64_t found = NiftiHeader::kSize;
  std::uint64_t not_finite = 0;
  while (found < wanted) {
    const bool in_voxels = found >= start_of_voxels;
    const std::uint64_t end = in_voxels ? wanted : start_of_voxels;
    const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(kNiftiChunk, end - found));
    const std::uint64_t got = read_some(stream.get(), std::span(chunk).first(step));
    if (in_voxels)
      not_finite += count_not_finite(std::span(chunk).first(static_cast<std::size_t>(got)), header);
    found += got;
    if (got < step) return tl::unexpected(missing_voxels(found, wanted));
  }
  if (not_finite > 0)  // The NIfTI library returns 0 for them.
    return fail(
        ErrorCode::kFileCorrupt,
        fmt::format("{} of {} voxels are not finite numbers, expected none", not_finite, *voxels));
  // Reads to the end of the gzip stream, where zlib compares the checksum.
  if (gzread(stream.get(), chunk.data(), static_cast<unsigned>(chunk.size())) < 0)
    return fail(ErrorCode::kFileCorrupt, "the compressed voxels are damaged");
  return {};
}

}  // namespace lefort::io
