#include <lefort/core/check.h>
#include <lefort/io/preview_file.h>
#include <lefort/io/read_text.h>
#include <lefort/io/write_atomically.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace lefort::io {
namespace {

constexpr std::string_view kPreviewMagic = "lefort preview 2\n";
constexpr std::uintmax_t kLargest = std::uintmax_t(8) << 30;  // Bytes.

template <class Item>
void append(std::string& text, const Item* items, std::size_t count) {
  static_assert(std::is_trivially_copyable_v<Item>);
  const std::uint64_t length = count;
  text.append(reinterpret_cast<const char*>(&length), sizeof(length));
  text.append(reinterpret_cast<const char*>(items), count * sizeof(Item));
}

/// \returns false if the text ends before the list.
template <class Item>
bool take(std::string_view& text, std::vector<Item>& items) {
  static_assert(std::is_trivially_copyable_v<Item>);
  std::uint64_t count = 0;
  if (text.size() < sizeof(count)) return false;
  std::memcpy(&count, text.data(), sizeof(count));
  text.remove_prefix(sizeof(count));
  if (count > text.size() / sizeof(Item)) return false;
  items.resize(std::size_t(count));
  if (!items.empty()) std::memcpy(items.data(), text.data(), items.size() * sizeof(Item));
  text.remove_prefix(items.size() * sizeof(Item));
  return true;
}

/// Three coordinates in memory order, since Eigen's vectors are not trivially copyable types.
using Numbers = std::vector<double>;

bool is_pattern(const std::vector<int>& columns, const std::vector<int>& rows) {
  const int count = int(columns.size()) - 1;
  if (columns.empty() || columns.front() != 0 || columns.back() != int(rows.size())) return false;
  for (int column = 0; column < count; ++column) {
    const int begin = columns[std::size_t(column)], end = columns[std::size_t(column) + 1];
    if (begin >= end || end > int(rows.size()) || rows[std::size_t(begin)] != column) return false;
    for (int k = begin + 1; k < end; ++k)
      if (rows[std::size_t(k)] <= rows[std::size_t(k) - 1] || rows[std::size_t(k)] >= count)
        return false;
  }
  return true;
}

}  // namespace

Result<void> write_preview_model(const std::filesystem::path& file,
                                 const predict::PreviewModel& model) {
  const linear::SparseMatrix& K = model.stiffness_n_per_mm;
  std::string text(kPreviewMagic);
  append(text, K.outerIndexPtr(), std::size_t(K.cols() + 1));
  append(text, K.innerIndexPtr(), std::size_t(K.nonZeros()));
  append(text, K.valuePtr(), std::size_t(K.nonZeros()));
  append(text, model.first_row.data(), model.first_row.size());
  std::vector<std::int32_t> segments, rows, nodes;
  std::vector<std::uint8_t> is_bilateral;
  Numbers places, weights, stiffness;
  for (const auto& support : model.supports) {
    segments.push_back(support.segment);
    rows.push_back(support.row);
    is_bilateral.push_back(support.is_bilateral ? 1 : 0);
    stiffness.push_back(support.n_per_mm);
    stiffness.push_back(support.motion_fraction);
    places.insert(places.end(), support.point_L.begin(), support.point_L.end());
    places.insert(places.end(), support.direction_L.begin(), support.direction_L.end());
  }
  for (const auto& follower : model.skin.embedded_vertices) {
    nodes.insert(nodes.end(), follower.face.begin(), follower.face.end());
    weights.insert(weights.end(), follower.weights.begin(), follower.weights.end());
  }
  append(text, segments.data(), segments.size());
  append(text, rows.data(), rows.size());
  append(text, is_bilateral.data(), is_bilateral.size());
  append(text, stiffness.data(), stiffness.size());
  append(text, places.data(), places.size());
  append(text, nodes.data(), nodes.size());
  append(text, weights.data(), weights.size());
  const Numbers rest{model.support_n_per_mm, double(model.segment_count)};
  append(text, rest.data(), rest.size());
  return write_text(file, text);
}

Result<predict::PreviewModel> read_preview_model(const std::filesystem::path& file) {
  LEFORT_TRY(const std::string whole, read_text(file, kLargest));
  std::string_view text = whole;
  const auto damaged = [] {
    return fail(ErrorCode::kFileCorrupt, "the preview file is damaged: prepare it again");
  };
  if (!text.starts_with(kPreviewMagic)) return damaged();
  text.remove_prefix(kPreviewMagic.size());
  std::vector<int> columns, inner;
  std::vector<std::int32_t> segments, rows, nodes;
  std::vector<std::uint8_t> is_bilateral;
  Numbers values, places, weights, stiffness, rest;
  predict::PreviewModel model;
  const bool is_whole = take(text, columns) && take(text, inner) && take(text, values) &&
                        take(text, model.first_row) && take(text, segments) && take(text, rows) &&
                        take(text, is_bilateral) && take(text, stiffness) && take(text, places) &&
                        take(text, nodes) && take(text, weights) && take(text, rest);
  const auto is_node = [&](std::int32_t node) {
    return node >= 0 && std::size_t(node) < model.first_row.size();
  };
  const auto is_row = [&](std::int32_t row) {
    return row >= -1 && row + 3 < std::int32_t(columns.size());
  };
  if (!is_whole || !text.empty() || values.size() != inner.size() || !is_pattern(columns, inner) ||
      is_bilateral.size() != rows.size() || stiffness.size() != 2 * rows.size() ||
      places.size() != 6 * rows.size() || nodes.size() % 3 != 0 || weights.size() != nodes.size() ||
      rest.size() != 2 || !(rest[1] >= 1.0 && rest[1] < 1e6) || segments.size() != rows.size() ||
      !std::all_of(segments.begin(), segments.end(),
                   [&](std::int32_t k) { return k >= -1 && k < std::int32_t(rest[1]); }) ||
      !std::all_of(nodes.begin(), nodes.end(), is_node) ||
      !std::all_of(model.first_row.begin(), model.first_row.end(), is_row) ||
      !std::all_of(rows.begin(), rows.end(),
                   [&](std::int32_t row) { return row >= 0 && is_row(row); }))
    return damaged();
  const Index size = Index(columns.size()) - 1;
  model.stiffness_n_per_mm = Eigen::Map<const linear::SparseMatrix>(
      size, size, Index(inner.size()), columns.data(), inner.data(), values.data());
  for (std::size_t s = 0; s < rows.size(); ++s)
    model.supports.push_back({segments[s], rows[s], Vec3(&places[6 * s]), Vec3(&places[6 * s + 3]),
                              is_bilateral[s] != 0, stiffness[2 * s], stiffness[2 * s + 1]});
  for (std::size_t v = 0; v < nodes.size(); v += 3)
    model.skin.embedded_vertices.push_back(
        {.face = {nodes[v], nodes[v + 1], nodes[v + 2]}, .weights = Vec3(&weights[v])});
  model.support_n_per_mm = rest[0];
  model.segment_count = std::int32_t(rest[1]);
  return model;
}

PreviewDistance measure_preview(std::span<const Vec3> preview_mm, std::span<const Vec3> before_L,
                                std::span<const Vec3> after_L) {
  LEFORT_CHECK(preview_mm.size() == before_L.size() && before_L.size() == after_L.size());
  constexpr double kMoved_mm = 0.5;  // As in the summary of a prediction.
  PreviewDistance distance;
  std::vector<double> misses_mm;
  for (std::size_t v = 0; v < before_L.size(); ++v) {
    const Vec3 shift_mm = after_L[v] - before_L[v];
    distance.max_shift_mm = std::max(distance.max_shift_mm, shift_mm.norm());
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

}  // namespace lefort::io
