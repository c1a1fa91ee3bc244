#include <lefort/io/internal/run_in_child.h>
#include <lefort/io/internal/vtk_xml.h>

#include <fmt/format.h>

#include <cstdint>
#include <span>
#include <utility>

namespace lefort::io::internal {
namespace {

constexpr std::uint64_t kMaxXmlBytes = std::uint64_t{4} << 30;
/// Memory of a child per byte of the file: the file, its text, and the budget of parse_vtk_xml()
/// for each of the decoded bytes, the numbers and the result.
constexpr std::uint64_t kMemoryPerByte = 200;
const std::string kContents = "the contents of the file";

/// The words of a request, each ended by NUL.
std::string joined(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += word + '\0';
  return text;
}

std::vector<std::string> split(std::string_view text) {
  std::vector<std::string> words;
  for (std::size_t end = text.find('\0'); end != text.npos; end = text.find('\0')) {
    words.emplace_back(text.substr(0, end));
    text.remove_prefix(end + 1);
  }
  return words;
}

/// The task of a child. \param request  subject, type, and three words for each wanted array.
Result<void> xml_in_child(int input, std::string_view request, ResultWriter& result) {
  const std::vector<std::string> words = split(request);
  if (words.size() % 3 != 2) return tl::unexpected(damaged_result(kContents));
  std::vector<WantedArray> wanted;
  for (std::size_t n = 2; n < words.size(); n += 3)
    wanted.push_back(
        {words[n], words[n + 1], words[n + 2].empty() ? NameMatch::kWhole : NameMatch::kBeginning});
  LEFORT_TRY(const std::string bytes, read_all(input, kContents));
  LEFORT_TRY(const XmlArrays file, parse_vtk_xml(bytes, words[0], words[1], wanted));
  result.number(std::int32_t{file.pieces});
  result.number(static_cast<std::uint64_t>(file.arrays.size()));
  for (const XmlArray& array : file.arrays) {
    result.text(array.parent);
    result.text(array.name);
    result.number(std::int32_t{array.piece});
    result.array(std::span<const double>(array.values));
  }
  return {};
}

/// Reads the result of xml_in_child(); false if it is damaged.
bool take_arrays(ResultReader& result, XmlArrays& file) {
  std::int32_t pieces = 0;
  std::size_t count = 0;
  constexpr std::size_t kFewestBytes = 28;  // Three lengths and the piece.
  if (!result.number(pieces) || pieces < 0 || !result.count(count, kFewestBytes)) return false;
  file.pieces = pieces;
  for (std::size_t n = 0; n < count; ++n) {
    XmlArray array;
    std::int32_t piece = 0;
    if (!result.text(array.parent) || !result.text(array.name) || !result.number(piece) ||
        piece < 0 || piece > pieces || !result.array(array.values))
      return false;
    array.piece = piece;
    file.arrays.push_back(std::move(array));
  }
  return result.at_end();
}

}  // namespace

Result<XmlArrays> read_vtk_xml(const std::filesystem::path& file, const std::string& subject,
                               const std::string& type, const std::vector<WantedArray>& wanted,
                               Progress& progress) {
  LEFORT_TRY(const OpenedFile input, open_input(file, kMaxXmlBytes));
  std::vector<std::string> words{subject, type};
  for (const WantedArray& array : wanted)
    words.insert(words.end(), {array.parent, array.name,
                               array.match == NameMatch::kBeginning ? "beginning" : ""});
  auto values = run_in_child(input.descriptor,
                             {xml_in_child, kContents, joined(words),
                              limits_of(input.bytes, kMemoryPerByte * input.bytes)},
                             progress);
  if (!values) return tl::unexpected(std::move(values).error());
  XmlArrays arrays;
  if (!take_arrays(**values, arrays))
    return fail(ErrorCode::kFileCorrupt, fmt::format("{} is damaged", subject));
  return arrays;
}

}  // namespace lefort::io::internal
