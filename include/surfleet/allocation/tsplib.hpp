// SPDX-License-Identifier: MIT
/// @file
/// @brief Files in the TSPLIB format, TYPE TSP and ATSP [Reinelt 1991].
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include <surfleet/allocation/cost_matrix.hpp>
#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/parse_number.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// What a TSPLIB file holds.
struct TsplibInstance {
  std::string name;
  std::string comment;
  bool asymmetric = false;          ///< TYPE ATSP.
  CostMatrix costs;                 ///< Nodes are numbered from 0.
  std::vector<Point2> coordinates;  ///< As in the file; empty where weights are explicit.
};

namespace detail {
// The distance functions as TSPLIB defines them. nint(x) is the integer part of x + 0.5.
inline double tsplib_euc_2d(const Point2& a, const Point2& b) {
  return std::floor((a - b).norm() + 0.5);
}
inline double tsplib_ceil_2d(const Point2& a, const Point2& b) { return std::ceil((a - b).norm()); }
inline double tsplib_att(const Point2& a, const Point2& b) {
  const double r = std::sqrt((a - b).squaredNorm() / 10.0), t = std::floor(r + 0.5);
  return t < r ? t + 1.0 : t;
}
/// Coordinates are latitude and longitude as degrees.minutes.
inline double tsplib_geo(const Point2& a, const Point2& b) {
  constexpr double pi = 3.141592, earth_radius_km = 6378.388;  // as the format prescribes
  const auto angle = [](double x) {
    const double degree = std::trunc(x);
    return pi * (degree + 5.0 * (x - degree) / 3.0) / 180.0;
  };
  const double q1 = std::cos(angle(a.y()) - angle(b.y()));
  const double q2 = std::cos(angle(a.x()) - angle(b.x()));
  const double q3 = std::cos(angle(a.x()) + angle(b.x()));
  const double cosine = std::clamp(0.5 * ((1.0 + q1) * q2 - (1.0 - q1) * q3), -1.0, 1.0);
  return std::trunc(earth_radius_km * std::acos(cosine) + 1.0);
}

class TsplibParser {
 public:
  TsplibParser(std::string_view text, std::string source, int max_dimension)
      : text_(text), source_(std::move(source)), max_dimension_(max_dimension) {}

  TsplibInstance parse() {
    std::string key;
    while (next_key(key)) {
      if (key == "EOF") break;
      if (key == "NODE_COORD_SECTION") {
        read_coordinates();
      } else if (key == "EDGE_WEIGHT_SECTION") {
        read_weights();
      } else if (key == "DISPLAY_DATA_SECTION") {
        need_dimension(key);
        for (int i = 0; i < 3 * dimension_; ++i) number("display data");
      } else if (key.ends_with("_SECTION")) {
        fail(key + " is not supported; expected NODE_COORD_SECTION or EDGE_WEIGHT_SECTION");
      } else {
        set(key, value());
      }
    }
    return finish();
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(source_ + ":" + std::to_string(line_) + ": " + what);
  }
  static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }
  void skip_blanks(bool lines) {
    while (at_ < text_.size() && (blank(text_[at_]) || (lines && text_[at_] == '\n'))) {
      if (text_[at_] == '\n') ++line_;
      ++at_;
    }
  }
  static std::string shown(std::string_view token) {
    std::string s;
    for (const char c : token.substr(0, 30)) s += c >= ' ' && c < 127 ? c : '?';
    return "\"" + s + (token.size() > 30 ? "...\"" : "\"");
  }
  std::string_view token() {
    skip_blanks(true);
    const std::size_t begin = at_;
    while (at_ < text_.size() && !blank(text_[at_]) && text_[at_] != '\n') ++at_;
    return text_.substr(begin, at_ - begin);
  }
  /// The next keyword, without its colon; false at the end.
  bool next_key(std::string& key) {
    skip_blanks(true);
    const std::size_t begin = at_;
    while (at_ < text_.size() && !blank(text_[at_]) && text_[at_] != '\n' && text_[at_] != ':')
      ++at_;
    if (at_ == text_.size() && begin == at_) return false;
    const std::string_view word = text_.substr(begin, at_ - begin);
    for (const char& c : word)
      if (!((c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9' && &c != word.data())))
        fail(shown(word) + " is not a keyword; expected TSPLIB such as \"DIMENSION: 17\"");
    if (word.empty()) fail("a colon without a keyword");
    key = word;
    skip_blanks(false);
    colon_ = at_ < text_.size() && text_[at_] == ':';
    if (colon_) ++at_;
    return true;
  }
  /// The rest of the line.
  std::string value() {
    skip_blanks(false);
    std::size_t end = std::min(text_.find('\n', at_), text_.size());
    std::string_view v = text_.substr(at_, end - at_);
    at_ = end;
    while (!v.empty() && blank(v.back())) v.remove_suffix(1);
    return std::string(v);
  }
  double number(const char* what) {
    const std::string_view t = token();
    if (t.empty()) fail(std::string("the file ends where ") + what + " should follow");
    const auto x = parse_number<double>(t);
    if (!x || !std::isfinite(*x)) fail(shown(t) + " is no " + what + "; expected a finite number");
    return *x;
  }
  void set(const std::string& key, const std::string& v) {
    const std::string first = v.substr(0, v.find_first_of(" \t("));
    // What says how many numbers a section has must not change once it has been read.
    if ((key == "DIMENSION" || key == "EDGE_WEIGHT_FORMAT") &&
        (has_weights_ || !coordinates_.empty()))
      fail(key + " after the section that it is for; expected it before");
    if (key == "NAME") {
      name_ = v;
    } else if (key == "COMMENT") {
      comment_ += (comment_.empty() ? "" : "\n") + v;
    } else if (key == "TYPE") {
      if (first != "TSP" && first != "ATSP")
        fail("TYPE " + shown(v) + " is not supported; expected TSP or ATSP");
      asymmetric_ = first == "ATSP";
    } else if (key == "DIMENSION") {
      const auto [end, error] = std::from_chars(v.data(), v.data() + v.size(), dimension_);
      if (error != std::errc{} || end != v.data() + v.size() || dimension_ < 1 ||
          dimension_ > max_dimension_)
        fail("DIMENSION " + shown(v) + "; expected a number from 1 to " +
             std::to_string(max_dimension_));
    } else if (key == "EDGE_WEIGHT_TYPE") {
      weight_type_ = first;
      if (first != "EXPLICIT" && first != "EUC_2D" && first != "CEIL_2D" && first != "GEO" &&
          first != "ATT")
        fail("EDGE_WEIGHT_TYPE " + shown(v) +
             " is not supported; expected EXPLICIT, EUC_2D, CEIL_2D, GEO or ATT");
    } else if (key == "EDGE_WEIGHT_FORMAT") {
      weight_format_ = first;
    } else if (key == "NODE_COORD_TYPE") {
      if (first != "TWOD_COORDS" && first != "NO_COORDS")
        fail("NODE_COORD_TYPE " + shown(v) + " is not supported; expected TWOD_COORDS");
    } else if (!colon_ && key != "DISPLAY_DATA_TYPE" && key != "CAPACITY" &&
               key != "EDGE_DATA_FORMAT") {
      // Files carry keywords of their makers' own, which say nothing of the costs: with a colon
      // they are passed over, without they are no TSPLIB.
      fail("unknown keyword " + shown(key) + "; expected one of TSPLIB's, or a colon after it");
    }
  }
  void need_dimension(const std::string& section) const {
    if (dimension_ == 0) fail(section + " before DIMENSION; expected DIMENSION first");
  }
  void read_coordinates() {
    need_dimension("NODE_COORD_SECTION");
    if (!coordinates_.empty()) fail("a second NODE_COORD_SECTION; expected one");
    std::vector<Point2> points;  // grows with the file, not with DIMENSION
    std::vector<int> ids;
    for (int i = 0; i < dimension_; ++i) {
      const double id = number("node number");
      if (id != std::floor(id) || id < 1.0 || id > dimension_)
        fail("node number out of range; expected 1 to " + std::to_string(dimension_));
      const double x = number("coordinate"), y = number("coordinate");
      ids.push_back(static_cast<int>(id) - 1);
      points.emplace_back(x, y);
    }
    coordinates_.resize(points.size());
    std::vector<char> seen(points.size(), 0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (seen[ids[i]] != 0) fail("node " + std::to_string(ids[i] + 1) + " is given twice");
      seen[ids[i]] = 1;
      coordinates_[ids[i]] = points[i];
    }
  }
  void read_weights() {
    need_dimension("EDGE_WEIGHT_SECTION");
    if (!weights_.empty()) fail("a second EDGE_WEIGHT_SECTION; expected one");
    const std::size_t n = static_cast<std::size_t>(dimension_);
    std::size_t count = 0;
    if (weight_format_ == "FULL_MATRIX")
      count = n * n;
    else if (weight_format_ == "UPPER_ROW" || weight_format_ == "LOWER_ROW" ||
             weight_format_ == "UPPER_COL" || weight_format_ == "LOWER_COL")
      count = n * (n - 1) / 2;
    else if (weight_format_ == "UPPER_DIAG_ROW" || weight_format_ == "LOWER_DIAG_ROW" ||
             weight_format_ == "UPPER_DIAG_COL" || weight_format_ == "LOWER_DIAG_COL")
      count = n * (n + 1) / 2;
    else
      fail("EDGE_WEIGHT_FORMAT " + shown(weight_format_) +
           " is not supported; expected FULL_MATRIX, UPPER_ROW, LOWER_ROW, UPPER_DIAG_ROW or "
           "LOWER_DIAG_ROW");
    while (weights_.size() < count) weights_.push_back(number("edge weight"));
    has_weights_ = true;
  }
  TsplibInstance finish() {
    if (dimension_ == 0) fail("no DIMENSION; expected a TSPLIB file");
    if (weight_type_.empty()) fail("no EDGE_WEIGHT_TYPE; expected EXPLICIT, EUC_2D, ...");
    TsplibInstance result;
    result.name = std::move(name_);
    result.comment = std::move(comment_);
    result.asymmetric = asymmetric_;
    if (weight_type_ == "EXPLICIT") {
      if (!has_weights_) fail("no EDGE_WEIGHT_SECTION; expected one for EXPLICIT weights");
      result.costs = explicit_costs();
      return result;
    }
    if (coordinates_.empty())
      fail("no NODE_COORD_SECTION; expected one for " + weight_type_ + " weights");
    const auto metric = weight_type_ == "EUC_2D"    ? tsplib_euc_2d
                        : weight_type_ == "CEIL_2D" ? tsplib_ceil_2d
                        : weight_type_ == "GEO"     ? tsplib_geo
                                                    : tsplib_att;
    result.costs = CostMatrix(dimension_);
    for (int i = 0; i < dimension_; ++i) {
      for (int j = 0; j < dimension_; ++j) {
        if (i == j) continue;
        const double d = metric(coordinates_[i], coordinates_[j]);
        if (!std::isfinite(d)) fail("coordinates too large: a distance overflows");
        result.costs(i, j) = d;
      }
    }
    result.coordinates = std::move(coordinates_);
    return result;
  }
  CostMatrix explicit_costs() const {
    const int n = dimension_;
    CostMatrix costs(n);
    std::size_t at = 0;
    if (weight_format_ == "FULL_MATRIX") {
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) costs(i, j) = weights_[at++];
      return costs;
    }
    // A triangle's columns are the rows of the other one.
    const bool upper = weight_format_.starts_with("UPPER") != weight_format_.ends_with("COL");
    const int skip = weight_format_.find("DIAG") != std::string::npos ? 0 : 1;
    for (int i = 0; i < n; ++i) {
      const int from = upper ? i + skip : 0, to = upper ? n : i + 1 - skip;
      for (int j = from; j < to; ++j) costs(i, j) = costs(j, i) = weights_[at++];
    }
    return costs;
  }

  std::string_view text_;
  std::string source_;
  int max_dimension_;
  std::size_t at_ = 0;
  int line_ = 1;
  bool colon_ = false;  // after the last keyword
  std::string name_, comment_, weight_type_, weight_format_;
  bool asymmetric_ = false, has_weights_ = false;
  int dimension_ = 0;
  std::vector<double> weights_;
  std::vector<Point2> coordinates_;
};
}  // namespace detail

/// Reads the text of a TSPLIB file: weights EXPLICIT (full matrix, upper or lower triangle with or
/// without diagonal), EUC_2D, CEIL_2D, GEO and ATT. Throws `Error` with `source` and the line
/// number. No size is believed before as many numbers have been read; n² doubles at most
/// `max_dimension`².
inline TsplibInstance parse_tsplib(std::string_view text, const std::string& source = "tsplib",
                                   int max_dimension = 5000) {
  return detail::TsplibParser(text, source, max_dimension).parse();
}
/// The same from a file.
inline TsplibInstance read_tsplib(const std::filesystem::path& path, int max_dimension = 5000) {
  const Bytes bytes = read_file(path);
  return parse_tsplib(text_of(bytes), path.string(), max_dimension);
}

/// The instance as text: explicit weights in a full matrix, exact to the last bit.
inline std::string format_tsplib(const TsplibInstance& instance) {
  const auto one_line = [](std::string s) {
    for (char& c : s)
      if (c == '\n' || c == '\r') c = ' ';
    return s;
  };
  std::string text = "NAME: " + one_line(instance.name) +
                     "\nTYPE: " + (instance.asymmetric ? "ATSP" : "TSP") + "\n";
  if (!instance.comment.empty()) text += "COMMENT: " + one_line(instance.comment) + "\n";
  text += "DIMENSION: " + std::to_string(instance.costs.size()) +
          "\nEDGE_WEIGHT_TYPE: EXPLICIT\nEDGE_WEIGHT_FORMAT: FULL_MATRIX\nEDGE_WEIGHT_SECTION\n";
  char buffer[32];
  for (int i = 0; i < instance.costs.size(); ++i) {
    for (int j = 0; j < instance.costs.size(); ++j) {
      const auto end = std::to_chars(buffer, buffer + sizeof(buffer), instance.costs(i, j)).ptr;
      if (j > 0) text += ' ';
      text.append(buffer, end);
    }
    text += '\n';
  }
  return text + "EOF\n";
}
inline void write_tsplib(const std::filesystem::path& path, const TsplibInstance& instance) {
  write_file(path, std::string_view(format_tsplib(instance)));
}
}  // namespace surfleet
