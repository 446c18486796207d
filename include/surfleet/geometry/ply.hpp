// SPDX-License-Identifier: MIT
/// @file
/// @brief The PLY format: text and binary of either byte order, any elements and properties.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/geometry/text_scanner.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
namespace detail {
enum class PlyType : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

inline std::size_t ply_size(PlyType t) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(t)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::float32;  ///< Of the value, or of a list's items.
  bool is_list = false;
  PlyType count_type = PlyType::uint8;
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  /// The fewest bytes that a row can take in a binary file.
  std::uint64_t least_row_bytes() const {
    std::uint64_t sum = 0;
    for (const PlyProperty& p : properties) sum += ply_size(p.is_list ? p.count_type : p.type);
    return sum;
  }
};

struct PlyHeader {
  enum class Encoding : std::uint8_t { text, little_endian, big_endian };
  Encoding encoding = Encoding::text;
  std::vector<PlyElement> elements;
  std::size_t size_bytes = 0;
};

inline PlyType ply_type(std::string_view word, const std::string& name) {
  struct Alias {
    std::string_view word;
    PlyType type;
  };
  constexpr std::array<Alias, 16> aliases{{{"char", PlyType::int8},
                                           {"int8", PlyType::int8},
                                           {"uchar", PlyType::uint8},
                                           {"uint8", PlyType::uint8},
                                           {"short", PlyType::int16},
                                           {"int16", PlyType::int16},
                                           {"ushort", PlyType::uint16},
                                           {"uint16", PlyType::uint16},
                                           {"int", PlyType::int32},
                                           {"int32", PlyType::int32},
                                           {"uint", PlyType::uint32},
                                           {"uint32", PlyType::uint32},
                                           {"float", PlyType::float32},
                                           {"float32", PlyType::float32},
                                           {"double", PlyType::float64},
                                           {"float64", PlyType::float64}}};
  for (const Alias& a : aliases)
    if (a.word == word) return a.type;
  throw Error(name + ": the PLY header names a type that does not exist; expected char to double");
}

inline PlyHeader read_ply_header(std::string_view text, const std::string& name) {
  TextScanner lines(text);
  const auto first = lines.next_line();
  require(first && *first == "ply", name + ": not a PLY file; expected 'ply' as its first line");
  PlyHeader header;
  bool has_format = false;
  while (const auto line = lines.next_line()) {
    TextScanner words(*line);
    const auto keyword = words.next_word();
    if (!keyword || *keyword == "comment" || *keyword == "obj_info") continue;
    const auto word = [&] {
      const auto w = words.next_word();
      require(w.has_value(), name + ": PLY header, line " + std::to_string(lines.line()) +
                                 ": ends early; expected a complete header line");
      return *w;
    };
    if (*keyword == "end_header") {
      require(has_format, name + ": the PLY header has no format line");
      header.size_bytes = text.size() - lines.remaining();
      return header;
    }
    if (*keyword == "format") {
      const auto format = word();
      if (format == "ascii")
        header.encoding = PlyHeader::Encoding::text;
      else if (format == "binary_little_endian")
        header.encoding = PlyHeader::Encoding::little_endian;
      else if (format == "binary_big_endian")
        header.encoding = PlyHeader::Encoding::big_endian;
      else
        throw Error(name + ": unknown PLY format; expected ascii, binary_little_endian or " +
                    "binary_big_endian");
      has_format = true;
    } else if (*keyword == "element") {
      PlyElement element;
      element.name = word();
      const auto count = parse_number<std::uint64_t>(word());
      require(count.has_value(), name + ": PLY header, line " + std::to_string(lines.line()) +
                                     ": expected a count of 0 or more");
      element.count = *count;
      header.elements.push_back(std::move(element));
    } else if (*keyword == "property") {
      require(!header.elements.empty(), name + ": PLY header: a property before any element");
      PlyProperty p;
      auto type = word();
      p.is_list = type == "list";
      if (p.is_list) {
        p.count_type = ply_type(word(), name);
        require(p.count_type < PlyType::float32,
                name + ": PLY header: the length of a list must be of an integer type");
        type = word();
      }
      p.type = ply_type(type, name);
      p.name = word();
      header.elements.back().properties.push_back(std::move(p));
    } else {
      throw Error(name + ": PLY header, line " + std::to_string(lines.line()) +
                  ": expected format, element, property, comment or end_header");
    }
  }
  throw Error(name + ": the PLY header does not end; expected a line 'end_header'");
}

/// The values of a PLY body one after another, whatever its encoding.
class PlyValues {
 public:
  PlyValues(std::span<const std::byte> body, PlyHeader::Encoding encoding, const std::string& name)
      : bytes_(body, name), words_(text_of(body)), encoding_(encoding), name_(name) {}

  /// Throws unless `rows` rows of `element` can follow.
  void expect_rows(const PlyElement& element) const {
    const bool text = encoding_ == PlyHeader::Encoding::text;
    // A text value takes at least a digit and a separator.
    const std::uint64_t least = text ? 2 * element.properties.size() : element.least_row_bytes();
    const std::uint64_t have = text ? words_.remaining() + 1 : bytes_.remaining();
    require(least == 0 || element.count <= have / least,
            name_ + ": ends early; its header promises " + std::to_string(element.count) +
                " rows of " + element.name + ", more than the file can hold");
  }

  double next(PlyType type) {
    if (encoding_ == PlyHeader::Encoding::text) {
      const auto word = words_.next_word();
      if (!word) throw Error(name_ + ": ends early; expected a complete file");
      const auto value = parse_number<double>(*word);
      if (!value)
        throw Error(name_ + ": expected a number in line " + std::to_string(words_.line() + 1) +
                    " of the PLY body");
      return *value;
    }
    const std::size_t size = ply_size(type);
    std::array<std::byte, 8> raw{};
    std::memcpy(raw.data(), bytes_.take(size).data(), size);
    if (encoding_ == PlyHeader::Encoding::big_endian)
      std::reverse(raw.begin(), raw.begin() + static_cast<std::ptrdiff_t>(size));
    switch (type) {
      case PlyType::int8:
        return as<std::int8_t>(raw);
      case PlyType::uint8:
        return as<std::uint8_t>(raw);
      case PlyType::int16:
        return as<std::int16_t>(raw);
      case PlyType::uint16:
        return as<std::uint16_t>(raw);
      case PlyType::int32:
        return as<std::int32_t>(raw);
      case PlyType::uint32:
        return as<std::uint32_t>(raw);
      case PlyType::float32:
        return static_cast<double>(as_float<float>(raw));
      case PlyType::float64:
        break;
    }
    return as_float<double>(raw);
  }

  /// The length of a list, checked against what remains.
  std::size_t next_length(const PlyProperty& p) {
    const double value = next(p.count_type);
    const bool text = encoding_ == PlyHeader::Encoding::text;
    const double have = text ? 0.5 * static_cast<double>(words_.remaining() + 1)
                             : static_cast<double>(bytes_.remaining() / ply_size(p.type));
    if (!(value >= 0.0 && value <= have && value == std::floor(value)))
      throw Error(name_ + ": a list is longer than the file; expected a complete, undamaged file");
    return static_cast<std::size_t>(value);
  }

 private:
  template <typename T>
  static double as(const std::array<std::byte, 8>& raw) {
    return static_cast<double>(as_float<T>(raw));
  }
  template <typename T>
  static T as_float(const std::array<std::byte, 8>& raw) {
    T value;
    std::memcpy(&value, raw.data(), sizeof(T));
    return value;
  }

  ByteReader bytes_;
  TextScanner words_;
  PlyHeader::Encoding encoding_;
  const std::string& name_;
};

/// Checks a coordinate read from a file. The limit keeps products of coordinates finite.
inline void check_coordinates(const Point3& p, std::size_t index, const std::string& name) {
  constexpr double kFarthest = 1e9;
  if (!(p.allFinite() && p.cwiseAbs().maxCoeff() <= kFarthest))
    throw Error(name + ": vertex " + std::to_string(index) +
                " is NaN, infinite or beyond 1e9; expected finite coordinates in metres");
}
}  // namespace detail

/// Reads the vertices, their attributes and the faces of a PLY file held in memory.
///
/// Polygons become fans; unknown elements and properties are skipped. The result may have no
/// triangles. Throws `Error`, with `name` in front, on anything malformed. O(bytes).
inline TriangleMesh parse_ply(std::span<const std::byte> bytes, const std::string& name) {
  using detail::PlyElement;
  using detail::PlyProperty;
  const std::string_view text = text_of(bytes);
  const detail::PlyHeader header = detail::read_ply_header(text, name);
  detail::PlyValues values(bytes.subspan(header.size_bytes), header.encoding, name);
  TriangleMesh mesh;
  std::vector<std::int32_t> polygon;
  bool has_vertices = false;

  for (const PlyElement& element : header.elements) {
    if (element.properties.empty()) continue;
    values.expect_rows(element);
    const bool is_vertex = element.name == "vertex";
    const bool is_face = element.name == "face";
    // Where each property goes: 0-2 position, 3-5 normal, 6-8 colour, 9 the vertices of a face.
    constexpr std::array<std::string_view, 9> kNames{"x",  "y",   "z",     "nx",  "ny",
                                                     "nz", "red", "green", "blue"};
    constexpr std::size_t kIndices = 9, kSkip = 10;
    std::vector<std::size_t> slots;
    std::array<bool, 11> has{};
    for (const PlyProperty& p : element.properties) {
      std::size_t slot = kSkip;
      if (is_vertex && !p.is_list) {
        const auto found = std::find(kNames.begin(), kNames.end(), p.name);
        if (found != kNames.end()) slot = static_cast<std::size_t>(found - kNames.begin());
      } else if (is_face && p.is_list && (p.name == "vertex_indices" || p.name == "vertex_index")) {
        slot = kIndices;
      }
      has[slot] = true;
      slots.push_back(slot);
    }
    if (is_vertex) {
      require(!has_vertices, name + ": more than one vertex element; expected one");
      require(has[0] && has[1] && has[2], name + ": the vertices lack x, y or z");
      has_vertices = true;
    }
    const bool with_normals = has[3] && has[4] && has[5], with_colors = has[6] && has[7] && has[8];
    for (std::uint64_t row = 0; row < element.count; ++row) {
      std::array<double, 9> v{};
      for (std::size_t i = 0; i < slots.size(); ++i) {
        const PlyProperty& p = element.properties[i];
        if (!p.is_list) {
          double value = values.next(p.type);
          if (slots[i] >= kIndices) continue;
          if (slots[i] >= 6 && p.type >= detail::PlyType::float32) value *= 255.0;
          v[slots[i]] = value;
          continue;
        }
        const std::size_t length = values.next_length(p);
        polygon.clear();
        for (std::size_t k = 0; k < length; ++k) {
          const double value = values.next(p.type);
          if (slots[i] != kIndices) continue;
          if (!(value >= 0.0 && value <= INT32_MAX && value == std::floor(value)))
            throw Error(name + ": face " + std::to_string(row) +
                        ": expected vertex indices from 0 to 2147483647");
          polygon.push_back(static_cast<std::int32_t>(value));
        }
        if (slots[i] != kIndices) continue;
        mesh.add_fan(polygon);
      }
      if (!is_vertex) continue;
      const Point3 p(v[0], v[1], v[2]);
      detail::check_coordinates(p, mesh.vertices.size(), name);
      mesh.vertices.push_back(p);
      if (with_normals) mesh.normals.push_back(Eigen::Vector3d(v[3], v[4], v[5]).cast<float>());
      if (with_colors) {
        const auto level = [](double c) {
          return c > 0.0 ? static_cast<std::uint8_t>(std::min(c, 255.0)) : std::uint8_t{0};
        };
        mesh.colors.push_back({level(v[6]), level(v[7]), level(v[8])});
      }
    }
  }
  require(has_vertices, name + ": no vertex element; expected one with x, y and z");
  require(mesh.vertices.size() <= INT32_MAX, name + ": more than 2147483647 vertices");
  const auto n = static_cast<std::int32_t>(mesh.vertices.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t index : mesh.triangles[t])
      if (index >= n)
        throw Error(name + ": triangle " + std::to_string(t) + " uses vertex " +
                    std::to_string(index) + " of " + std::to_string(n) +
                    "; expected indices below the number of vertices");
  return mesh;
}

namespace detail {
template <typename Cloud>
void put_ply_vertices(ByteWriter& out, const Cloud& cloud, const std::vector<Point3>& points,
                      std::size_t faces, bool with_faces) {
  const bool normals = cloud.normals.size() == points.size() && !points.empty();
  const bool colors = cloud.colors.size() == points.size() && !points.empty();
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(points.size()) +
                       "\nproperty double x\nproperty double y\nproperty double z\n";
  if (normals) header += "property float nx\nproperty float ny\nproperty float nz\n";
  if (colors) header += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  if (with_faces)
    header +=
        "element face " + std::to_string(faces) + "\nproperty list uchar int vertex_indices\n";
  out.put_text(header + "end_header\n");
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (int k = 0; k < 3; ++k) out.put(points[i][k]);
    if (normals)
      for (int k = 0; k < 3; ++k) out.put(cloud.normals[i][k]);
    if (colors) out.put(cloud.colors[i]);
  }
}
}  // namespace detail

/// `mesh` as a binary little-endian PLY file, coordinates in double.
inline Bytes ply_bytes(const TriangleMesh& mesh) {
  ByteWriter out;
  detail::put_ply_vertices(out, mesh, mesh.vertices, mesh.triangles.size(), true);
  for (const Triangle& t : mesh.triangles) {
    out.put(std::uint8_t{3});
    out.put(t);
  }
  return out.take();
}
}  // namespace surfleet
