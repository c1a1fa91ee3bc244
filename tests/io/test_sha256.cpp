#include <lefort/io/sha256.h>
#include <lefort/io/write_atomically.h>

#include <gtest/gtest.h>

#include "support/shapes.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_sha256 {
namespace {

TEST(Sha256, MatchesTheKnownDigestOfNoData) {  // FIPS 180-4.
  EXPECT_EQ(Sha256().hex(), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
}

TEST(Sha256, MatchesSha256sumForFiles) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_text(folder / "abc", "abc"));  // FIPS 180-4.
  EXPECT_EQ(sha256_of_file(folder / "abc").value(),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  ASSERT_TRUE(write_text(folder / "million", std::string(1'000'000, 'a')));
  EXPECT_EQ(sha256_of_file(folder / "million").value(),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(sha256_of_file(folder / "none").error().code, ErrorCode::kFileNotFound);
}

TEST(Sha256, DistinguishesTheBoundariesOfTexts) {
  EXPECT_NE(Sha256().add("ab").add("c").hex(), Sha256().add("a").add("bc").hex());
  EXPECT_EQ(Sha256().add("ab").add("c").hex(), Sha256().add("ab").add("c").hex());
}

TEST(Sha256, ChangesWithAVoxelOrVertex) {
  image::CtVolume volume;
  volume.grid.size = {2, 1, 1};
  volume.values = {1, 2};
  const std::string before = Sha256().add(volume).hex();
  volume.values[1] = 3;
  EXPECT_NE(Sha256().add(volume).hex(), before);
  volume.values[1] = 2;
  volume.grid.spacing_mm.z() = 1.5;
  EXPECT_NE(Sha256().add(volume).hex(), before);

  geometry::TriangleMesh mesh = test::make_box(Vec3::Zero(), Vec3::Ones());
  const std::string box = Sha256().add(mesh).hex();
  mesh.vertices[3].x() += 1e-9;
  EXPECT_NE(Sha256().add(mesh).hex(), box);
}

TEST(Sha256, CanBeReadBeforeItsEnd) {
  Sha256 hash;
  hash.add("a");
  const std::string first = hash.hex();
  EXPECT_EQ(hash.hex(), first);
  EXPECT_NE(hash.add("b").hex(), first);
}

}  // namespace
}  // namespace lefort::io::test_sha256
