#include <lefort/core/check.h>
#include <lefort/io/sha256.h>

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <fstream>
#include <vector>

namespace lefort::io {

struct Sha256::Context {
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> md{EVP_MD_CTX_new(), &EVP_MD_CTX_free};
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {
  LEFORT_CHECK(EVP_DigestInit_ex(context_->md.get(), EVP_sha256(), nullptr) == 1);
}

Sha256::~Sha256() = default;

void Sha256::add_bytes(std::span<const std::byte> bytes) {
  LEFORT_CHECK(EVP_DigestUpdate(context_->md.get(), bytes.data(), bytes.size()) == 1);
}

Sha256& Sha256::add(std::string_view text) {
  add(double(text.size()));
  add_bytes(std::as_bytes(std::span(text)));
  return *this;
}

Sha256& Sha256::add(double number) {
  add_bytes(std::as_bytes(std::span(&number, 1)));
  return *this;
}

Sha256& Sha256::add(const Vec3& vector) { return add(vector.x()).add(vector.y()).add(vector.z()); }

Sha256& Sha256::add(const image::Grid& grid) {
  for (const Index size : grid.size) add(double(size));
  add(grid.spacing_mm).add(grid.origin_L);
  for (int axis = 0; axis < 3; ++axis) add(Vec3(grid.direction.col(axis)));
  return *this;
}

Sha256& Sha256::add(const image::CtVolume& volume) {
  add(volume.grid);
  add_bytes(std::as_bytes(std::span(volume.values)));
  return *this;
}

Sha256& Sha256::add(const anatomy::LabelMap& labels) {
  add(labels.grid);
  add_bytes(std::as_bytes(std::span(labels.values)));
  return *this;
}

Sha256& Sha256::add(const geometry::TriangleMesh& mesh) {
  add(double(mesh.vertex_count()));
  for (const Vec3& vertex : mesh.vertices) add(vertex);
  add(double(mesh.triangle_count()));
  add_bytes(std::as_bytes(std::span(mesh.triangles)));
  return *this;
}

std::string Sha256::hex() const {
  // Finishing changes the context, so a copy is finished.
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> copy{EVP_MD_CTX_new(),
                                                                     &EVP_MD_CTX_free};
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  LEFORT_CHECK(EVP_MD_CTX_copy_ex(copy.get(), context_->md.get()) == 1);
  LEFORT_CHECK(EVP_DigestFinal_ex(copy.get(), digest.data(), &length) == 1);
  std::string text;
  for (unsigned int i = 0; i < length; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

Result<std::string> sha256_of_file(const std::filesystem::path& file) {
  constexpr std::size_t kChunkBytes = 1 << 20;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return fail(ErrorCode::kFileNotFound, fmt::format("{} is not a file", file.string()));
  std::ifstream stream(file, std::ios::binary);
  std::vector<char> chunk(kChunkBytes);
  Sha256 sha256;
  while (stream) {
    stream.read(chunk.data(), std::streamsize(chunk.size()));
    sha256.add_bytes(std::as_bytes(std::span(chunk).first(std::size_t(stream.gcount()))));
  }
  if (!stream.eof())
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} cannot be read", file.string()));
  return sha256.hex();
}

}  // namespace lefort::io
