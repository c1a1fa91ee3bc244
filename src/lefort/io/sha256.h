/// \file
/// Hashes of inputs, which are stored in results and used as keys of caches.
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

/// Computes the SHA-256 of a sequence of values. Every list is preceded by its length.
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

  /// Returns the hash of all values added so far, as 64 hexadecimal digits.
  [[nodiscard]] std::string hex() const;

 private:
  friend Result<std::string> sha256_of_file(const std::filesystem::path& file);
  void add_bytes(std::span<const std::byte> bytes);
  struct Context;
  std::unique_ptr<Context> context_;
};

/// Computes the SHA-256 of the bytes of a file, as `sha256sum` does, with one megabyte of memory.
///
/// \param file  to read.
/// \returns 64 hexadecimal digits, kFileNotFound, or kFileCorrupt if it cannot be read.
[[nodiscard]] Result<std::string> sha256_of_file(const std::filesystem::path& file);

}  // namespace lefort::io
