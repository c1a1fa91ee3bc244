#include <lefort/app/preview_file.h>
#include <lefort/core/check.h>
#include <lefort/io/write_atomically.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::app {
namespace {

constexpr std::string_view kMagic = "lefort response 1\n";
constexpr std::uintmax_t kLargest = std::uintmax_t(4) << 30;  // Bytes.

}  // namespace

Result<void> write_response(const std::filesystem::path& file,
                            const predict::LinearResponse& response) {
  std::string text(kMagic);
  const auto append = [&](auto number) {
    text.append(reinterpret_cast<const char*>(&number), sizeof(number));
  };
  append(std::uint64_t(response.unit_mm[0].size()));
  for (int k = 0; k < 3; ++k) append(response.centre_B[k]);
  for (const std::vector<Vec3>& unit : response.unit_mm)
    for (const Vec3& u : unit)
      for (int k = 0; k < 3; ++k) append(float(u[k]));
  return io::write_text(file, text);
}

Result<predict::LinearResponse> read_response(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string text, io::read_text(file, kLargest));
  std::string_view rest = text;
  const auto damaged = [] {
    return fail(ErrorCode::kFileCorrupt, "the preview's file is damaged");
  };
  const std::size_t head = kMagic.size() + sizeof(std::uint64_t) + 3 * sizeof(double);
  if (rest.size() < head || !rest.starts_with(kMagic)) return damaged();
  rest.remove_prefix(kMagic.size());
  const auto take = [&](auto& number) {
    if (rest.size() < sizeof(number)) return;  // Never: sizes are checked before.
    std::memcpy(&number, rest.data(), sizeof(number));
    rest.remove_prefix(sizeof(number));
  };
  std::uint64_t count = 0;
  take(count);
  predict::LinearResponse response;
  for (int k = 0; k < 3; ++k) take(response.centre_B[k]);
  constexpr std::size_t kPerPoint = 12 * 3 * sizeof(float);
  if (rest.size() % kPerPoint != 0 || count != rest.size() / kPerPoint) return damaged();
  for (std::vector<Vec3>& unit : response.unit_mm) {
    unit.resize(std::size_t(count));
    for (Vec3& u : unit)
      for (int k = 0; k < 3; ++k) {
        float number = 0;
        take(number);
        u[k] = double(number);
      }
  }
  return response;
}

PreviewDistance measure_preview(std::span<const Vec3> preview_mm, std::span<const Vec3> before_L,
                                std::span<const Vec3> after_L) {
  LEFORT_CHECK(preview_mm.size() == before_L.size() && before_L.size() == after_L.size());
  constexpr double kMoved_mm = 0.5;  // As in a prediction's summary.
  PreviewDistance distance;
  std::vector<double> misses_mm;
  for (std::size_t v = 0; v < before_L.size(); ++v) {
    const Vec3 shift_mm = after_L[v] - before_L[v];
    distance.largest_shift_mm = std::max(distance.largest_shift_mm, shift_mm.norm());
    if (shift_mm.norm() > kMoved_mm) misses_mm.push_back((preview_mm[v] - shift_mm).norm());
  }
  distance.moved_vertices = Index(misses_mm.size());
  if (misses_mm.empty()) return distance;
  std::sort(misses_mm.begin(), misses_mm.end());
  const auto quantile = [&](double q) {
    return misses_mm[std::size_t(q * double(misses_mm.size() - 1))];
  };
  distance.p50_mm = quantile(0.5);
  distance.p99_mm = quantile(0.99);
  distance.max_mm = misses_mm.back();
  return distance;
}

}  // namespace lefort::app
