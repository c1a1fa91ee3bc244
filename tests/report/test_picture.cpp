#include <lefort/report/picture.h>

#include <cairo.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>

namespace lefort::report::test_picture {
namespace {

/// Decodes with cairo: 0x00RRGGBB words, or width 0 if the bytes are not a PNG.
struct Decoded {
  int width = 0;
  int height = 0;
  std::vector<std::uint32_t> words;
};

Decoded decode(std::string_view png) {
  const auto read = [](void* rest, unsigned char* bytes, unsigned int count) {
    auto& text = *static_cast<std::string_view*>(rest);
    if (text.size() < count) return CAIRO_STATUS_READ_ERROR;
    std::copy_n(text.data(), count, bytes);
    text.remove_prefix(count);
    return CAIRO_STATUS_SUCCESS;
  };
  cairo_surface_t* surface = cairo_image_surface_create_from_png_stream(read, &png);
  Decoded decoded;
  if (cairo_surface_status(surface) == CAIRO_STATUS_SUCCESS) {
    decoded.width = cairo_image_surface_get_width(surface);
    decoded.height = cairo_image_surface_get_height(surface);
    const int stride = cairo_image_surface_get_stride(surface);
    for (int row = 0; row < decoded.height; ++row) {
      const unsigned char* bytes = cairo_image_surface_get_data(surface) + row * stride;
      const auto* words = reinterpret_cast<const std::uint32_t*>(bytes);
      for (int column = 0; column < decoded.width; ++column)
        decoded.words.push_back(words[column] & 0xffffffU);
    }
  }
  cairo_surface_destroy(surface);
  return decoded;
}

TEST(Picture, PngContainsEveryPixel) {
  Picture picture{3, 2, {}};
  for (std::uint8_t pixel = 0; pixel < 6; ++pixel)
    picture.rgba.insert(picture.rgba.end(),
                        {pixel, std::uint8_t(100 + pixel), std::uint8_t(250 - pixel), 255});
  const Decoded decoded = decode(encode_png(picture).value());
  ASSERT_EQ(decoded.width, 3);
  ASSERT_EQ(decoded.height, 2);
  for (std::uint32_t pixel = 0; pixel < 6; ++pixel)
    EXPECT_EQ(decoded.words[pixel], pixel << 16U | (100 + pixel) << 8U | (250 - pixel));
}

TEST(Picture, RejectsInconsistentSidesAndBytes) {
  EXPECT_EQ(encode_png({0, 5, {}}).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(encode_png({1, kMaxPictureSide + 1, {}}).error().code, ErrorCode::kInvalidArgument);
  const auto too_few_bytes = encode_png({2, 2, std::vector<std::uint8_t>(15)});
  EXPECT_EQ(too_few_bytes.error().message, "picture of 2 x 2 pixels has 15 bytes, must have 16");
}

}  // namespace
}  // namespace lefort::report::test_picture
