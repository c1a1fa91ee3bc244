/// \file
/// A small XML checker: tags nest, attributes are quoted and distinct, text contains no markup.
#pragma once

#include <cctype>
#include <cstddef>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace lefort::report::test {

/// \returns the first error in `xml` with its position, or nothing.
inline std::string fault_of(std::string_view xml) {
  std::vector<std::string> open;
  std::size_t at = 0;
  const auto fault = [&](const std::string& what) {
    return what + " at byte " + std::to_string(at) + ": " + std::string(xml.substr(at, 60));
  };
  const auto is_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == ':';
  };
  const auto name_at = [&](std::size_t from) {
    std::size_t end = from;
    while (end < xml.size() && is_name(xml[end])) ++end;
    return std::string(xml.substr(from, end - from));
  };
  const auto bad_entity = [](std::string_view text) {
    for (std::size_t i = text.find('&'); i != text.npos; i = text.find('&', i + 1)) {
      const std::string_view rest = text.substr(i);
      bool known = false;
      for (const std::string_view entity : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"})
        known = known || rest.substr(0, entity.size()) == entity;
      if (!known) return true;
    }
    return false;
  };
  if (xml.substr(0, 15) == "<!DOCTYPE html>") at = 15;
  while (at < xml.size()) {
    const std::size_t tag = xml.find('<', at);
    const std::string_view text = xml.substr(at, tag == xml.npos ? xml.npos : tag - at);
    if (bad_entity(text)) return fault("a stray &");
    if (tag == xml.npos) break;
    at = tag;
    if (xml.substr(at, 2) == "</") {
      const std::string name = name_at(at + 2);
      if (open.empty() || open.back() != name) return fault("an end tag without its start");
      open.pop_back();
      at += 2 + name.size();
      if (at >= xml.size() || xml[at] != '>') return fault("an end tag that does not end");
      ++at;
      continue;
    }
    const std::string name = name_at(at + 1);
    if (name.empty()) return fault("a stray <");
    at += 1 + name.size();
    std::set<std::string> attributes;
    while (at < xml.size() && xml[at] != '>' && xml.substr(at, 2) != "/>") {
      if (std::isspace(static_cast<unsigned char>(xml[at])) != 0) {
        ++at;
        continue;
      }
      const std::string attribute = name_at(at);
      if (attribute.empty() || !attributes.insert(attribute).second) return fault("an attribute");
      at += attribute.size();
      if (at + 1 >= xml.size() || xml[at] != '=') return fault("an attribute without value");
      const char quote = xml[at + 1];
      if (quote != '"' && quote != '\'') return fault("an attribute without quotes");
      const std::size_t end = xml.find(quote, at + 2);
      if (end == xml.npos) return fault("an attribute without end");
      const std::string_view value = xml.substr(at + 2, end - at - 2);
      if (value.find('<') != value.npos || bad_entity(value)) return fault("an unescaped value");
      at = end + 1;
    }
    if (at >= xml.size()) return "a tag that does not end";
    if (xml[at] == '/') {
      at += 2;
    } else {
      open.push_back(name);
      ++at;
    }
  }
  return open.empty() ? "" : "<" + open.back() + "> is not closed";
}

}  // namespace lefort::report::test
