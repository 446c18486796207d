// SPDX-License-Identifier: MIT
#include <surfleet/geometry/mesh_io.hpp>

#include <surfleet/geometry/mesh_primitives.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
TriangleMesh parse(std::string_view text, std::string_view extension) {
  return parse_mesh(std::as_bytes(std::span<const char>(text)), extension, "test");
}
std::string message(std::string_view text, std::string_view extension) {
  try {
    parse(text, extension);
  } catch (const Error& e) {
    CHECK(std::string_view(e.what()).find('\n') == std::string_view::npos);
    return e.what();
  }
  return "";
}
bool refuses(std::string_view text, std::string_view extension) {
  return !message(text, extension).empty();
}
std::filesystem::path scratch(const char* name) {
  return std::filesystem::temp_directory_path() / (std::string("surfleet_mesh_io_") + name);
}
std::string swapped_ply() {  // a quad, big-endian, with properties to skip
  std::string s =
      "ply\r\nformat binary_big_endian 1.0\r\ncomment hello world\r\nelement vertex 4\r\n"
      "property float x\r\nproperty double y\r\nproperty short quality\r\nproperty float z\r\n"
      "element extra 2\r\nproperty list uchar float junk\r\nelement face 1\r\n"
      "property uchar flag\r\nproperty list ushort uint vertex_index\r\nend_header\r\n";
  const auto put = [&s](const auto& value) {
    const auto* p = reinterpret_cast<const char*>(&value);
    for (std::size_t i = sizeof(value); i > 0; --i) s += p[i - 1];
  };
  for (int i = 0; i < 4; ++i) {
    put(static_cast<float>(i == 1 || i == 2));
    put(static_cast<double>(i >= 2));
    put(std::int16_t{7});
    put(0.5F);
  }
  put(std::uint8_t{2}), put(1.0F), put(2.0F), put(std::uint8_t{0});
  put(std::uint8_t{1}), put(std::uint16_t{4});
  for (std::uint32_t i = 0; i < 4; ++i) put(i);
  return s;
}
const char* const kTextPly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
    "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
    "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 255 0 0\n1 0 0 0 255 0\n1 1 0 0 0 255\n0 1 0.5e0 9 9 9\n3 0 1 2\n3 0 2 3\n";
const char* const kTextStl =
    "solid a facet in a name\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n"
    "   vertex 1 1 0\n  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n"
    "   vertex 1 1 0\n   vertex 0 1 -0\n  endloop\n endfacet\nendsolid a facet in a name\n";
std::string binary_stl(const TriangleMesh& mesh, std::uint32_t count) {
  std::string s(80, ' ');
  s.replace(0, 5, "solid");  // as some programs write
  s.append(reinterpret_cast<const char*>(&count), 4);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    s.append(12, '\0');
    for (std::size_t k = 0; k < 3; ++k)
      for (int i = 0; i < 3; ++i) {
        const auto x = static_cast<float>(mesh.corner(t, k)[i]);
        s.append(reinterpret_cast<const char*>(&x), 4);
      }
    s.append(2, '\0');
  }
  return s;
}
}  // namespace

TEST(ply_round_trip_keeps_everything) {
  TriangleMesh mesh = make_sphere({1e6, 0.1, -3}, 2.0, 1);
  mesh.normals = vertex_normals(mesh);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
    mesh.colors.push_back({static_cast<std::uint8_t>(i), 2, 255});
  const auto path = scratch("round.ply");
  write_ply(mesh, path);
  const TriangleMesh back = read_mesh(path);
  CHECK(back.vertices == mesh.vertices && back.triangles == mesh.triangles);
  CHECK(back.normals == mesh.normals && back.colors == mesh.colors);
  PointCloud cloud{mesh.vertices, mesh.normals, {}};
  write_ply(cloud, path);
  const PointCloud cloud_back = read_point_cloud(path);
  CHECK(cloud_back.points == cloud.points && cloud_back.normals == cloud.normals);
  CHECK(cloud_back.colors.empty());
  CHECK_THROWS(Error, read_mesh(path));  // no faces
  std::filesystem::remove(path);
}

TEST(ply_variants) {
  const TriangleMesh text = parse(kTextPly, ".ply");
  CHECK(text.vertices.size() == 4 && text.triangles.size() == 2 && text.colors.size() == 4);
  CHECK(text.vertices[3] == Point3(0, 1, 0.5) && text.colors[1][1] == 255);
  const TriangleMesh big = parse(swapped_ply(), ".ply");
  CHECK(big.triangles.size() == 2 && big.triangles[1] == Triangle{0, 2, 3});
  CHECK(big.vertices[2] == Point3(1, 1, 0.5));
}

TEST(obj_variants) {
  const TriangleMesh mesh = parse(
      "# a comment\nmtllib none\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 +0 0.5 0.5 0.5\nv 0 1 0\nvt 0 0\n"
      "vn 0 0 1\ng part\nf 1/1/1 2//1 3/1 \\\n 4\nf -4 -3 -2\n",
      ".obj");
  CHECK(mesh.vertices.size() == 4 && mesh.triangles.size() == 3);
  CHECK(mesh.triangles[1] == Triangle{0, 2, 3} && mesh.triangles[2] == Triangle{0, 1, 2});
  CHECK(parse("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", ".obj").triangles.size() == 1);
  for (const char* bad :
       {"v 0 0\n", "v a 0 0\n", "v 0 0 0\nf 1 1\n", "v 0 0 0\nf 1 1 2\n", "v 0 0 0\nf 1 1 0\n",
        "v 0 0 0\nf -2 1 1\n", "v nan 0 0\nf 1 1 1\n", "v 1e999 0 0\nf 1 1 1\n",
        "v 0 0 0\nf 1 1 99999999999999999999\n", "v 0 0 0\nf x y z\n", "", "v 0 0 0\n"})
    CHECK(refuses(bad, ".obj"));
}

TEST(stl_variants_are_welded) {
  const TriangleMesh text = parse(kTextStl, ".stl");
  CHECK(text.vertices.size() == 4 && text.triangles.size() == 2);
  const TriangleMesh box = make_box({0, 0, 0}, {1, 2, 3});
  const TriangleMesh binary = parse(binary_stl(box, 12), ".stl");
  CHECK(binary.vertices.size() == 8 && binary.triangles.size() == 12);
  CHECK_NEAR(binary.area(), box.area(), 1e-6);
  CHECK(refuses(binary_stl(box, 13), ".stl"));
  CHECK(refuses(binary_stl(box, 0xFFFFFFFFU), ".stl"));
  CHECK(refuses(binary_stl(TriangleMesh{}, 0), ".stl"));
  CHECK(refuses("", ".stl") && refuses("hello", ".stl"));
  const std::string cut = kTextStl;
  CHECK(refuses(cut.substr(0, cut.find("endloop")), ".stl"));
  CHECK(refuses(cut.substr(0, cut.find("endsolid")), ".stl"));
  CHECK(refuses(cut.substr(0, cut.find("endfacet") + 20), ".stl"));
  CHECK(refuses(cut.substr(0, cut.find("endloop")) + "endsolid", ".stl"));
}

TEST(off_variants) {
  const TriangleMesh mesh = parse(
      "OFF # header\n\n4 1 0\n0 0 0\n1 0 0 # point\n1 1 0\n0 1 0\n\n4 0 1 2 3 255 0 0\n", ".off");
  CHECK(mesh.vertices.size() == 4 && mesh.triangles.size() == 2);
  CHECK(parse("COFF 3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2", ".off")
            .triangles.size() == 1);
  for (const char* bad : {"OFF\n4 1\n0 0 0\n", "OFF\n-1 2 0\n", "OFF\n9999999999 1 0\n0 0 0\n",
                          "OFF\n1 1 0\n0 0 0\n3 0 0 1\n", "OFF\n1 1 0\n0 0 0\n3 0 0\n", "off\n",
                          "OFF\n1 1 0\n0 0 0\n18446744073709551615 0\n", ""})
    CHECK(refuses(bad, ".off"));
}

TEST(malformed_ply_is_refused) {
  const std::string good = kTextPly;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string s = good;
    return s.replace(s.find(from), from.size(), to);
  };
  CHECK(!refuses(good, ".ply"));
  for (const auto& [from, to] :
       std::vector<std::pair<std::string, std::string>>{{"ply\n", "plx\n"},
                                                        {"ascii", "morse"},
                                                        {"vertex 4", "vertex -4"},
                                                        {"vertex 4", "vertex 4000000000000"},
                                                        {"vertex 4", "vertex 5"},
                                                        {"vertex 4", "node 4"},
                                                        {"float x", "float w"},
                                                        {"float x", "string x"},
                                                        {"list uchar", "list float"},
                                                        {"face 2", "face 18446744073709551615"},
                                                        {"3 0 2 3", "3 0 2 4"},
                                                        {"3 0 2 3", "3 0 2 -1"},
                                                        {"3 0 2 3", "3 0 2 1.5"},
                                                        {"3 0 2 3", "300 0 2 3"},
                                                        {"0.5e0", "nan"},
                                                        {"0.5e0", "inf"},
                                                        {"0.5e0", "1e300"},
                                                        {"0.5e0", "zero"},
                                                        {"end_header\n", ""},
                                                        {"format ascii 1.0\n", ""},
                                                        {"element face 2\n", "element face 0\n"},
                                                        {"property list", "property lost"}})
    CHECK(refuses(with(from, to), ".ply"));
  const std::string big = swapped_ply();
  for (const std::string& whole : {good.substr(0, good.size() - 1), big})
    for (std::size_t n = 0; n + 1 < whole.size(); ++n)
      CHECK(refuses(std::string_view(whole).substr(0, n), ".ply"));
  CHECK(message(with("3 0 2 3", "3 0 2 4"), ".ply").find("vertex 4 of 4") != std::string::npos);
}

TEST(missing_and_unknown_files_are_refused) {
  CHECK_THROWS(Error, read_mesh("/nonexistent/mesh.ply"));
  CHECK_THROWS(Error, read_mesh("mesh.gltf"));
  CHECK_THROWS(Error, read_point_cloud("cloud.las"));
  CHECK_THROWS(Error, write_ply(TriangleMesh{}, "/nonexistent/folder/mesh.ply"));
}

TEST(xyz_clouds) {
  const std::string_view text = "# x y z\n0 0 0\n\n 1 2 3 255 0 0\r\n// c\n-1e-3 0 1\n";
  const auto bytes = std::as_bytes(std::span<const char>(text));
  const PointCloud cloud = parse_point_cloud(bytes, ".xyz", "test");
  CHECK(cloud.size() == 3 && cloud.points[1] == Point3(1, 2, 3));
  const std::string_view bad = "0 0\n", none = "# nothing\n";
  CHECK_THROWS(Error, parse_point_cloud(std::as_bytes(std::span<const char>(bad)), ".xyz", "t"));
  CHECK_THROWS(Error, parse_point_cloud(std::as_bytes(std::span<const char>(none)), ".xyz", "t"));
}
