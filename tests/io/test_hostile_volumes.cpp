// Headers that made MetaIO and NrrdIO write outside their buffers, loop, or read other files, and
// valid files of kinds that lefort does not write.
#include <lefort/io/internal/raw_volume.h>
#include <lefort/io/volume_files.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <cstring>
#include <string>
#include <thread>
#include <vector>

#include "io/itk_images.h"
#include "io/sample_scan.h"
#include "io/volume_bytes.h"
#include "support/stop_at_once.h"
#include "support/temporary_folder.h"

namespace lefort::io::test_hostile_volumes {
namespace {

using test::kEightVoxels;
using test::kPlacement;
using test::metaimage;
using test::nifti;
using test::nrrd;
using test::put_float;
using test::raw_bytes;
using test::TemporaryFolder;
using test::volume_error_code;
using test::write_bytes;

const std::string kAxes =
    "space: left-posterior-superior\nspace directions: (2,0,0) (0,3,0) (0,0,4)\n"
    "space origin: (10,20,30)";

std::string repeated(const std::string& word, int count) {
  std::string text;
  for (int n = 0; n < count; ++n) text += word;
  return text;
}

std::string with_dimensions(const std::string& dimensions, const std::string& more) {
  return "ObjectType = Image\nNDims = " + dimensions + "\n" + more +
         "ElementType = MET_UCHAR\nElementDataFile = LOCAL\n" + std::string(1000, 'A');
}

TEST(HostileVolumes, RejectsMetaImageWithOtherCountsThanThreeDimensions) {
  const TemporaryFolder folder;
  // MetaIO's arrays have room for 4096 numbers.
  EXPECT_EQ(
      volume_error_code(folder, "a.mha",
                        with_dimensions("5000", "DimSize = " + repeated("2 ", 5000) + kPlacement)),
      ErrorCode::kFileUnsupported);
  EXPECT_EQ(volume_error_code(
                folder, "a.mha",
                with_dimensions("65", "TransformMatrix = " + repeated("1 ", 65 * 65) + "\n")),
            ErrorCode::kFileUnsupported);
  for (const char* const count : {"-1", "9223372036854775807", "18446744073709551615", "3 3", "x"})
    EXPECT_TRUE(volume_error_code(folder, "a.mha", with_dimensions(count, "DimSize = 2 2 2\n")) !=
                ErrorCode::kNotConverged)
        << count;
  const std::string voxels = raw_bytes(kEightVoxels);
  const auto read = [&](const std::string& lines) {
    return volume_error_code(folder, "a.mha", metaimage(lines, voxels));
  };
  ASSERT_EQ(read(kPlacement), ErrorCode::kNotConverged);
  EXPECT_EQ(read("TransformMatrix = 1 0 0 0 1 0 0 0 1 0\nElementSpacing = 2 3 4\n"),
            ErrorCode::kFileCorrupt);
  EXPECT_EQ(read("TransformMatrix = 1 0 0 0 1 0 0 0\nElementSpacing = 2 3 4\n"),
            ErrorCode::kFileCorrupt);
  EXPECT_EQ(read(kPlacement + "DimSize = 2 2 2\n"), ErrorCode::kFileCorrupt);  // Twice.
  EXPECT_EQ(read(kPlacement + "ElementNumberOfChannels = 100000\n"), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(kPlacement + "ElementToIntensityFunctionSlope = 2\n"),
            ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(kPlacement + "Modality = MET_MOD_CT\nRemark = any text\n"),
            ErrorCode::kNotConverged);
}

TEST(HostileVolumes, FindsTheVoxelFileOfTheHeaderThatItChecked) {
  const TemporaryFolder folder;
  write_bytes(folder / "secret", raw_bytes(kEightVoxels));
  const std::string outside = (folder / "secret").string();
  // MetaIO reads a field across the end of a line without separator.
  for (const std::string& where :
       {outside, std::string("%s%s%s%s%s%n 1 10 1"), "%d" + std::string(300, 'B')})
    EXPECT_EQ(
        volume_error_code(folder, "a.mha",
                          metaimage(kPlacement + "junk\nElementDataFile = LOCAL\n", "", where)),
        ErrorCode::kFileCorrupt)
        << where;
  // NrrdIO ends lines at a lone carriage return.
  EXPECT_EQ(volume_error_code(folder, "a.nrrd", nrrd(kAxes + "\n# x\rdata file: " + outside)),
            ErrorCode::kFileCorrupt);
  for (const char control : {'\0', '\v', '\f', '\x1b', '\x7f'})
    EXPECT_EQ(volume_error_code(folder, "a.nrrd", nrrd(kAxes + "\n# x" + control)),
              ErrorCode::kFileCorrupt);
}

TEST(HostileVolumes, RejectsNrrdWithLongUnknownOrRepeatedLines) {
  const TemporaryFolder folder;
  const auto read = [&](const std::string& bytes) {
    return volume_error_code(folder, "a.nrrd", bytes);
  };
  // NrrdIO puts a line of 1000 bytes that it does not know into a message of 512.
  for (const int length : {999, 1000, 2000, 40'000, 3'000'000})
    EXPECT_EQ(read("NRRD0004\n" + std::string(std::size_t(length), 'A')), ErrorCode::kFileCorrupt);
  EXPECT_EQ(read("NRRD0004\n" + repeated("# comment\n", 200'000)), ErrorCode::kFileCorrupt);
  EXPECT_EQ(read(nrrd(kAxes + "\nspace: left-posterior-superior")), ErrorCode::kFileCorrupt);
  EXPECT_EQ(read(nrrd(kAxes + "\nspac: left-posterior-superior")), ErrorCode::kFileCorrupt);
  EXPECT_EQ(read(nrrd(kAxes + "\nline skip: 1")), ErrorCode::kFileUnsupported);
  EXPECT_EQ(read(nrrd(kAxes + "\nlong key:=" + std::string(20'000, 'x'))),
            ErrorCode::kNotConverged);
}

std::string gzipped(const std::string& bytes) {
  z_stream zip{};
  EXPECT_EQ(deflateInit2(&zip, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string packed(bytes.size() + 1000, '\0');
  zip.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  zip.avail_in = static_cast<uInt>(bytes.size());
  zip.next_out = reinterpret_cast<Bytef*>(packed.data());
  zip.avail_out = static_cast<uInt>(packed.size());
  EXPECT_EQ(deflate(&zip, Z_FINISH), Z_STREAM_END);
  packed.resize(zip.total_out);
  deflateEnd(&zip);
  return packed;
}

/// A NRRD file with these fields besides sizes and axes.
std::string nrrd_of(const std::string& fields, const std::string& voxels,
                    const std::string& line_end = "\n") {
  std::string text = "NRRD0005\ndimension: 3\nsizes: 2 2 2\n" + kAxes + "\n" + fields + "\n\n";
  for (std::size_t at = text.find('\n'); line_end != "\n" && at != std::string::npos;
       at = text.find('\n', at + line_end.size()))
    text.replace(at, 1, line_end);
  return text + voxels;
}

TEST(HostileVolumes, ReadsValidNrrdAsItkDoes) {
  const TemporaryFolder folder;
  const std::string raw = raw_bytes(kEightVoxels);
  std::string swapped = raw;
  for (std::size_t at = 0; at < raw.size(); at += 2) std::swap(swapped[at], swapped[at + 1]);
  std::string doubles(8 * sizeof(double), '\0'), longs = doubles;
  for (std::size_t n = 0; n < 8; ++n) {
    const double real = kEightVoxels[n];
    const std::int64_t whole = kEightVoxels[n];
    std::memcpy(doubles.data() + 8 * n, &real, 8);
    std::memcpy(longs.data() + 8 * n, &whole, 8);
  }
  const std::string little = "endian: little\nencoding: ";
  const std::string files[] = {
      nrrd_of("type: short\n" + little + "raw", raw),
      nrrd_of("type: short\n" + little + "raw", raw, "\r\n"),
      nrrd_of("type: int16\nendian: big\nencoding: raw", swapped),
      nrrd_of("type: signed short\n" + little + "gzip", gzipped(raw)),
      nrrd_of("type: short\n" + little + "gz", gzipped(raw.substr(0, 5)) + gzipped(raw.substr(5))),
      nrrd_of("type: short\nencoding: ascii", "1000 1 2\n3 4 5\n6 -1000\n"),
      nrrd_of("type: double\n" + little + "raw", doubles),
      nrrd_of("type: long long\n" + little + "raw", longs),
      nrrd_of("type: short\nbyte skip: 3\n" + little + "raw", "xyz" + raw),
      nrrd_of("type: short\nbyteskip: -1\n" + little + "raw", "some bytes" + raw)};
  for (const std::string& bytes : files) {
    SCOPED_TRACE(bytes.substr(0, bytes.find("\n\n")));
    write_bytes(folder / "a.nrrd", bytes);
    const auto found = read_volume(folder / "a.nrrd");
    ASSERT_TRUE(found) << found.error().message;
    EXPECT_EQ(found->ct.values, kEightVoxels);
    const test::ItkImage itk = test::read_itk_image((folder / "a.nrrd").string());
    EXPECT_EQ(itk.values, std::vector<double>(kEightVoxels.begin(), kEightVoxels.end()));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(found->ct.grid.spacing_mm[Index(axis)], itk.spacing[axis]);
      EXPECT_EQ(found->ct.grid.origin_L[Index(axis)], itk.origin[axis]);
    }
  }
}

TEST(HostileVolumes, RejectsSurplusAndDamagedCompressedVoxels) {
  const TemporaryFolder folder;
  const std::string raw = raw_bytes(kEightVoxels),
                    fields = "type: short\nendian: little\nencoding: gzip";
  std::string damaged = gzipped(raw);
  damaged[damaged.size() - 6] ^= 1;  // Of the checksum.
  for (const std::string& voxels : {gzipped(raw + "x"), gzipped(raw.substr(1)), damaged, raw})
    EXPECT_EQ(volume_error_code(folder, "a.nrrd", nrrd_of(fields, voxels)),
              ErrorCode::kFileCorrupt);
  for (const char* const text : {"1 2 3 4 5 6 7", "1 2 3 4 5 6 7 8 9", "1 2 3 4 5 6 7 x",
                                 "1 2 3 4 5 6 7 40000", "1 2 3 4 5 6 7 1.5"})
    EXPECT_EQ(volume_error_code(folder, "a.nrrd", nrrd_of("type: short\nencoding: ascii", text)),
              ErrorCode::kFileCorrupt)
        << text;
}

TEST(HostileVolumes, AppliesTheScaleOfNiftiAndPrefersTheFormThatItkPrefers) {
  const TemporaryFolder folder;
  for (const std::int16_t sform_code : {std::int16_t{1}, std::int16_t{2}}) {
    std::string bytes = nifti(sform_code, {2, 0, 0, 10, 0, 3, 0, 20, 0, 0, 4, 30});
    put_float(bytes, 112, 0.5F), put_float(bytes, 116, -3.0F);
    bytes[252] = 1;  // A qform without rotation, 0.4 mm beside the sform.
    put_float(bytes, 76, 1.0F);
    put_float(bytes, 268, 10.4F), put_float(bytes, 272, 20.0F), put_float(bytes, 276, 30.0F);
    write_bytes(folder / "a.nii", bytes);
    const auto raw = read_raw_volume(folder / "a.nii");
    ASSERT_TRUE(raw) << raw.error().message;
    const test::ItkImage itk = test::read_itk_image((folder / "a.nii").string());
    with_values(*raw, [&](const auto values) {
      ASSERT_EQ(values.size(), itk.values.size());
      for (std::size_t n = 0; n < values.size(); ++n)
        EXPECT_EQ(static_cast<double>(values[n]), itk.values[n]);
    });
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(raw->grid.origin_L[Index(axis)], itk.origin[axis], 1e-5) << sform_code;
  }
}

TEST(HostileVolumes, StopsWhileItReads) {
  const TemporaryFolder folder;
  test::StopAtOnce stop;
  for (const char* const name : {"a.nrrd", "a.nii.gz", "a.mha"}) {
    ASSERT_TRUE(write_volume(folder / name, test::sample_scan()));
    EXPECT_EQ(read_raw_volume(folder / name, stop).error().code, ErrorCode::kCancelled) << name;
  }
}

TEST(HostileVolumes, EightThreadsReadAndWriteAtOnce) {
  const TemporaryFolder folder;
  const image::CtVolume scan = test::sample_scan();
  ASSERT_TRUE(write_volume(folder / "a.nrrd", scan));
  write_bytes(folder / "wrong.nrrd", "NRRD0004\n" + std::string(100, 'A'));
  std::vector<int> wrong(8, 0);
  std::vector<std::thread> threads;
  for (std::size_t t = 0; t < wrong.size(); ++t)
    threads.emplace_back([&, t] {
      for (int n = 0; n < 50; ++n) {
        const auto found = read_volume(folder / "a.nrrd");
        if (!found || found->ct.values != scan.values) ++wrong[t];
        if (read_volume(folder / "wrong.nrrd")) ++wrong[t];
        if (n % 10 == 0 && !write_volume(folder / fmt::format("{}.nrrd", t), scan)) ++wrong[t];
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(wrong, std::vector<int>(8, 0));
}

}  // namespace
}  // namespace lefort::io::test_hostile_volumes
