#include <lefort/io/internal/dicom_codec.h>
#include <lefort/io/internal/dicom_file.h>
#include <lefort/io/internal/dicom_header.h>
#include <lefort/io/read_text.h>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <utility>

namespace lefort::io {
namespace fs = std::filesystem;

namespace {

constexpr DicomTag kImageType = 0x00080008;
constexpr DicomTag kInstanceUid = 0x00080018;
constexpr DicomTag kModality = 0x00080060;
constexpr DicomTag kKernel = 0x00181210;
constexpr DicomTag kGantryTilt = 0x00181120;
constexpr DicomTag kSeriesUid = 0x0020000e;
constexpr DicomTag kInstanceNumber = 0x00200013;
constexpr DicomTag kPosition = 0x00200032;
constexpr DicomTag kOrientation = 0x00200037;
constexpr DicomTag kSamplesPerPixel = 0x00280002;
constexpr DicomTag kFrames = 0x00280008;
constexpr DicomTag kRows = 0x00280010;
constexpr DicomTag kColumns = 0x00280011;
constexpr DicomTag kPixelSpacing = 0x00280030;
constexpr DicomTag kBitsAllocated = 0x00280100;
constexpr DicomTag kBitsStored = 0x00280101;
constexpr DicomTag kHighBit = 0x00280102;
constexpr DicomTag kPixelRepresentation = 0x00280103;
constexpr DicomTag kRescaleIntercept = 0x00281052;
constexpr DicomTag kRescaleSlope = 0x00281053;

constexpr std::uintmax_t kMaxDicomBytes = std::uintmax_t{2} << 30;

Error in_file(const DicomHeader& header, const Error& error) {
  return {error.code, fmt::format("DICOM {}: {}", name_of(header), error.message)};
}

/// read_text() without the file name in its message.
Result<std::string> read_bytes(const DicomHeader& header) {
  auto bytes = read_text(header.file, kMaxDicomBytes);
  if (!bytes)
    return tl::unexpected(in_file(
        header, {bytes.error().code,
                 fmt::format("it cannot be read, or has more than {} bytes", kMaxDicomBytes)}));
  return bytes;
}

/// Returns the text of a tag without padding; empty if it is missing.
std::string_view text_of(const DicomElements& elements, DicomTag tag) {
  const auto found = elements.values.find(tag);
  if (found == elements.values.end()) return "";
  return found->second.substr(0, found->second.find_last_not_of(std::string_view(" \0", 2)) + 1);
}

/// Returns the decimal numbers of a tag, separated by backslashes; none if one is invalid.
std::vector<double> numbers_of(const DicomElements& elements, DicomTag tag) {
  const std::string_view text = text_of(elements, tag);
  std::vector<double> numbers;
  for (std::size_t at = 0; at < text.size() && numbers.size() < 16;) {
    const std::size_t end = std::min(text.find('\\', at), text.size());
    const std::size_t first = std::min(text.find_first_not_of(" +", at), end);
    double number = 0.0;
    const auto [rest, error] = std::from_chars(text.data() + first, text.data() + end, number);
    const bool only_spaces = std::all_of(rest, text.data() + end, [](char c) { return c == ' '; });
    if (error != std::errc() || !only_spaces) return {};
    numbers.push_back(number);
    at = end + 1;
  }
  return numbers;
}

Index uint16_of(const DicomElements& elements, DicomTag tag, Index otherwise) {
  const auto found = elements.values.find(tag);
  if (found == elements.values.end() || found->second.size() < 2) return otherwise;
  std::uint16_t number = 0;
  std::memcpy(&number, found->second.data(), sizeof number);
  return number;
}

/// Modalities are codes in capitals. Anything else could be a name in the wrong tag.
std::string modality_of(const DicomElements& elements) {
  const std::string_view text = text_of(elements, kModality);
  const bool is_word =
      text.size() >= 2 && text.size() <= 10 &&
      std::all_of(text.begin(), text.end(), [](char c) { return c >= 'A' && c <= 'Z'; });
  return is_word ? std::string(text) : "unknown";
}

/// Kernels have names such as "H60s", "BONE" or "B30f". Anything longer could be a name of a
/// person.
std::string kernel_of(const DicomElements& elements) {
  const std::string_view text = text_of(elements, kKernel);
  const bool is_code =
      text.size() <= 8 && std::all_of(text.begin(), text.end(), [](char c) {
        return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9');
      });
  return is_code ? std::string(text) : "";
}

/// Sets the members of `header` from the elements.
DicomHeader header_from(const DicomElements& elements, DicomHeader header) {
  header.series_uid = text_of(elements, kSeriesUid);
  header.instance_uid = text_of(elements, kInstanceUid);
  header.modality = modality_of(elements);
  header.kernel = kernel_of(elements);
  header.is_localizer = text_of(elements, kImageType).find("LOCALIZER") != std::string_view::npos;
  header.columns = uint16_of(elements, kColumns, 0);
  header.rows = uint16_of(elements, kRows, 0);
  header.samples_per_pixel = uint16_of(elements, kSamplesPerPixel, 1);
  const auto number = [&](DicomTag tag) -> std::optional<double> {
    const std::vector<double> numbers = numbers_of(elements, tag);
    return numbers.size() == 1 ? std::optional(numbers[0]) : std::nullopt;
  };
  if (const double frames = number(kFrames).value_or(1.0); frames > 1.0 && frames < 1e9)
    header.frames = static_cast<Index>(frames);
  if (const auto n = number(kInstanceNumber); n && std::abs(*n) < 1e9)
    header.slice_number = static_cast<Index>(*n);
  if (const auto p = numbers_of(elements, kPosition); p.size() == 3)
    header.position_L = Vec3(p[0], p[1], p[2]);
  if (const auto o = numbers_of(elements, kOrientation); o.size() == 6)
    header.axes_L = {Vec3(o[0], o[1], o[2]), Vec3(o[3], o[4], o[5])};
  if (const auto s = numbers_of(elements, kPixelSpacing); s.size() == 2)
    header.pixel_spacing_mm = {s[1], s[0]};  // The tag contains the distance of rows first.
  header.rescale_slope = number(kRescaleSlope);
  header.rescale_intercept = number(kRescaleIntercept);
  header.gantry_tilt_deg = number(kGantryTilt).value_or(0.0);
  return header;
}

bool named_dicom(const fs::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return ending == ".dcm" || ending == ".ima" || ending == ".dicom";
}

/// Position of a stored value in its cell (PS3.5, section 8.1.1).
struct PixelCell {
  Index bits_allocated, bits_stored, high_bit;
  bool is_signed;
};

/// Extracts the stored bits from cells of type T.
template <class T>
std::vector<double> unpack(std::string_view pixels, std::size_t count, const PixelCell& cell) {
  const auto shift = static_cast<int>(cell.high_bit + 1 - cell.bits_stored);
  const std::uint64_t sign_bit = std::uint64_t{1} << (cell.bits_stored - 1);
  const std::uint64_t mask = 2 * sign_bit - 1;
  std::vector<double> values(count);
  for (std::size_t n = 0; n < count; ++n) {
    T bits{};
    std::memcpy(&bits, pixels.data() + n * sizeof(T), sizeof(T));
    const std::uint64_t stored = (std::uint64_t{bits} >> shift) & mask;
    const bool is_negative = cell.is_signed && (stored & sign_bit) != 0;
    values[n] =
        static_cast<double>(stored) - (is_negative ? 2.0 * static_cast<double>(sign_bit) : 0.0);
  }
  return values;
}

Result<std::vector<double>> unpack_pixels(const DicomElements& elements, std::size_t count) {
  const Index allocated = uint16_of(elements, kBitsAllocated, 16);
  const Index stored = uint16_of(elements, kBitsStored, allocated);
  const PixelCell cell{allocated, stored, uint16_of(elements, kHighBit, stored - 1),
                       uint16_of(elements, kPixelRepresentation, 0) == 1};
  const bool is_whole = allocated == 8 || allocated == 16 || allocated == 32;
  if (!is_whole || stored < 1 || stored > cell.high_bit + 1 || cell.high_bit >= allocated)
    return fail(ErrorCode::kFileUnsupported,
                fmt::format("the pixels have {} of {} bits, expected cells of 8, 16 or 32 bits",
                            stored, allocated));
  if (elements.pixels.size() < count * static_cast<std::size_t>(allocated / 8))
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the pixels have {} bytes, expected {}", elements.pixels.size(),
                            count * static_cast<std::size_t>(allocated / 8)));
  if (allocated == 8) return unpack<std::uint8_t>(elements.pixels, count, cell);
  if (allocated == 16) return unpack<std::uint16_t>(elements.pixels, count, cell);
  return unpack<std::uint32_t>(elements.pixels, count, cell);
}

}  // namespace

std::string name_of(const DicomHeader& header) {
  if (!header.slice_number) return fmt::format("file {}", header.file_number);
  return fmt::format("slice {} (file {})", *header.slice_number, header.file_number);
}

Result<std::optional<DicomHeader>> read_dicom_header(const fs::path& file, Index file_number) {
  DicomHeader header;
  header.file = file;
  header.file_number = file_number;
  if (!has_dicom_magic(file)) {
    if (!named_dicom(file)) return std::nullopt;
    return tl::unexpected(
        in_file(header, {ErrorCode::kFileCorrupt, "it is truncated or not a DICOM file"}));
  }
  LEFORT_TRY(const std::string bytes, read_bytes(header));
  const DicomElements elements = parse_dicom(bytes);
  header = header_from(elements, std::move(header));
  std::optional<Error> damage = elements.damage;
  if (!damage && header.columns > 0 && elements.pixels.empty())  // Truncated between two elements.
    damage = Error{ErrorCode::kFileCorrupt, "it is truncated, it ends before its pixels"};
  if (!damage) return header;
  header.damage = in_file(header, *damage);
  if (header.series_uid.empty()) return tl::unexpected(*std::move(header.damage));
  return header;
}

Result<std::vector<double>> read_dicom_pixels(const DicomHeader& header, Progress& progress) {
  LEFORT_TRY(const std::string bytes, read_bytes(header));
  const DicomElements elements = parse_dicom(bytes);
  if (elements.damage) return tl::unexpected(in_file(header, *elements.damage));
  const auto count = static_cast<std::size_t>(header.columns * header.rows);
  auto pixels = elements.is_compressed ? decode_dicom_pixels(header.file, count, progress)
                                       : unpack_pixels(elements, count);
  if (!pixels) return tl::unexpected(in_file(header, pixels.error()));
  return pixels;
}

}  // namespace lefort::io
