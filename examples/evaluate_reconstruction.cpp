// SPDX-License-Identifier: MIT
/// @file
/// @brief Measures a reconstructed mesh or cloud against a reference: coverage, M3C2, distances.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/evaluation.hpp>
#include <surfleet/geometry/mesh_io.hpp>
#include <surfleet/mapping/map_file.hpp>
#include <surfleet/mapping/surface_mesh.hpp>

#include "support/cli.hpp"

namespace {
using namespace surfleet;

/// A file's surface: a mesh, also that of a saved map, or a cloud where the file has no triangles.
struct Surface {
  TriangleMesh mesh;
  PointCloud cloud;
  bool is_mesh() const { return !mesh.empty(); }
  const std::vector<Point3>& points() const { return is_mesh() ? mesh.vertices : cloud.points; }
};

Surface read_surface(const std::string& path, double known_weight) {
  Surface surface;
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  // A PLY file may hold either; its header tells.
  if (extension == ".sfm") {
    surface.mesh = extract_surface(load_map(path), {.min_weight = known_weight});
    require(surface.is_mesh(), path +
                                   ": no surface in this map; expected one that saw some, or a "
                                   "lower --known-weight");
    return surface;
  }
  bool cloud = extension == ".xyz";
  if (extension == ".ply") {
    const Bytes bytes = read_file(path);
    const std::string_view text = text_of(bytes);
    const std::string_view header = text.substr(0, text.find("end_header"));
    cloud = header.find("element face 0\n") != header.npos ||
            header.find("element face 0\r") != header.npos ||
            header.find("element face") == header.npos;
  }
  if (cloud)
    surface.cloud = read_point_cloud(path);
  else
    surface.mesh = read_mesh(path);
  return surface;
}

template <typename Keep>
PointCloud filtered(const PointCloud& cloud, Keep&& keep) {
  PointCloud kept;
  const bool normals = cloud.normals.size() == cloud.size();
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (!keep(i)) continue;
    kept.points.push_back(cloud.points[i]);
    if (normals) kept.normals.push_back(cloud.normals[i]);
  }
  return kept;
}

/// At most about `count` points, evenly picked from the order of the file.
PointCloud thinned(const PointCloud& cloud, std::size_t count) {
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / std::max<std::size_t>(count, 1));
  return filtered(cloud, [step](std::size_t i) { return i % step == 0; });
}

/// `surface` from two sides, coloured by `colors` (one a point) or plain.
void add_views(Report& report, const Surface& surface, const std::vector<Rgb>& colors,
               const std::string& caption, const std::vector<Point3>& frame, int threads) {
  for (const double azimuth : {-50.0, 130.0}) {
    Rasterizer picture(frame_points(frame, radians(azimuth), radians(28.0), 1000, 680),
                       {.threads = threads});
    if (surface.is_mesh()) {
      TriangleMesh mesh = surface.mesh;
      mesh.colors = colors;
      if (mesh.normals.size() != mesh.vertices.size()) mesh.normals.clear();
      picture.draw(mesh, {.light = colors.empty() ? 1.0 : 0.75});
    } else {
      for (std::size_t i = 0; i < surface.cloud.size(); ++i)
        picture.draw_points(std::span(&surface.cloud.points[i], 1),
                            colors.empty() ? Rgb{110, 120, 135} : colors[i], 2.5);
    }
    report.add_picture(
        encode_png(picture.image()),
        caption + (azimuth < 0.0 ? ", from the south-east" : ", from the north-west"), true);
  }
}

/// The distribution of `values` between ±`limit` as the area under a curve.
Plot histogram(const std::vector<double>& values, double limit) {
  constexpr int kBins = 80;
  std::vector<double> x, y(kBins, 0.0);
  double count = 0.0;
  for (const double v : values) {
    if (!(std::abs(v) < limit)) continue;
    y[static_cast<std::size_t>((v + limit) / (2.0 * limit) * kBins)] += 1.0;
    count += 1.0;
  }
  for (int i = 0; i < kBins; ++i) x.push_back(100.0 * limit * ((2.0 * i + 1.0) / kBins - 1.0));
  for (double& v : y) v *= 100.0 / std::max(count, 1.0);
  Plot plot;
  plot.title = "Signed distance (M3C2)";
  plot.x_label = "distance [cm]";
  plot.y_label = "share [%]";
  plot.add({.label = "", .x = x, .y = y, .filled = true});
  return plot;
}

/// How much of the reference is nearer to the reconstruction than a distance.
Plot coverage_curve(std::vector<double> distance, double e_max) {
  std::sort(distance.begin(), distance.end());
  std::vector<double> x, y;
  for (int i = 0; i <= 200; ++i) {
    const double d = 3.0 * e_max * i / 200;
    x.push_back(100.0 * d);
    y.push_back(100.0 *
                static_cast<double>(std::upper_bound(distance.begin(), distance.end(), d) -
                                    distance.begin()) /
                static_cast<double>(distance.size()));
  }
  Plot plot;
  plot.title = "Reference covered within a distance";
  plot.x_label = "distance [cm]";
  plot.y_label = "covered [%]";
  plot.y_min = 0.0;
  plot.y_max = 100.0;
  plot.add("", x, y);
  plot.add(
      {.label = "e_max", .x = {100.0 * e_max, 100.0 * e_max}, .y = {0.0, 100.0}, .dashed = true});
  return plot;
}

int evaluate_files(int argc, char** argv) {
  cli::Options app(
      "Measures a reconstruction against a reference: surface coverage at e_max, M3C2 mean, "
      "standard deviation and RMSE, and distances both ways.\nMeshes: .ply .obj .stl .off; "
      "clouds: .ply .xyz; maps as missions leave them: .sfm. Lengths in metres.");
  std::string reference_path, reconstruction_path, out, sides = "front";
  double known_weight = 0.3;
  std::vector<double> crop;
  double max_core_points = 200000;
  EvaluationOptions options;
  app.add("REFERENCE", reference_path, "True surface, mesh or cloud").required();
  app.add("RECONSTRUCTION", reconstruction_path, "Mesh or cloud to judge").required();
  app.begin_group("Judgement");
  app.add("--emax", options.e_max,
          "A reference point is covered by surface this near [m]; half a voxel's diagonal");
  app.add(
         "--sides", sides,
         "which sides of the reference are to be covered, by surface that faces the same way: "
         "front, that of its normals; both, as of a sheet that can be seen from either; any, where "
         "surfaces have no consistent side")
      .one_of({"front", "both", "any"});
  app.add("--known-weight", known_weight, "W_th: weight from which a map's voxels count")
      .positive();
  app.add("--density", options.density,
          "Points per square metre sampled on meshes; without: about 8 in an M3C2 cylinder");
  app.add("--points", max_core_points, "Reference points judged, at most about");
  app.add("--crop", crop, "Judge only this box: x0 y0 z0 x1 y1 z1 [m]").expected(6);
  app.begin_group("M3C2");
  app.add("--normal-scale", options.normal_scale,
          "M3C2 D [m]: normals of a cloud are fitted to this ball; without: twice d");
  app.add("--projection-scale", options.projection_scale,
          "M3C2 d [m]: diameter of the cylinder; without: 2/sqrt(3) e_max, a voxel");
  app.add("--max-depth", options.max_depth,
          "M3C2 cylinder to either side [m]; without: twice e_max");
  app.begin_group("Run");
  app.add("--seed", options.seed, "Seed of the sampling");
  app.add("--threads", options.threads, "Threads; results do not depend on it").within(1, 256);
  app.add("--out", out, "Folder for metrics.json, report.html and error.ply");
  app.add_examples(
      "  evaluate_reconstruction true.ply reconstruction.ply --emax 0.1 --out out/judged\n"
      "  evaluate_reconstruction scan.xyz out/mission/map.sfm --sides any");
  app.parse(argc, argv);

  const auto positive = [](double v) { return v > 0.0 && std::isfinite(v); };
  const auto positive_if_any = [&](const std::optional<double>& v) { return !v || positive(*v); };
  require(positive(options.e_max), "--emax: expected a positive length in metres");
  require(positive(max_core_points), "--points: expected a positive number");
  require(positive_if_any(options.density), "--density: expected points per m²");
  require(positive_if_any(options.normal_scale), "--normal-scale: expected a positive length");
  require(positive_if_any(options.projection_scale),
          "--projection-scale: expected a positive length");
  require(positive_if_any(options.max_depth), "--max-depth: expected a positive length");
  std::optional<Box3> box;
  if (!crop.empty()) box = cli::box_from_numbers(crop, "--crop");
  options.sided = sides != "any";
  Surface reference = read_surface(reference_path, known_weight);
  Surface reconstruction = read_surface(reconstruction_path, known_weight);

  // Reference points are judged inside the box. The reconstruction keeps a rim of e_max around
  // it, so that what covers a point beside a face of the box counts.
  if (box && reconstruction.is_mesh()) {
    const Eigen::Vector3d rim = Eigen::Vector3d::Constant(options.e_max);
    reconstruction.mesh =
        cropped(std::move(reconstruction.mesh), Box3(box->min() - rim, box->max() + rim));
  }
  const auto in_box = [&](const PointCloud& cloud) {
    return filtered(cloud, [&](std::size_t i) { return !box || box->contains(cloud.points[i]); });
  };
  if (!reconstruction.is_mesh()) reconstruction.cloud = in_box(reconstruction.cloud);
  const auto measured = [&](const Surface& s) {
    return s.is_mesh() ? MeasuredSurface::from(s.mesh, options) : MeasuredSurface::from(s.cloud);
  };
  const MeasuredSurface truth = measured(reference);
  PointCloud judged =
      thinned(in_box(truth.cloud()), static_cast<std::size_t>(std::min(max_core_points, 1e9)));
  require(judged.size() > 0,
          reference_path + ": no surface to judge by" +
              (box ? " in --crop; expected a box that meets the reference" : ""));
  if (sides == "both") {
    require(judged.normals.size() == judged.size(),
            "--sides both: " + reference_path + " has no normals; expected a mesh or a cloud with");
    judged = with_both_sides(judged);
  }
  const MeasuredSurface result = measured(reconstruction);
  if (!out.empty()) cli::prepare_output_folder(out);
  const ReconstructionEvaluation e = evaluate(judged, truth, result, options);
  const ReconstructionMetrics& m = e.metrics;

  Table table;
  table.columns = {"quantity", "value", "unit"};
  const auto centimetres = [](double v) { return format_number(100.0 * v, 2); };
  table.add_row(
      {"surface coverage within e_max", format_number(100.0 * m.surface_coverage, 2), "%"});
  table.add_row({"the same, facing either way", format_number(100.0 * m.unsided_coverage, 2), "%"});
  table.add_row({"the same by M3C2", format_number(100.0 * m.m3c2_coverage(), 2), "%"});
  table.add_row({"M3C2 mean", centimetres(m.m3c2_mean_m), "cm"});
  table.add_row({"M3C2 standard deviation", centimetres(m.m3c2_std_m), "cm"});
  table.add_row({"RMSE", centimetres(m.rmse_m), "cm"});
  table.add_row({"RMSE without pruning at e_max", centimetres(m.unpruned_rmse_m), "cm"});
  table.add_row({"reference to reconstruction, mean", centimetres(m.completeness_mean_m), "cm"});
  table.add_row({"reference to reconstruction, 95 %", centimetres(m.completeness_p95_m), "cm"});
  table.add_row({"reconstruction to reference, mean", centimetres(m.accuracy_mean_m), "cm"});
  table.add_row({"reconstruction to reference, 95 %", centimetres(m.accuracy_p95_m), "cm"});
  table.add_row({"e_max", centimetres(options.e_max), "cm"});
  table.add_row({"reference points judged", std::to_string(m.reference_points), ""});
  for (const auto& row : table.rows)
    std::printf("%-36s %12s %s\n", row[0].c_str(), row[1].c_str(), row[2].c_str());

  nlohmann::ordered_json json;
  json["surface_coverage"] = m.surface_coverage;
  json["unsided_coverage"] = m.unsided_coverage;
  json["sides"] = sides;
  json["m3c2_coverage"] = m.m3c2_coverage();
  json["m3c2_mean_m"] = m.m3c2_mean_m;
  json["m3c2_std_m"] = m.m3c2_std_m;
  json["rmse_m"] = m.rmse_m;
  json["m3c2_unpruned_mean_m"] = m.m3c2_unpruned_mean_m;
  json["m3c2_unpruned_std_m"] = m.m3c2_unpruned_std_m;
  json["unpruned_rmse_m"] = m.unpruned_rmse_m;
  json["completeness_mean_m"] = m.completeness_mean_m;
  json["completeness_p95_m"] = m.completeness_p95_m;
  json["accuracy_mean_m"] = m.accuracy_mean_m;
  json["accuracy_p95_m"] = m.accuracy_p95_m;
  json["e_max_m"] = options.e_max;
  json["projection_scale_m"] = options.cylinder_diameter();
  json["reference_points"] = m.reference_points;
  json["m3c2_points"] = m.m3c2_points;
  // File names may hold bytes that are not UTF-8, which dump() would otherwise refuse.
  const std::string text =
      json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  std::printf("%s", text.c_str());
  if (out.empty()) return cli::kDone;

  const std::filesystem::path folder = out;
  write_file(folder / "metrics.json", std::string_view(text));

  // Errors at the reconstruction's own points: signed where the reference has a side.
  std::vector<double> error(reconstruction.points().size());
  if (reference.is_mesh()) {
    error = signed_distances(reconstruction.points(), reference.mesh, Bvh(reference.mesh),
                             4.0 * options.e_max, options.threads);
  } else {
    for (std::size_t i = 0; i < error.size(); ++i)
      error[i] = truth.distance(reconstruction.points()[i]);
  }
  std::vector<Rgb> colors;
  for (const double d : error) colors.push_back(signed_error_color(d, options.e_max));
  if (reconstruction.is_mesh()) {
    TriangleMesh colored = reconstruction.mesh;
    colored.colors = colors;
    write_ply(colored, folder / "error.ply");
  } else {
    PointCloud colored = reconstruction.cloud;
    colored.colors = colors;
    write_ply(colored, folder / "error.ply");
  }

  Report report("Reconstruction against reference",
                std::filesystem::path(reconstruction_path).filename().string() + " against " +
                    std::filesystem::path(reference_path).filename().string());
  const std::vector<KeyFigure> key{
      {"surface coverage", format_number(100.0 * m.surface_coverage, 1) + " %",
       "within " + centimetres(options.e_max) + " cm"},
      {"RMSE", centimetres(m.rmse_m) + " cm", "M3C2, |d| ≤ e_max"},
      {"mean error", centimetres(m.m3c2_mean_m) + " cm", "signed, M3C2"},
      {"95 % accuracy", centimetres(m.accuracy_p95_m) + " cm", "reconstruction to reference"}};
  report.add_key_figures(key);
  report.add_heading("Error of the reconstruction");
  if (!reconstruction.points().empty()) {
    std::vector<Point3> frame;  // what is drawn, not vertices left over from cropping
    if (reconstruction.is_mesh())
      for (const Triangle& t : reconstruction.mesh.triangles)
        for (const std::int32_t v : t)
          frame.push_back(reconstruction.mesh.vertices[static_cast<std::size_t>(v)]);
    else
      frame = reconstruction.cloud.points;
    add_views(report, reconstruction, colors, "Signed distance to the reference", frame,
              options.threads);
  }
  report.add_svg(color_bar_svg(DivergingMap{}, -100.0 * options.e_max, 100.0 * options.e_max,
                               "signed distance [cm]; grey: nothing near"));
  report.add_heading("Missing parts of the reference");
  Surface judged_surface;
  judged_surface.cloud = judged;
  std::vector<Rgb> found;
  for (const double d : e.facing_distance)
    found.push_back(d <= options.e_max ? Rgb{120, 170, 150} : Rgb{206, 60, 60});
  add_views(report, judged_surface, found, "Reference points: green covered, red missing",
            judged.points, options.threads);
  report.add_heading("Distributions");
  report.add_plot(histogram(e.m3c2.distance, options.depth()), true);
  report.add_plot(coverage_curve(e.facing_distance, options.e_max), true);
  report.add_heading("Figures").add_table(table);
  report.add_paragraph(
      "Coverage is the share of reference points, spread evenly by area, that have some part of "
      "the "
      "reconstructed surface within e_max that faces the side they are to be covered from. M3C2 "
      "(Lague et al. 2013) compares the two surfaces along the reference's normals; its mean, "
      "deviation and RMSE are over distances up to e_max.");
  report.write(folder / "report.html");
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("evaluate_reconstruction", [&] { return evaluate_files(argc, argv); });
}
