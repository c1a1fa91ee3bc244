#include <lefort/core/check.h>
#include <lefort/io/write_atomically.h>
#include <lefort/io/write_dicom.h>

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string_view>

namespace lefort::io {
namespace {

constexpr double kIntercept = -1024.0;

/// Data elements in the order of their tags, as required by the format.
class Elements {
 public:
  void text(std::uint32_t tag, std::string_view vr, std::string value) {
    if (value.size() % 2 == 1) value.push_back(vr == "UI" ? '\0' : ' ');
    begin(tag, vr);
    if (vr == "OB" || vr == "OW") {
      number<std::uint16_t>(0);
      number(std::uint32_t(value.size()));
    } else {
      number(std::uint16_t(value.size()));
    }
    bytes_ += value;
  }
  void unsigned_short(std::uint32_t tag, std::uint16_t value) {
    begin(tag, "US");
    number<std::uint16_t>(2);
    number(value);
  }
  void unsigned_long(std::uint32_t tag, std::uint32_t value) {
    begin(tag, "UL");
    number<std::uint16_t>(4);
    number(value);
  }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  void begin(std::uint32_t tag, std::string_view vr) {
    number(std::uint16_t(tag >> 16));
    number(std::uint16_t(tag & 0xffff));
    bytes_ += vr;
  }
  template <class T>
  void number(T value) {
    char raw[sizeof(T)];
    std::memcpy(raw, &value, sizeof(T));
    bytes_.append(raw, sizeof(T));
  }
  std::string bytes_;
};

/// Decimal strings have at most 16 characters.
std::string decimals(std::initializer_list<double> values) {
  std::string text;
  for (const double value : values) {
    // "-1.234567890e+02": 9 digits at most, and zeros without a sign.
    std::string one = fmt::format("{:.9g}", value + 0.0);
    if (one.size() > 16) one = fmt::format("{:.8e}", value);
    text += (text.empty() ? "" : "\\") + one;
  }
  return text;
}

}  // namespace

Result<void> write_dicom_slice(const std::filesystem::path& target, const image::CtVolume& slice,
                               Index number, const DicomSeriesText& text) {
  const image::Grid& grid = slice.grid;
  LEFORT_CHECK(grid.size[2] == 1 && std::ssize(slice.values) == grid.voxel_count());
  LEFORT_CHECK(grid.size[0] < 65536 && grid.size[1] < 65536);
  const std::string class_uid = "1.2.840.10008.5.1.4.1.1.2";
  // 2.25 is the root of identifiers derived from a number (PS3.5, B.2).
  const std::string study_uid = fmt::format("2.25.{}1", text.number);
  const std::string series_uid = fmt::format("2.25.{}2", text.number);
  const std::string instance_uid = fmt::format("2.25.{}3{:05}", text.number, number);

  Elements meta;
  meta.text(0x00020001, "OB", std::string("\0\1", 2));
  meta.text(0x00020002, "UI", class_uid);
  meta.text(0x00020003, "UI", instance_uid);
  meta.text(0x00020010, "UI", "1.2.840.10008.1.2.1");
  meta.text(0x00020012, "UI", "2.25.1037");
  Elements head;
  head.unsigned_long(0x00020000, std::uint32_t(meta.bytes().size()));

  const Vec3 row = grid.direction.col(0), column = grid.direction.col(1);
  std::string pixels(slice.values.size() * 2, '\0');
  for (std::size_t n = 0; n < slice.values.size(); ++n) {
    const auto stored = std::uint16_t(slice.values[n] - std::int16_t(kIntercept));
    std::memcpy(pixels.data() + 2 * n, &stored, 2);
  }
  Elements body;
  body.text(0x00080008, "CS", "DERIVED\\PRIMARY\\AXIAL");
  body.text(0x00080016, "UI", class_uid);
  body.text(0x00080018, "UI", instance_uid);
  body.text(0x00080060, "CS", "CT");
  body.text(0x0008103e, "LO", text.description);
  body.text(0x00100010, "PN", text.patient_name);
  body.text(0x00100020, "LO", fmt::format("SYNTHETIC-{}", text.number));
  body.text(0x0020000d, "UI", study_uid);
  body.text(0x0020000e, "UI", series_uid);
  body.text(0x00200013, "IS", fmt::format("{}", number));
  body.text(0x00200032, "DS", decimals({grid.origin_L.x(), grid.origin_L.y(), grid.origin_L.z()}));
  body.text(0x00200037, "DS",
            decimals({row.x(), row.y(), row.z(), column.x(), column.y(), column.z()}));
  body.text(0x00200052, "UI", study_uid);
  body.unsigned_short(0x00280002, 1);
  body.text(0x00280004, "CS", "MONOCHROME2");
  body.unsigned_short(0x00280010, std::uint16_t(grid.size[1]));
  body.unsigned_short(0x00280011, std::uint16_t(grid.size[0]));
  body.text(0x00280030, "DS", decimals({grid.spacing_mm.y(), grid.spacing_mm.x()}));
  body.unsigned_short(0x00280100, 16);
  body.unsigned_short(0x00280101, 16);
  body.unsigned_short(0x00280102, 15);
  body.unsigned_short(0x00280103, 0);
  body.text(0x00281052, "DS", decimals({kIntercept}));
  body.text(0x00281053, "DS", "1");
  body.text(0x00281054, "LO", "HU");
  body.text(0x7fe00010, "OW", pixels);
  return write_text(target,
                    std::string(128, '\0') + "DICM" + head.bytes() + meta.bytes() + body.bytes());
}

}  // namespace lefort::io
