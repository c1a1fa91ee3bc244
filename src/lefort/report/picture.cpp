#include <lefort/report/internal/cairo_pixels.h>
#include <lefort/report/picture.h>

#include <cairo.h>
#include <fmt/format.h>

#include <memory>

namespace lefort::report {

Result<void> check_picture(const Picture& picture) {
  const auto side_fits = [](int side) { return side >= 1 && side <= kMaxPictureSide; };
  if (!side_fits(picture.width) || !side_fits(picture.height))
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture is {} x {} pixels, each side must be in [1, {}]",
                            picture.width, picture.height, kMaxPictureSide));
  const std::size_t wanted = 4 * std::size_t(picture.width) * std::size_t(picture.height);
  if (picture.rgba.size() != wanted)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture of {} x {} pixels has {} bytes, must have {}", picture.width,
                            picture.height, picture.rgba.size(), wanted));
  return {};
}

Result<std::string> encode_png(const Picture& picture) {
  LEFORT_TRY_VOID(check_picture(picture));
  std::vector<std::uint32_t> words = cairo_pixels(picture);
  const std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)> surface(
      cairo_image_surface_create_for_data(reinterpret_cast<unsigned char*>(words.data()),
                                          CAIRO_FORMAT_RGB24, picture.width, picture.height,
                                          4 * picture.width),
      &cairo_surface_destroy);
  const auto append = [](void* png, const unsigned char* bytes, unsigned int count) {
    static_cast<std::string*>(png)->append(reinterpret_cast<const char*>(bytes), count);
    return CAIRO_STATUS_SUCCESS;
  };
  std::string png;
  const cairo_status_t status = cairo_surface_write_to_png_stream(surface.get(), append, &png);
  if (status != CAIRO_STATUS_SUCCESS)  // Only lack of memory remains as a reason.
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("picture of {} x {} pixels cannot be encoded: {}", picture.width,
                            picture.height, cairo_status_to_string(status)));
  return png;
}

}  // namespace lefort::report
