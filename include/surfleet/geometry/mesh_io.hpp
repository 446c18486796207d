// SPDX-License-Identifier: MIT
/// @file
/// @brief Meshes and point clouds from files and into files.
///
/// Readers take .ply (text and binary), .obj, .stl (text and binary) and .off, and for clouds
/// .ply and .xyz. They trust no number of a file before they have checked it: what is malformed,
/// truncated, not finite, out of range or without triangles is refused with an `Error` of one
/// line. Each has a twin `parse_…` that works on bytes in memory. Cost: O(bytes).
#pragma once

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include <surfleet/core/binary_io.hpp>
#include <surfleet/core/error.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/geometry/ply.hpp>
#include <surfleet/geometry/point_cloud.hpp>
#include <surfleet/geometry/text_scanner.hpp>
#include <surfleet/geometry/triangle_mesh.hpp>

namespace surfleet {
namespace detail {
/// Where in a file; the text is made only when a message needs it.
struct FileLine {
  const std::string& name;
  std::size_t line;
  void require(bool ok, const char* message) const {
    if (!ok) throw Error(name + ", line " + std::to_string(line) + ": " + message);
  }
};

/// Three numbers from the words of a line.
inline Point3 parse_point(TextScanner& words, const FileLine& where) {
  Point3 p;
  for (int k = 0; k < 3; ++k) {
    const auto word = words.next_word();
    const auto value = word ? parse_number<double>(*word) : std::nullopt;
    where.require(value.has_value(), "expected three numbers");
    p[k] = *value;
  }
  return p;
}

/// The word as a whole number; −1 if it is none or missing.
inline std::int64_t whole_number(const std::optional<std::string_view>& word) {
  return word ? parse_number<std::int64_t>(*word).value_or(-1) : -1;
}

/// Collects corners that come without indices; equal positions become one vertex.
class ExactWelder {
 public:
  explicit ExactWelder(TriangleMesh& mesh) : mesh_(mesh) {}
  std::int32_t index(const Point3& position) {
    const Point3 p = position + Point3::Zero();  // −0 becomes +0
    std::array<std::uint64_t, 3> key;
    std::memcpy(key.data(), p.data(), sizeof(key));
    const auto [at, is_new] =
        index_.try_emplace(key, static_cast<std::int32_t>(mesh_.vertices.size()));
    if (is_new) mesh_.vertices.push_back(p);
    return at->second;
  }

 private:
  struct Hash {
    std::size_t operator()(const std::array<std::uint64_t, 3>& k) const {
      return static_cast<std::size_t>(mix64(k[0] ^ mix64(k[1] ^ mix64(k[2]))));
    }
  };
  TriangleMesh& mesh_;
  std::unordered_map<std::array<std::uint64_t, 3>, std::int32_t, Hash> index_;
};

inline TriangleMesh parse_obj(std::string_view text, const std::string& name) {
  TriangleMesh mesh;
  std::vector<std::int32_t> polygon;
  std::vector<std::pair<std::int64_t, std::size_t>> highest;  // index used ahead of its vertex
  std::string joined;
  TextScanner lines(text);
  while (auto line = lines.next_line()) {
    if (!line->empty() && line->back() == '\\') {  // continued on the next line
      joined.assign(line->substr(0, line->size() - 1));
      while (auto more = lines.next_line()) {
        const bool again = !more->empty() && more->back() == '\\';
        joined.append(" ").append(again ? more->substr(0, more->size() - 1) : *more);
        if (!again) break;
      }
      line = joined;
    }
    TextScanner words(*line);
    const auto keyword = words.next_word();
    if (!keyword) continue;
    const FileLine where{name, lines.line()};
    if (*keyword == "v") {
      const Point3 p = parse_point(words, where);
      check_coordinates(p, mesh.vertices.size(), name);
      mesh.vertices.push_back(p);
    } else if (*keyword == "f") {
      polygon.clear();
      while (const auto word = words.next_word()) {
        const auto value = parse_number<std::int64_t>(word->substr(0, word->find('/')));
        where.require(value && *value != 0,
                      "expected face corners as v, v/vt, v//vn or v/vt/vn, counted from 1");
        const std::int64_t index =
            *value > 0 ? *value - 1 : static_cast<std::int64_t>(mesh.vertices.size()) + *value;
        where.require(index >= 0 && index < INT32_MAX, "vertex index out of range");
        polygon.push_back(static_cast<std::int32_t>(index));
        if (index >= static_cast<std::int64_t>(mesh.vertices.size()))
          highest.emplace_back(index, lines.line());
      }
      where.require(polygon.size() >= 3, "expected a face of three or more corners");
      mesh.add_fan(polygon);
    }
  }
  for (const auto& [index, line] : highest)
    FileLine{name, line}.require(index < static_cast<std::int64_t>(mesh.vertices.size()),
                                 "vertex index beyond the number of vertices in the file");
  return mesh;
}

inline TriangleMesh parse_stl(std::span<const std::byte> bytes, const std::string& name) {
  constexpr std::size_t kHeader = 84, kFacet = 50;
  TriangleMesh mesh;
  ExactWelder welder(mesh);
  const auto corner = [&](const Point3& p) {
    check_coordinates(p, mesh.vertices.size(), name);
    return welder.index(p);
  };
  const std::string_view text = text_of(bytes);
  std::uint64_t count = 0;
  if (bytes.size() >= kHeader) {
    std::uint32_t n;
    std::memcpy(&n, bytes.data() + 80, sizeof(n));
    count = n;
  }
  const bool fits = bytes.size() >= kHeader && bytes.size() - kHeader == count * kFacet;
  TextScanner words(text);
  const auto first = words.next_word();
  const bool is_text = !fits && first == "solid" && text.find("facet") != std::string_view::npos;
  if (!is_text) {
    require(bytes.size() >= kHeader && bytes.size() - kHeader >= count * kFacet,
            name + ": ends early or is no STL file; its header promises " + std::to_string(count) +
                " triangles");
    ByteReader in(bytes.subspan(kHeader), name);
    for (std::uint64_t t = 0; t < count; ++t) {
      const auto values = in.get<std::array<float, 12>>();  // normal, then three corners
      in.take(2);
      Triangle triangle{};
      for (std::size_t k = 0; k < 3; ++k)
        triangle[k] =
            corner(Eigen::Vector3f(values[3 * k + 3], values[3 * k + 4], values[3 * k + 5])
                       .cast<double>());
      mesh.triangles.push_back(triangle);
    }
    return mesh;
  }
  std::vector<std::int32_t> polygon;
  bool in_loop = false, ended = false;
  words.next_line();  // the solid's name
  while (const auto word = words.next_word()) {
    ended = *word == "endsolid";
    if (*word == "outer") {
      polygon.clear();
      in_loop = true;
    } else if (*word == "vertex") {
      const FileLine where{name, words.line() + 1};
      where.require(in_loop, "a vertex outside a loop");
      polygon.push_back(corner(parse_point(words, where)));
    } else if (*word == "endloop") {
      FileLine{name, words.line() + 1}.require(in_loop && polygon.size() == 3,
                                               "expected facets of three vertices");
      mesh.add_fan(polygon);
      in_loop = false;
    } else if (*word == "endsolid" || *word == "solid") {
      words.next_line();  // the rest is a name
    }
  }
  require(ended && !in_loop, name + ": ends without endsolid; expected a complete file");
  return mesh;
}

inline TriangleMesh parse_off(std::string_view text, const std::string& name) {
  TextScanner lines(text);
  // The next line with something on it but a comment.
  const auto content = [&]() -> std::string_view {
    while (auto line = lines.next_line()) {
      const auto useful = line->substr(0, line->find('#'));
      if (std::any_of(useful.begin(), useful.end(),
                      [](char c) { return !TextScanner::is_space(c); }))
        return useful;
    }
    throw Error(name + ": ends early; expected a complete OFF file");
  };
  std::string_view line = content();
  TextScanner head(line);
  const auto keyword = head.next_word();
  require(keyword && (*keyword == "OFF" || *keyword == "COFF" || *keyword == "NOFF" ||
                      *keyword == "CNOFF"),
          name + ": not an OFF file; expected OFF, COFF, NOFF or CNOFF in its first line");
  auto word = head.next_word();
  if (!word) {
    head = TextScanner(content());
    word = head.next_word();
  }
  const std::int64_t vertices = whole_number(word);
  const std::int64_t faces = whole_number(head.next_word());
  require(vertices >= 0 && faces >= 0, name + ": expected the numbers of vertices and faces");
  // A vertex takes at least "0 0 0\n", a face "3 0 0 0\n".
  const auto room = static_cast<std::int64_t>(lines.remaining()) + 1;
  require(vertices <= room / 6 && faces <= room / 2,
          name + ": ends early; its header promises more than the file can hold");
  TriangleMesh mesh;
  mesh.vertices.reserve(static_cast<std::size_t>(vertices));
  for (std::int64_t i = 0; i < vertices; ++i) {
    TextScanner words(content());
    const Point3 p = parse_point(words, {name, lines.line()});
    check_coordinates(p, mesh.vertices.size(), name);
    mesh.vertices.push_back(p);
  }
  std::vector<std::int32_t> polygon;
  for (std::int64_t i = 0; i < faces; ++i) {
    TextScanner words(content());
    const FileLine where{name, lines.line()};
    const std::int64_t size = whole_number(words.next_word());
    where.require(size >= 0 && size <= static_cast<std::int64_t>(words.remaining()),
                  "expected a face's number of corners");
    polygon.clear();
    for (std::int64_t k = 0; k < size; ++k) {
      const std::int64_t index = whole_number(words.next_word());
      where.require(index >= 0 && index < vertices,
                    "expected vertex indices below the number of vertices");
      polygon.push_back(static_cast<std::int32_t>(index));
    }
    mesh.add_fan(polygon);
  }
  return mesh;
}

inline std::string lower_extension(const std::filesystem::path& path) {
  std::string e = path.extension().string();
  std::transform(e.begin(), e.end(), e.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return e;
}
}  // namespace detail

/// The mesh in `bytes`, whose format `extension` (".ply", ".obj", ".stl" or ".off") tells. `name`
/// stands in front of messages. STL corners with equal coordinates are welded.
inline TriangleMesh parse_mesh(std::span<const std::byte> bytes, std::string_view extension,
                               const std::string& name) {
  const std::string_view text = text_of(bytes);
  TriangleMesh mesh;
  if (extension == ".ply")
    mesh = parse_ply(bytes, name);
  else if (extension == ".obj")
    mesh = detail::parse_obj(text, name);
  else if (extension == ".stl")
    mesh = detail::parse_stl(bytes, name);
  else if (extension == ".off")
    mesh = detail::parse_off(text, name);
  else
    throw Error(name + ": unknown kind of mesh file; expected .ply, .obj, .stl or .off");
  require(!mesh.triangles.empty(), name + ": no triangles; expected a mesh with faces");
  return mesh;
}

/// Reads a mesh file; see `parse_mesh`.
inline TriangleMesh read_mesh(const std::filesystem::path& path) {
  const std::string extension = detail::lower_extension(path);
  require(extension == ".ply" || extension == ".obj" || extension == ".stl" || extension == ".off",
          path.string() + ": unknown kind of mesh file; expected .ply, .obj, .stl or .off");
  return parse_mesh(read_file(path), extension, path.string());
}

/// The points in `bytes`: the vertices of a ".ply" file, or ".xyz" text with a point a line and
/// any further columns, comments (# or //) and blank lines ignored. Throws `Error` if there are
/// none.
inline PointCloud parse_point_cloud(std::span<const std::byte> bytes, std::string_view extension,
                                    const std::string& name) {
  PointCloud cloud;
  if (extension == ".ply") {
    TriangleMesh mesh = parse_ply(bytes, name);
    cloud.points = std::move(mesh.vertices);
    cloud.normals = std::move(mesh.normals);
    cloud.colors = std::move(mesh.colors);
  } else if (extension == ".xyz") {
    TextScanner lines(text_of(bytes));
    while (const auto line = lines.next_line()) {
      TextScanner words(*line);
      const auto first = words.next_word();
      if (!first || first->starts_with('#') || first->starts_with("//")) continue;
      TextScanner again(*line);
      const Point3 p = detail::parse_point(again, {name, lines.line()});
      detail::check_coordinates(p, cloud.size(), name);
      cloud.points.push_back(p);
    }
  } else {
    throw Error(name + ": unknown kind of point cloud; expected .ply or .xyz");
  }
  require(!cloud.points.empty(), name + ": no points; expected at least one");
  return cloud;
}

/// Reads a point cloud; see `parse_point_cloud`.
inline PointCloud read_point_cloud(const std::filesystem::path& path) {
  const std::string extension = detail::lower_extension(path);
  require(extension == ".ply" || extension == ".xyz",
          path.string() + ": unknown kind of point cloud; expected .ply or .xyz");
  return parse_point_cloud(read_file(path), extension, path.string());
}

/// Writes a binary PLY file, whole or not at all. Throws `Error` if it cannot.
inline void write_ply(const TriangleMesh& mesh, const std::filesystem::path& path) {
  write_file(path, ply_bytes(mesh));
}
inline void write_ply(const PointCloud& cloud, const std::filesystem::path& path) {
  ByteWriter out;
  detail::put_ply_vertices(out, cloud, cloud.points, 0, false);
  write_file(path, out.bytes());
}
}  // namespace surfleet
