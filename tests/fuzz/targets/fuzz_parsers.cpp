// libFuzzer calls the parser that LEFORT_FUZZ_TARGET names with bytes that it makes up
// (script/fuzz). A crash, an error of a sanitizer, a hang or too much memory is a failure.
#include <lefort/io/deprecated_keys.h>
#include <lefort/io/internal/descriptor.h>
#include <lefort/io/internal/dicom_file.h>
#include <lefort/io/internal/gmsh_file.h>
#include <lefort/io/internal/multipart.h>
#include <lefort/io/internal/plist.h>
#include <lefort/io/internal/surface_formats.h>
#include <lefort/io/internal/tar_reader.h>
#include <lefort/io/internal/validated_json.h>
#include <lefort/io/internal/volume_header.h>
#include <lefort/io/internal/vtk_xml.h>
#include <lefort/io/landmarks_file.h>
#include <lefort/io/markups_file.h>
#include <lefort/io/plan_schema.h>
#include <lefort/io/point_table.h>
#include <lefort/io/transform_file.h>
#include <lefort/server/http/authorize_request.h>
#include <lefort/server/http/connection.h>

#include <httplib.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <string>
#include <string_view>

namespace lefort {
namespace {

/// A file in memory.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : file_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    if (::write(file_.number(), bytes.data(), bytes.size()) != std::ssize(bytes)) std::abort();
    ::lseek(file_.number(), 0, SEEK_SET);
  }
  [[nodiscard]] int number() const { return file_.number(); }
  [[nodiscard]] std::filesystem::path path() const {
    return "/proc/self/fd/" + std::to_string(number());
  }

 private:
  io::Descriptor file_;
};

/// A message is one line.
template <class T>
void check(const Result<T>& result) {
  if (!result && result.error().message.empty()) std::abort();
}

void volume(Result<io::VolumeHeader> header) {
  check(header);
  constexpr Index kMaxVoxels = 1 << 20;
  if (!header || !io::check_either_hand(header->volume.grid)) return;
  const Index components = header->volume.components;
  if (components < 1 || components > 256 || header->volume.value_count() > kMaxVoxels) return;
  // Compressed voxels are read by a child.
  if (header->storage.encoding != io::VoxelEncoding::kDeflated)
    check(io::read_voxels(*header, Progress::none()));
}

void vtu(std::string_view bytes) {
  using io::internal::NameMatch;
  check(io::internal::parse_vtk_xml(bytes, "fuzz", "UnstructuredGrid",
                                    {{"Points", ""},
                                     {"Cells", "connectivity"},
                                     {"Cells", "offsets"},
                                     {"Cells", "types"},
                                     {"CellData", "region"},
                                     {"CellData", "set:", NameMatch::kBeginning},
                                     {"PointData", "set:", NameMatch::kBeginning}}));
}

/// The first line is the content type; the body arrives in pieces of the length of that line.
void multipart(std::string_view bytes) {
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  const std::string boundary = io::multipart_boundary(bytes.substr(0, end));
  if (boundary.empty()) return;
  std::size_t parts = 0, length = 0;
  io::MultipartReader reader(boundary, {.begin_part = [&]() -> Result<void> {
                                          ++parts;
                                          return {};
                                        },
                                        .data = [&](std::string_view data) -> Result<void> {
                                          length += data.size();
                                          return {};
                                        },
                                        .end_part = []() -> Result<void> { return {}; }});
  std::string_view rest = bytes.substr(end);
  while (!rest.empty() && reader.feed(rest.substr(0, end + 1)))
    rest.remove_prefix(std::min(end + 1, rest.size()));
  if (length > bytes.size() || parts > bytes.size()) std::abort();
}

/// httplib with our connection and checks, without routes.
class FuzzedServer : public httplib::Server {
 public:
  void serve(std::string_view bytes) {
    int ends[2];
    if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) std::abort();
    const io::Descriptor ours(ends[0]), client(ends[1]);
    constexpr std::size_t kFits = 1 << 16;  // In the buffer of the socket.
    static_cast<void>(::send(client.number(), bytes.data(), std::min(bytes.size(), kFits), 0));
    ::shutdown(client.number(), SHUT_WR);
    server::Connection connection(ours.number(), limits_);
    if (!connection.wait_for_request()) return;
    bool is_closed = false;
    process_request(connection, true, is_closed, [&](httplib::Request& request) {
      if (!request.ranges.empty()) std::abort();  // httplib saw a Range.
      static_cast<void>(server::authorize_request(request, ours_));
      connection.begin_body();
    });
  }

 private:
  server::HttpLimits limits_;
  server::Credentials ours_{
      .hosts = {"127.0.0.1:80"}, .origins = {"http://127.0.0.1:80"}, .token = std::string(64, 'a')};
};

void request(std::string_view bytes) {
  static FuzzedServer server;
  server.serve(bytes);
}

struct Target {
  const char* name;
  void (*run)(std::string_view bytes);
};

constexpr Target kTargets[] = {
    {"obj", [](std::string_view bytes) { check(io::internal::parse_obj(bytes, "fuzz")); }},
    {"ply", [](std::string_view bytes) { check(io::internal::parse_ply(bytes, "fuzz")); }},
    {"stl", [](std::string_view bytes) { check(io::internal::parse_stl(bytes, "fuzz")); }},
    {"vtp", [](std::string_view bytes) { check(io::internal::parse_vtp(bytes, "fuzz")); }},
    {"vtu", vtu},
    {"gmsh", [](std::string_view bytes) { check(io::internal::parse_gmsh(bytes)); }},
    {"nrrd",
     [](std::string_view bytes) {
       const MemoryFile file(bytes);
       volume(io::read_nrrd_header(file.path()));
     }},
    {"metaimage",
     [](std::string_view bytes) {
       const MemoryFile file(bytes);
       volume(io::read_metaimage_header(file.path()));
     }},
    {"nifti", [](std::string_view bytes) { check(io::decode_nifti(MemoryFile(bytes).number())); }},
    {"tar",
     [](std::string_view bytes) {
       check(io::read_from_tar(MemoryFile(bytes).number(), "main.plist", 1 << 20));
     }},
    {"plist", [](std::string_view bytes) { check(io::read_plist(bytes)); }},
    {"dicom",
     [](std::string_view bytes) { static_cast<void>(io::parse_dicom(bytes).values.size()); }},
    {"points", [](std::string_view bytes) { check(io::parse_points(bytes)); }},
    {"landmarks", [](std::string_view bytes) { check(io::parse_landmark_table(bytes)); }},
    {"markups", [](std::string_view bytes) { check(io::parse_markups(bytes)); }},
    {"plan",
     [](std::string_view bytes) {
       check(
           io::internal::parse_checked(bytes, io::kPlanSchema, "fuzz", io::deprecated_in_plans()));
     }},
    {"transform", [](std::string_view bytes) { check(io::parse_transform(bytes)); }},
    {"multipart", multipart},
    {"request", request},
};

const Target& chosen_target() {
  const char* const name = std::getenv("LEFORT_FUZZ_TARGET");
  const auto* const found =
      std::find_if(std::begin(kTargets), std::end(kTargets), [&](const Target& target) {
        return name != nullptr && std::string_view(target.name) == name;
      });
  if (found != std::end(kTargets)) return *found;
  std::fputs("LEFORT_FUZZ_TARGET must be one of:", stderr);
  for (const Target& target : kTargets) std::fprintf(stderr, " %s", target.name);
  std::fputs("\n", stderr);
  std::exit(2);
}

}  // namespace
}  // namespace lefort

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const lefort::Target& target = lefort::chosen_target();
  target.run({reinterpret_cast<const char*>(data), size});
  return 0;
}
