#include <lefort/io/internal/plist.h>

#include <expat.h>
#include <fmt/format.h>

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>
#include <vector>

namespace lefort::io {

namespace {

constexpr std::size_t kMaxPlistBytes = 1 << 20;
constexpr std::size_t kMaxPlistDepth = 32;
constexpr std::size_t kMaxLeaves = 10'000;

/// State of the parser; expat calls its static members.
class Collector {
 public:
  explicit Collector(XML_Parser parser) : parser_(parser) {}

  [[nodiscard]] FlatPlist take_leaves() { return std::move(leaves_); }

  static void on_start(void* self, const char* element, const char** /*attributes*/) {
    static_cast<Collector*>(self)->start(element);
  }
  static void on_end(void* self, const char* element) {
    static_cast<Collector*>(self)->end(element);
  }
  static void on_text(void* self, const char* text, int length) {
    static_cast<Collector*>(self)->text_.append(text, static_cast<std::size_t>(length));
  }
  /// The document type of property lists declares nothing itself. Entities, which another one can
  /// declare, expand small XML to large text.
  static void on_doctype(void* self, const char*, const char*, const char*, int declares) {
    if (declares != 0) XML_StopParser(static_cast<Collector*>(self)->parser_, XML_FALSE);
  }

 private:
  /// An open dict or array.
  struct Container {
    std::string path;
    std::optional<std::size_t> next;  ///< Index of the next item of an array.
    std::string key;                  ///< The last key of a dict.
  };

  void start(std::string_view element) {
    text_.clear();
    if (element == "dict" || element == "array") {
      if (open_.size() >= kMaxPlistDepth) {
        XML_StopParser(parser_, XML_FALSE);
        return;
      }
      Container container{.path = open_.empty() ? "" : next_path() + "/", .next = {}, .key = {}};
      if (element == "array") container.next = 0;
      open_.push_back(std::move(container));
    }
  }

  void end(std::string_view element) {
    if (element == "dict" || element == "array") {
      open_.pop_back();  // Expat has checked that elements are nested.
    } else if (element == "key") {
      if (!open_.empty()) open_.back().key = text_;
    } else if (element != "plist" && !open_.empty()) {
      leaves_.insert_or_assign(next_path(), text_);
      if (leaves_.size() > kMaxLeaves) XML_StopParser(parser_, XML_FALSE);
    }
  }

  /// Path of the next value.
  std::string next_path() {
    Container& in = open_.back();
    return in.path + (in.next ? std::to_string((*in.next)++) : in.key);
  }

  XML_Parser parser_;
  std::vector<Container> open_;
  std::string text_;
  FlatPlist leaves_;
};

}  // namespace

Result<FlatPlist> read_plist(std::string_view xml) {
  if (xml.size() > kMaxPlistBytes)
    return fail(ErrorCode::kFileCorrupt,
                fmt::format("the property list has {} bytes, expected at most {}", xml.size(),
                            kMaxPlistBytes));
  const std::unique_ptr<std::remove_pointer_t<XML_Parser>, void (*)(XML_Parser)> parser(
      XML_ParserCreate(nullptr), XML_ParserFree);
  Collector collector(parser.get());
  XML_SetUserData(parser.get(), &collector);
  XML_SetElementHandler(parser.get(), Collector::on_start, Collector::on_end);
  XML_SetCharacterDataHandler(parser.get(), Collector::on_text);
  XML_SetStartDoctypeDeclHandler(parser.get(), Collector::on_doctype);
  if (XML_Parse(parser.get(), xml.data(), static_cast<int>(xml.size()), XML_TRUE) != XML_STATUS_OK)
    return fail(ErrorCode::kFileCorrupt, fmt::format("the property list is damaged in line {}",
                                                     XML_GetCurrentLineNumber(parser.get())));
  return collector.take_leaves();
}

}  // namespace lefort::io
