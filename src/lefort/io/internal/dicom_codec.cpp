#include <lefort/io/internal/dicom_codec.h>
#include <lefort/io/internal/run_in_child.h>

#include <fmt/format.h>
#include <gdcmImage.h>
#include <gdcmImageReader.h>
#include <gdcmPixelFormat.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <sstream>
#include <string>
#include <utility>

namespace lefort::io {

namespace {

const std::string kPixels = "the compressed pixels";

template <class T>
Result<void> write_as(const std::vector<char>& bytes, std::uint64_t pixels, ResultWriter& result) {
  if (bytes.size() != pixels * sizeof(T)) return tl::unexpected(damaged_result(kPixels));
  std::vector<double> values(static_cast<std::size_t>(pixels));
  for (std::size_t n = 0; n < values.size(); ++n) {
    T value{};
    std::memcpy(&value, bytes.data() + n * sizeof(T), sizeof(T));
    values[n] = static_cast<double>(value);
  }
  result.array(std::span<const double>(values));
  return {};
}

/// The task of the child. \param request  number of pixels.
Result<void> decode(int input, std::string_view request, ResultWriter& result) {
  std::uint64_t pixels = 0;
  if (request.size() != sizeof(pixels)) return tl::unexpected(damaged_result(kPixels));
  std::memcpy(&pixels, request.data(), sizeof(pixels));
  LEFORT_TRY(std::string bytes, read_all(input, kPixels));
  std::istringstream stream(std::move(bytes));
  gdcm::ImageReader reader;
  reader.SetStream(stream);
  if (!reader.Read()) return tl::unexpected(damaged_result(kPixels));
  const gdcm::Image& image = reader.GetImage();
  if (image.GetBufferLength() > pixels * sizeof(double))
    return tl::unexpected(damaged_result(kPixels));
  std::vector<char> buffer(image.GetBufferLength());
  if (!image.GetBuffer(buffer.data())) return tl::unexpected(damaged_result(kPixels));
  switch (image.GetPixelFormat().GetScalarType()) {
    case gdcm::PixelFormat::UINT8:
      return write_as<std::uint8_t>(buffer, pixels, result);
    case gdcm::PixelFormat::INT8:
      return write_as<std::int8_t>(buffer, pixels, result);
    case gdcm::PixelFormat::UINT12:
    case gdcm::PixelFormat::UINT16:
      return write_as<std::uint16_t>(buffer, pixels, result);
    case gdcm::PixelFormat::INT12:
    case gdcm::PixelFormat::INT16:
      return write_as<std::int16_t>(buffer, pixels, result);
    default:
      return fail(ErrorCode::kFileUnsupported,
                  "the compressed pixels are not integers of 8 or 16 bits");
  }
}

}  // namespace

Result<std::vector<double>> decode_dicom_pixels(const std::filesystem::path& file,
                                                std::size_t pixels, Progress& progress,
                                                const ReaderLimits& limits) {
  LEFORT_TRY(const OpenedFile input, open_input(file, "the file"));
  const auto count = static_cast<std::uint64_t>(pixels);
  const std::string request(reinterpret_cast<const char*>(&count), sizeof(count));
  LEFORT_TRY(ReaderValues result,
             run_in_child(input.descriptor, {decode, kPixels, request, limits}, progress));
  std::vector<double> values;
  if (!result->array(values) || values.size() != pixels)
    return tl::unexpected(damaged_result(kPixels));
  return values;
}

}  // namespace lefort::io
