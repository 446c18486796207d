// SPDX-License-Identifier: MIT
/// @file
/// @brief A strict check that a text is well-formed XML, as far as plots and reports use it.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace test_markup {
/// Empty if well-formed; otherwise what is wrong.
inline std::string well_formed(std::string_view text) {
  std::vector<std::string> open;
  std::size_t roots = 0;
  while (!text.empty()) {
    const std::size_t next = text.find('<');
    const std::string_view content = text.substr(0, next);
    for (std::size_t at = content.find('&'); at != content.npos; at = content.find('&', at + 1)) {
      const std::size_t end = content.find(';', at);
      if (end == content.npos || end - at > 6) return "stray ampersand";
    }
    if (open.empty() && content.find_first_not_of(" \n") != content.npos)
      return "text outside the root";
    if (next == text.npos) break;
    text.remove_prefix(next + 1);
    std::size_t end = 0;  // the '>' that is not inside a quoted attribute
    for (char quote = 0; end < text.size() && (quote != 0 || text[end] != '>'); ++end) {
      if (quote == 0 && (text[end] == '"' || text[end] == '\''))
        quote = text[end];
      else if (text[end] == quote)
        quote = 0;
      else if (text[end] == '<')
        return "'<' inside a tag";
    }
    if (end >= text.size()) return "tag without end";
    std::string_view tag = text.substr(0, end);
    text.remove_prefix(end + 1);
    if (tag.starts_with("!DOCTYPE")) continue;
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return "unmatched </" + std::string(tag);
      open.pop_back();
      continue;
    }
    const bool closed = tag.ends_with('/');
    if (closed) tag.remove_suffix(1);
    const std::size_t name_end = std::min(tag.find_first_of(" \n"), tag.size());
    const std::string name(tag.substr(0, name_end));
    if (name.empty()) return "tag without name";
    std::string_view rest = tag.substr(name_end);
    std::set<std::string> attributes;
    while (rest.find_first_not_of(" \n") != rest.npos) {
      rest.remove_prefix(rest.find_first_not_of(" \n"));
      const std::size_t equals = rest.find('=');
      if (equals == rest.npos || equals + 1 >= rest.size() || rest[equals + 1] != '"')
        return "attribute without quoted value in <" + name;
      const std::size_t close = rest.find('"', equals + 2);
      if (close == rest.npos) return "attribute without end in <" + name;
      if (!attributes.insert(std::string(rest.substr(0, equals))).second)
        return "attribute twice in <" + name;
      rest.remove_prefix(close + 1);
      if (!rest.empty() && rest[0] != ' ' && rest[0] != '\n') return "no space in <" + name;
    }
    if (open.empty() && ++roots > 1) return "two roots";
    if (!closed) open.push_back(name);
  }
  if (!open.empty()) return "<" + open.back() + "> not closed";
  return roots == 1 ? "" : "no root";
}
}  // namespace test_markup
