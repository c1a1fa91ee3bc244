/// \file
/// Fingerprints of inputs: every result names what made it, and caches are keyed by them.
#pragma once

#include <lefort/anatomy/label_map.h>
#include <lefort/core/error.h>
#include <lefort/geometry/triangle_mesh.h>
#include <lefort/image/volume.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace lefort::io {

/// Collects values, in order, into one SHA-256. Every list is preceded by its length.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;

  Sha256& add(std::string_view text);
  Sha256& add(double number);
  Sha256& add(const Vec3& vector);
  Sha256& add(const image::Grid& grid);
  Sha256& add(const image::CtVolume& volume);
  Sha256& add(const anatomy::LabelMap& labels);
  Sha256& add(const geometry::TriangleMesh& mesh);

  /// 64 hexadecimal digits of all that was added so far.
  [[nodiscard]] std::string hex() const;

 private:
  friend Result<std::string> sha256_of_file(const std::filesystem::path& file);
  void add_bytes(std::span<const std::byte> bytes);
  struct Context;
  std::unique_ptr<Context> context_;
};

/// SHA-256 of a file's bytes, as `sha256sum` tells it; takes a megabyte of memory.
///
/// \returns 64 hexadecimal digits, or kFileNotFound or kFileCorrupt where it cannot be read.
[[nodiscard]] Result<std::string> sha256_of_file(const std::filesystem::path& file);

}  // namespace lefort::io
