// SPDX-License-Identifier: MIT
/// @file
/// @brief Where a target of like markers is, in 6-D, from one camera: recorded images, simulated
/// ones, or the design of targets [004 ch. 9].
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/adapters/png_reader.hpp>
#include <surfleet/adapters/png_writer.hpp>
#include <surfleet/evaluation/report.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/evaluation/trajectory_io.hpp>
#include <surfleet/localization/image_tracker.hpp>
#include <surfleet/localization/target_design.hpp>
#include <surfleet/simulation/marker_images.hpp>
#include <surfleet/simulation/target_motions.hpp>

#include "support/cli.hpp"
#include "support/peak_memory.hpp"
#include "support/stopwatch.hpp"

namespace {
using namespace surfleet;
using Json = nlohmann::ordered_json;

struct Settings {
  std::string images, simulate = "handheld", target = "printed", camera, markers = "bright", truth,
                      out = "relative_localization_out";
  std::vector<double> distance, yuv;
  double occlude = 0.0, pixel_noise = 0.3, fps = 30.0, grey_noise = 2.0, emission = 180.0;
  int outliers = 0, history = 2, frames = 600, overlays = 6, threads = 1;
  std::uint64_t seed = 1;
  bool design = false;
  TargetDesignOptions designs;
  std::vector<double> bounds;
};

/// A camera from a TOML file: model, width, height, fx, fy, cx, cy, distortion, fov.
AnyCamera read_camera(const std::string& file) {
  std::ifstream in(file);
  require(in.good(), file + ": cannot be read; expected a TOML file with the camera's intrinsics");
  cli::Options options("camera");
  std::string model = "pinhole";
  int width = 0, height = 0;
  double fx = 0.0, fy = 0.0, cx = -1.0, cy = -1.0, fov = 0.0;
  std::vector<double> k;
  options.add("--model", model, "").one_of({"pinhole", "radial_tangential", "equidistant"});
  options.add("--width", width, "");
  options.add("--height", height, "");
  options.add("--fx", fx, "");
  options.add("--fy", fy, "");
  options.add("--cx", cx, "");
  options.add("--cy", cy, "");
  options.add("--fov", fov, "");
  options.add("--distortion", k, "");
  try {
    options.parse_config(in);
  } catch (const Error& e) {
    throw Error(file + ": " + e.what());
  }
  require(width >= 1 && height >= 1 && width <= kMostGreyPixels && height <= kMostGreyPixels,
          file + ": width and height: expected 1 to 16384 pixels");
  const bool focal = fx > 0.0 && std::isfinite(fx);
  const bool angle = fov > 0.0 && fov < 360.0;
  require(focal != angle, file + ": no intrinsics; expected fx (and fy, cx, cy) or fov in degrees");
  require(fy >= 0.0 && std::isfinite(fy) && std::isfinite(cx) && std::isfinite(cy),
          file + ": fy, cx, cy: expected finite numbers");
  for (const double v : k)
    require(std::isfinite(v), file + ": distortion: expected finite numbers");
  const double mx = cx >= 0.0 ? cx : 0.5 * (width - 1), my = cy >= 0.0 ? cy : 0.5 * (height - 1);
  if (model == "equidistant") {
    EquidistantCamera c = EquidistantCamera::from_fov(radians(angle ? fov : 190.0), width, height);
    if (focal) c.fx = c.fy = fx;
    if (fy > 0.0) c.fy = fy;
    c.cx = mx;
    c.cy = my;
    require(k.size() <= 4, file + ": distortion: expected at most k1, k2, k3, k4");
    std::copy(k.begin(), k.end(), c.distortion.begin());
    return c;
  }
  require(!angle || fov < 175.0, file + ": fov: expected less than 175 degrees of such a lens");
  const double f = focal ? fx : 0.5 * width / std::tan(radians(0.5 * fov));
  if (model == "pinhole") {
    require(k.empty(), file + ": distortion: a pinhole has none; expected another model");
    PinholeCamera c;
    c.width = width;
    c.height = height;
    c.fx = f;
    c.fy = fy > 0.0 ? fy : f;
    c.cx = mx;
    c.cy = my;
    return c;
  }
  require(k.size() <= 5, file + ": distortion: expected at most k1, k2, p1, p2, k3");
  k.resize(5, 0.0);
  RadialTangentialCamera c;
  c.width = width;
  c.height = height;
  c.fx = f;
  c.fy = fy > 0.0 ? fy : f;
  c.cx = mx;
  c.cy = my;
  c.radial = {k[0], k[1], k[4]};
  c.tangential = {k[2], k[3]};
  return c;
}
/// 752 × 480 and 90° wide, as printed.
AnyCamera printed_camera(int width = 752, int height = 480, double fov = 90.0) {
  const double f = 0.5 * width / std::tan(radians(0.5 * fov));
  return PinholeCamera::from_fov(radians(fov), 2.0 * std::atan(0.5 * height / f), width, height,
                                 0.1, 100.0);
}

/// One image and when it was taken; the true pose where it is known.
struct Frame {
  GreyImage image;
  double time = 0.0;
  std::optional<Pose> truth;  ///< `T_camera_target`
};

/// What is gathered over the frames of one camera.
struct Record {
  std::vector<StampedPose> poses;  ///< `T_target_camera`
  std::string detections = "frame,time_s,x_px,y_px,diameter_px,marker\n";
  std::string covariance = "frame,time_s,state,hypothesis,markers";
  std::vector<double> times, position, angle, distance, error_time, nees;
  int frames = 0, tracked = 0, ambiguous = 0, lost = 0, wrong = 0, coasting = 0, start_up = 0,
      three = 0, known = 0;

  Record() {
    for (int i = 0; i < 6; ++i)
      for (int k = i; k < 6; ++k) covariance += ",c" + std::to_string(i) + std::to_string(k);
    covariance += "\n";
  }
  void add(const ImageFrame& f, const Frame& in, double seconds) {
    const std::string head = std::to_string(frames) + "," + short_number(in.time) + ",";
    std::vector<int> marker(f.blobs.size(), -1);
    if (f.tracked.fits.size() == 1)
      for (std::size_t m = 0; m < f.tracked.fits[0].blob_of_marker.size(); ++m)
        if (const int b = f.tracked.fits[0].blob_of_marker[m]; b >= 0)
          marker[static_cast<std::size_t>(b)] = static_cast<int>(m);
    for (std::size_t b = 0; b < f.blobs.size(); ++b)
      detections += head + format_number(f.blobs[b].center.x(), 3) + "," +
                    format_number(f.blobs[b].center.y(), 3) + "," +
                    format_number(f.blobs[b].diameter, 2) + "," +
                    (marker[b] >= 0 ? std::to_string(marker[b]) : "") + "\n";
    for (std::size_t h = 0; h < f.tracked.fits.size(); ++h) {
      const TargetFit& fit = f.tracked.fits[h];
      covariance += head + to_string(f.tracked.state) + "," + std::to_string(h) + "," +
                    std::to_string(fit.matches);
      for (int i = 0; i < 6; ++i)
        for (int k = i; k < 6; ++k) {
          char text[32];
          std::snprintf(text, sizeof text, ",%.4g", fit.covariance(i, k));
          covariance += text;
        }
      covariance += "\n";
    }
    ++frames;
    times.push_back(seconds);
    const TrackState state = f.tracked.state;
    tracked += state == TrackState::tracked;
    ambiguous += state == TrackState::ambiguous;
    lost += state == TrackState::lost;
    coasting += state == TrackState::coasting;
    start_up += state == TrackState::start_up;
    three += f.tracked.three_markers;
    if (state != TrackState::tracked && state != TrackState::coasting) return;
    const TargetFit& fit = f.tracked.fits[0];
    poses.push_back({in.time, fit.T_target_camera()});
    if (state != TrackState::tracked || !in.truth) return;
    const Vector6 xi = difference(*in.truth, fit.T_camera_target);
    ++known;
    position.push_back(xi.tail<3>().norm());
    angle.push_back(degrees(xi.head<3>().norm()));
    distance.push_back(in.truth->translation().norm());
    error_time.push_back(in.time);
    nees.push_back(fit.target_in_camera().normalized_error(*in.truth));
    // No error of measurement is as large: another pose than the true one.
    wrong += angle.back() > 15.0 || position.back() > 0.15 * distance.back();
  }

 private:
  static std::string short_number(double v) { return format_number(v, 4); }
};
Json spread(const std::vector<double>& values) {
  if (values.empty()) return nullptr;
  const Summary s = summarize(values);
  return {{"mean", s.mean}, {"std", s.deviation}, {"min", s.minimum}, {"max", s.maximum}};
}
Json by_distance(const Record& r, const std::vector<double>& errors) {
  Json bins = Json::array();
  for (double from = 0.0; from < 100.0; from += 0.5) {
    std::vector<double> inside;
    for (std::size_t i = 0; i < errors.size(); ++i)
      if (r.distance[i] >= from && r.distance[i] < from + 0.5) inside.push_back(errors[i]);
    if (inside.empty()) continue;
    Json bin = spread(inside);
    bin["from_m"] = from;
    bin["to_m"] = from + 0.5;
    bin["frames"] = inside.size();
    bins.push_back(std::move(bin));
  }
  return bins;
}
Json figures(const Record& r) {
  const auto share = [&](int n) { return r.frames > 0 ? static_cast<double>(n) / r.frames : 0.0; };
  Json j{{"frames", r.frames},
         {"tracked_share", share(r.tracked)},
         {"ambiguous_frames", r.ambiguous},
         {"coasting_frames", r.coasting},
         {"lost_frames", r.lost},
         {"start_up_frames", r.start_up},
         {"three_marker_frames", r.three}};
  if (r.known > 0) {
    j["wrong_frames"] = r.wrong;
    j["position_error_m"] = spread(r.position);
    j["position_error_m"]["by_distance"] = by_distance(r, r.position);
    j["orientation_error_deg"] = spread(r.angle);
    j["orientation_error_deg"]["by_distance"] = by_distance(r, r.angle);
    constexpr double kChiSquare95 = 12.592;  // six degrees of freedom
    j["nees"] = {{"mean", summarize(r.nees).mean},
                 {"within_95",
                  static_cast<double>(std::count_if(r.nees.begin(), r.nees.end(),
                                                    [](double v) { return v <= kChiSquare95; })) /
                      static_cast<double>(r.nees.size())}};
  }
  j["frame_time_s"] = spread(r.times);
  return j;
}

/// The frame with what was found drawn over it: blobs green, markers with their numbers as so many
/// ticks, the true projection as a cross.
Image overlay(const Frame& frame, const ImageFrame& found, const MarkerTarget& target,
              const AnyCamera& camera) {
  Image out(frame.image.width, frame.image.height);
  for (int v = 0; v < out.height; ++v)
    for (int u = 0; u < out.width; ++u) {
      const std::uint8_t g = frame.image(u, v);
      out.set(u, v, {g, g, g});
    }
  const auto dot = [&](double x, double y, Rgb color) {
    const int u = static_cast<int>(std::lround(x)), v = static_cast<int>(std::lround(y));
    if (u >= 0 && v >= 0 && u < out.width && v < out.height) out.set(u, v, color);
  };
  const auto ring = [&](const Point2& c, double r, Rgb color) {
    for (int i = 0; i < 200; ++i)
      dot(c.x() + r * std::cos(kPi * i / 100), c.y() + r * std::sin(kPi * i / 100), color);
  };
  for (const Blob& b : found.blobs) ring(b.center, 0.5 * b.diameter + 3.0, {70, 200, 90});
  constexpr std::array<Rgb, 3> kFits{Rgb{255, 150, 40}, Rgb{80, 170, 255}, Rgb{230, 90, 230}};
  for (std::size_t h = 0; h < std::min<std::size_t>(found.tracked.fits.size(), kFits.size()); ++h) {
    const Pose& T = found.tracked.fits[h].T_camera_target;
    std::vector<Point2> at;
    for (const Point3& m : target.markers)
      if (const auto px = camera.project(T * m)) at.push_back(*px);
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t k = i + 1; k < at.size(); ++k) {
        const double length = (at[i] - at[k]).norm();
        for (double s = 8.0; s < length - 8.0; s += 1.0) {
          const Point2 p = at[i] + s / length * (at[k] - at[i]);
          dot(p.x(), p.y(), kFits[h]);
        }
      }
  }
  if (frame.truth)
    for (const Point3& m : target.markers)
      if (const auto px = camera.project(*frame.truth * m))
        for (int i = -3; i <= 3; ++i) {
          dot(px->x() + i, px->y(), {255, 60, 60});
          dot(px->x(), px->y() + i, {255, 60, 60});
        }
  return out;
}

using Tracker = ImageTracker<AnyCamera>;
Tracker make_tracker(const Settings& s, const AnyCamera& camera, const MarkerTarget& target) {
  TrackerOptions options;
  options.identify.pixel_noise = s.pixel_noise;
  BlobOptions blobs;
  blobs.dark = s.markers == "dark";
  return Tracker(camera, target, options, blobs,
                 LinearRegression{static_cast<std::size_t>(s.history)});
}

/// Recorded images, in the order of their names.
class Recording {
 public:
  Recording(const Settings& s, const AnyCamera& camera) : settings_(s) {
    std::error_code ec;
    require(std::filesystem::is_directory(s.images, ec),
            s.images + ": no folder; expected one with PGM or PNG images");
    for (const auto& entry : std::filesystem::directory_iterator(s.images)) {
      const auto ending = entry.path().extension();
      if (ending == ".pgm" || ending == ".png") files_.push_back(entry.path());
    }
    std::sort(files_.begin(), files_.end());
    require(!files_.empty(), s.images + ": no images; expected files that end in .pgm or .png");
    if (!s.truth.empty()) {
      truth_ = read_tum(s.truth);
      require(!truth_.empty(), s.truth + ": no poses; expected a line for each image");
    }
    const GreyImage first = read(files_[0]);
    require(first.width == camera.width && first.height == camera.height,
            files_[0].string() + ": " + std::to_string(first.width) + " x " +
                std::to_string(first.height) + " pixels; expected " + std::to_string(camera.width) +
                " x " + std::to_string(camera.height) + ", as the camera file says");
  }
  std::size_t size() const { return files_.size(); }
  /// Throws `Error` where an image is damaged.
  Frame operator()(std::size_t k) const {
    Frame frame{read(files_[k]), static_cast<double>(k) / settings_.fps, {}};
    for (const StampedPose& p : truth_)
      if (std::abs(p.time - frame.time) < 0.25 / settings_.fps)
        frame.truth = p.T_world_body.inverse();
    return frame;
  }

 private:
  GreyImage read(const std::filesystem::path& file) const {
    const Bytes bytes = read_file(file);
    if (file.extension() == ".pgm") return parse_pgm(bytes, file.string());
    if (settings_.markers != "colour") return decode_png_grey(bytes, file.string());
    const Image image = decode_png(bytes, file.string());
    YuvBox box;
    for (std::size_t i = 0; i < 3; ++i) {
      box.low[i] = settings_.yuv[2 * i];
      box.high[i] = settings_.yuv[2 * i + 1];
    }
    return select_color(image.rgb, image.width, image.height, box);
  }
  const Settings& settings_;
  std::vector<std::filesystem::path> files_;
  Trajectory truth_;
};

/// A simulated camera's images; `pose` is `T_camera_target` over time.
class Simulated {
 public:
  Simulated(const Settings& s, AnyCamera camera, MarkerTarget target,
            std::function<Pose(double)> pose, std::uint64_t seed)
      : settings_(s),
        camera_(std::move(camera)),
        target_(std::move(target)),
        pose_(std::move(pose)),
        random_(mix64(seed)),
        draw_(drawing(s), seed) {}

  Frame operator()(std::size_t k) {
    const double t = static_cast<double>(k) / settings_.fps;
    std::vector<ImageDisc> discs;
    for (int i = 0; i < settings_.outliers; ++i)
      discs.push_back({{random_.uniform(0, camera_.width), random_.uniform(0, camera_.height)},
                       random_.uniform(1.5, 6.0),
                       false});
    // Every ten seconds one marker after the other is out of sight for some time.
    std::vector<bool> hidden(target_.markers.size(), false);
    const double phase = std::fmod(t, 10.0);
    if (phase >= 4.0 && phase < 4.0 + settings_.occlude)
      hidden[static_cast<std::size_t>(t / 10.0) % hidden.size()] = true;
    const Pose T = pose_(t);
    return {draw_(camera_, target_, T, discs, hidden), t, T};
  }

 private:
  static MarkerImageOptions drawing(const Settings& s) {
    MarkerImageOptions o;
    o.noise = s.grey_noise;
    o.emission_angle = radians(s.emission);
    if (s.markers == "dark") {
      o.background = 220.0;
      o.brightness = -180.0;
    }
    return o;
  }
  const Settings& settings_;
  AnyCamera camera_;
  MarkerTarget target_;
  std::function<Pose(double)> pose_;
  Random random_;
  MarkerImages draw_;
};

/// Feeds frames to a tracker until they end or the user interrupts; returns whether they ended.
bool follow(const std::string& what, std::size_t frames,
            const std::function<Frame(std::size_t)>& next, Tracker& track, const AnyCamera& camera,
            const MarkerTarget& target, int overlays, Record& record,
            std::vector<std::pair<std::size_t, Bytes>>& pictures, int& bad,
            const std::function<void(std::size_t, const ImageFrame&, const Frame&)>& also = {}) {
  cli::ProgressLine line;
  const std::size_t every =
      std::max<std::size_t>(1, frames / static_cast<std::size_t>(std::max(1, overlays)));
  for (std::size_t k = 0; k < frames; ++k) {
    if (cli::interrupted()) return false;
    Frame frame;
    ImageFrame found;
    double seconds = 0.0;
    try {
      frame = next(k);
      const auto before = examples::Clock::now();
      found = track(frame.image, frame.time);
      seconds = examples::seconds_since(before);
    } catch (const Error&) {
      ++bad;
      continue;
    }
    record.add(found, frame, seconds);
    if (also) also(k, found, frame);
    if (overlays > 0 && (k + every / 2 + 1) % every == 0)
      pictures.emplace_back(k, encode_png(overlay(frame, found, target, camera)));
    line(what + " " + std::to_string(k + 1) + " of " + std::to_string(frames) + ", " +
         to_string(found.tracked.state));
  }
  return true;
}

void write_targets(const std::filesystem::path& folder, const TargetDesign& design) {
  for (std::size_t i = 0; i < design.targets.size(); ++i) {
    std::string text = "# markers of a target, x y z [m]\n";
    char line[96];
    std::snprintf(line, sizeof line, "radius %.6g\n", design.targets[i].marker_radius);
    text += line;
    for (const Point3& p : design.targets[i].markers) {
      std::snprintf(line, sizeof line, "%.6f %.6f %.6f\n", p.x(), p.y(), p.z());
      text += line;
    }
    write_file(folder / ("target_" + std::to_string(i) + ".txt"), std::string_view(text));
  }
}
int run_design(Settings& s) {
  if (!s.bounds.empty()) {
    s.designs.min_distance = s.bounds[0];
    s.designs.max_distance = s.bounds[1];
    s.designs.min_height = s.bounds[2];
  }
  s.designs.seed = s.seed;
  s.designs.threads = s.threads;
  const auto began = examples::Clock::now();
  TargetDesign design = design_targets(s.designs);
  const double seconds = examples::seconds_since(began);
  for (MarkerTarget& t : design.targets) t = turned_for_view_from_above(t, s.designs);
  const auto folder = cli::prepare_output_folder(s.out);
  write_targets(folder, design);
  const std::size_t pairs = s.designs.targets * s.designs.markers * (s.designs.markers - 1) / 2;
  const double bound = (s.designs.max_distance - s.designs.min_distance) /
                       static_cast<double>(std::max<std::size_t>(1, pairs - 1));
  const Json metrics{{"targets", s.designs.targets},
                     {"markers", s.designs.markers},
                     {"similarity", design.quality.similarity},
                     {"similarity_bound_m", bound},
                     {"mean_difference_m", design.quality.mean_difference},
                     {"objective_m", design.objective},
                     {"shortest_m", design.quality.shortest},
                     {"longest_m", design.quality.longest},
                     {"least_height_m", design.quality.least_height},
                     {"starts", s.designs.starts},
                     {"seed", s.seed},
                     {"wall_time_s", seconds},
                     {"peak_memory_bytes", examples::peak_memory()}};
  write_file(folder / "metrics.json", std::string_view(metrics.dump(2) + "\n"));
  Report report("Design of targets", std::to_string(s.designs.targets) + " of " +
                                         std::to_string(s.designs.markers) + " markers");
  report.add_key_figures(std::vector<KeyFigure>{
      {"least difference s*", format_number(100 * design.quality.similarity, 3) + " cm",
       "at most " + format_number(100 * bound, 3)},
      {"F", format_number(100 * design.objective, 3) + " cm", ""},
      {"least height", format_number(100 * design.quality.least_height, 2) + " cm", ""}});
  Table table{"Markers [m]", {"target", "x", "y", "z"}};
  for (std::size_t i = 0; i < design.targets.size(); ++i)
    for (const Point3& p : design.targets[i].markers)
      table.add_row({std::to_string(i), format_number(p.x(), 4), format_number(p.y(), 4),
                     format_number(p.z(), 4)});
  report.add_table(table).write(folder / "report.html");
  std::printf(
      "s* %.3f cm of at most %.3f, F %.3f cm, least height %.2f cm after %.1f s; results in %s\n",
      100 * design.quality.similarity, 100 * bound, 100 * design.objective,
      100 * design.quality.least_height, seconds, folder.string().c_str());
  return cli::kDone;
}

int run(int argc, char** argv) {
  Settings s;
  cli::Options app(
      "Tells where a target of like markers is, in 6-D, from a camera's images: its pose, how "
      "sure, "
      "and when it cannot be told. Without options it simulates a hand-held camera.");
  app.begin_group("Images and target");
  app.add("--images", s.images, "Folder of PGM or PNG images, in the order of their names");
  app.add("--simulate", s.simulate,
          "Instead: a camera by hand, on a drone, or above a sweeping robot")
      .one_of({"handheld", "flight", "sweep"});
  app.add("--target", s.target,
          "printed, small (half of it), or a file with a line x y z [m] a marker and 'radius r'");
  app.add("--camera", s.camera,
          "TOML: model pinhole|radial_tangential|equidistant, width, height, fx, fy, cx, cy "
          "[px] or fov [degrees], distortion");
  app.add(
      "--markers", s.markers,
      "What tells markers: bright, dark, or colour, a box in --yuv (PNG). Design: their number");
  app.add("--yuv", s.yuv, "Bounds of the colour: Y Y U U V V, least and most, 0 to 255")
      .expected(6);
  app.begin_group("Simulation");
  app.add("--distance", s.distance, "Simulation: nearest and farthest distance [m]").expected(2);
  app.add("--occlude", s.occlude, "Simulation: a marker is hidden so long every ten seconds [s]")
      .zero_or_more();
  app.add("--outliers", s.outliers, "Simulation: bright discs elsewhere, each frame")
      .within(0, 200);
  app.add("--emission", s.emission, "Simulation: half angle of a marker's light [degrees]")
      .positive();
  app.add("--grey-noise", s.grey_noise, "Simulation: noise of a pixel [grey levels]")
      .zero_or_more();
  app.begin_group("Tracking");
  app.add("--pixel-noise", s.pixel_noise, "Expected error of a marker's centre, 1 sigma [px]")
      .positive();
  app.add("--history", s.history, "Poses that the prediction is made from, k_R").within(1, 100);
  app.begin_group("Simulation");
  app.add("--frames", s.frames, "Simulation: number of frames").within(1, 1000000);
  app.add("--fps", s.fps, "Frames a second").positive();
  app.begin_group("Results");
  app.add("--truth", s.truth,
          "True poses of the camera in the target's frame (TUM), to compare with");
  app.add("--overlays", s.overlays, "Pictures of frames with what was found").within(0, 1000);
  app.begin_group("Design");
  app.add_flag("--design", s.design, "Design targets instead");
  app.add("--targets", s.designs.targets, "Design: number of targets");
  app.add("--weight", s.designs.weight, "Design: weight of the least difference of distances");
  app.add("--bounds", s.bounds, "Design: D1 D2 H, distances and least height [m]").expected(3);
  app.add("--starts", s.designs.starts, "Design: searches").within(1, 1000000);
  app.begin_group("Run");
  app.add("--seed", s.seed, "Seed of the simulation or design");
  app.add("--threads", s.threads, "Threads of the design").within(1, 256);
  app.begin_group("Results");
  app.add("--out", s.out, "Output folder");
  app.leave_out_of_config([&](const std::string& name) { return name == "markers" && s.design; });
  app.add_examples(
      "  relative_localization --simulate sweep --frames 500      robots that sweep below a "
      "camera\n"
      "  relative_localization --images shots --camera lens.toml --target small --markers dark\n"
      "  relative_localization --design --markers 4 --targets 2");
  app.parse(argc, argv);
  if (s.design) {
    if (app.was_given("--markers")) {
      const auto count = parse_number<std::size_t>(s.markers);
      require(count.has_value(), "--markers: with --design, expected a number of markers");
      s.designs.markers = *count;
    }
    return run_design(s);
  }
  require(s.markers == "bright" || s.markers == "dark" || s.markers == "colour",
          "--markers: expected bright, dark or colour");

  const auto began = examples::Clock::now();
  require(s.markers != "colour" || (!s.images.empty() && s.yuv.size() == 6),
          "--markers colour: expected --images with PNG files and --yuv with six bounds");
  require(s.images.empty() || !s.camera.empty(),
          "--images: no intrinsics; expected --camera FILE of the camera that took them");
  require(s.truth.empty() || !s.images.empty(),
          "--truth: a simulation knows it; expected --images");
  const bool sweep = s.images.empty() && s.simulate == "sweep";
  const MarkerTarget target = s.target == "printed"
                                  ? printed_target(s.images.empty() && sweep ? 0.5 : 1.0)
                              : s.target == "small" ? printed_target(0.5)
                                                    : read_target(s.target);
  const std::vector<std::string> warnings = check_target(target);
  const AnyCamera camera = !s.camera.empty() ? read_camera(s.camera)
                           : sweep           ? printed_camera(1280, 960, 60.0)
                                             : printed_camera();
  CameraMotionOptions motion = s.simulate == "flight" ? flight_motion() : handheld_motion();
  Point3 middle = Point3::Zero();
  for (const Point3& m : target.markers) middle += m / static_cast<double>(target.markers.size());
  motion.middle = middle;
  if (!s.distance.empty()) {
    require(s.distance[0] > 1.5 * (target.reach() - middle.norm()) && s.distance[0] > 0.0 &&
                s.distance[1] >= s.distance[0] && s.distance[1] <= 100.0,
            "--distance: expected nearest <= farthest <= 100 m, and nearest outside of the target");
    motion.nearest = s.distance[0];
    motion.farthest = s.distance[1];
  }
  std::optional<Recording> recording;
  std::optional<Simulated> simulated;
  // Robot r1 sweeps 30 × 42 cm below a camera at 2.3 m, and drives home backwards; r2, on an
  // inclined wall beside, faces it.
  const auto r1 = [](double t) {
    Pose T = Pose::Identity();
    constexpr double kLength = 6 * 0.30 + 0.42, kChord = 0.02;  // [m]
    const double along = kLength - std::abs(std::fmod(0.05 * t, 2.0 * kLength) - kLength);
    const Point2 at = sweep_place(0.30, 0.42, 6, along);
    const Point2 dir = sweep_place(0.30, 0.42, 6, std::min(along + kChord, kLength)) -
                       sweep_place(0.30, 0.42, 6, std::max(along - kChord, 0.0));
    T.linear() = Eigen::AngleAxisd(std::atan2(dir.y(), dir.x()), Eigen::Vector3d::UnitZ())
                     .toRotationMatrix();
    T.translation() = Point3(at.x(), at.y(), 0.05);
    return T;
  };
  const auto r2 = [](double t) {
    const Point2 at = sweep_place(0.25, 0.21, 4, 0.04 * t);
    return look_at(Point3(at.x(), -0.62 - 0.3 * at.y(), 0.45 + 0.9 * at.y()),
                   Point3(0.3 * at.x(), 0.0, 0.1), 0.4 * std::sin(0.3 * t));
  };
  const Pose T_world_overhead = look_at(Point3(0, 0, 2.3), Point3(0, 0, 0));
  if (!s.images.empty()) {
    recording.emplace(s, camera);
  } else if (sweep) {
    simulated.emplace(
        s, camera, target, [=](double t) { return T_world_overhead.inverse() * r1(t); }, s.seed);
  } else {
    simulated.emplace(s, camera, target, CameraMotion(motion, s.seed), s.seed);
  }
  Tracker track = make_tracker(s, camera, target);
  const auto folder = cli::prepare_output_folder(s.out);
  cli::watch_interrupts();
  for (const std::string& w : warnings) std::fprintf(stderr, "target: %s\n", w.c_str());

  Record record;
  std::vector<std::pair<std::size_t, Bytes>> pictures;
  int bad = 0;
  std::vector<std::optional<UncertainPose>> overhead;  // T_overhead_r1 of each frame
  const std::size_t frames = recording ? recording->size() : static_cast<std::size_t>(s.frames);
  bool complete = follow(
      "frame", frames, [&](std::size_t k) { return recording ? (*recording)(k) : (*simulated)(k); },
      track, camera, target, s.overlays, record, pictures, bad,
      [&](std::size_t, const ImageFrame& f, const Frame&) {
        overhead.emplace_back();
        if (f.tracked.state == TrackState::tracked)
          overhead.back() = f.tracked.fits[0].target_in_camera();
      });
  if (recording && record.frames == 0)
    throw Error(s.images + ": no image could be read; expected PGM or PNG files");

  Json metrics = figures(record);
  metrics["bad_frames"] = bad;
  Record second;
  std::vector<double> chain_errors, chain_nees;
  if (sweep && complete) {
    // The second camera, and the chain overhead → r1 → r2.
    const AnyCamera fish = EquidistantCamera::from_fov(radians(150.0), 752, 480);
    Simulated eyes(
        s, fish, target, [&](double t) { return r2(t).inverse() * r1(t); }, s.seed + 1);
    Tracker watch = make_tracker(s, fish, target);
    std::vector<StampedPose> chain;
    int second_bad = 0;
    complete = follow(
        "second camera, frame", frames, [&](std::size_t k) { return eyes(k); }, watch, fish, target,
        std::min(s.overlays, 2), second, pictures, second_bad,
        [&](std::size_t k, const ImageFrame& f, const Frame& frame) {
          if (f.tracked.state != TrackState::tracked || !overhead[k]) return;
          const UncertainPose T = *overhead[k] * f.tracked.fits[0].camera_in_target();
          const Pose truth = T_world_overhead.inverse() * r2(frame.time);
          chain.push_back({frame.time, T.pose});
          chain_errors.push_back((T.pose.translation() - truth.translation()).norm());
          chain_nees.push_back(T.normalized_error(truth));
        });
    metrics["second_camera"] = figures(second);
    metrics["chain_position_error_m"] = spread(chain_errors);
    metrics["chain_nees"] = summarize(chain_nees).mean;
    write_tum(folder / "pose_chain.tum", chain);
  }
  const std::vector<MarkerTarget> one{target};
  metrics["similarity"] = target_quality(one).similarity;
  metrics["warnings"] = warnings;
  metrics["seed"] = s.seed;
  metrics["wall_time_s"] = examples::seconds_since(began);
  metrics["peak_memory_bytes"] = examples::peak_memory();
  write_file(folder / "metrics.json", std::string_view(metrics.dump(2) + "\n"));
  write_tum(folder / "pose.tum", record.poses);
  write_file(folder / "detections.csv", std::string_view(record.detections));
  write_file(folder / "covariance.csv", std::string_view(record.covariance));

  Report report("Relative localisation", (recording ? s.images : "simulated: " + s.simulate) +
                                             ", " + std::to_string(record.frames) + " frames");
  std::vector<KeyFigure> key{
      {"tracked", format_number(100.0 * record.tracked / std::max(1, record.frames), 1) + " %",
       std::to_string(record.ambiguous) + " frames ambiguous, " + std::to_string(record.lost) +
           " lost"},
      {"a frame", format_number(1e3 * summarize(record.times).mean, 2) + " ms", ""}};
  if (record.known > 0) {
    key.push_back({"position", format_number(100 * summarize(record.position).mean, 2) + " cm",
                   "mean error; published 1.5 by hand, 2.6 in flight [004 §9.5]"});
    key.push_back({"orientation", format_number(summarize(record.angle).mean, 2) + "°",
                   "mean error; published 1.2 by hand, 1.0 in flight"});
  }
  report.add_key_figures(key);
  if (record.known > 0) {
    Plot position{"Error of position", "time [s]", "[cm]"};
    std::vector<double> cm;
    for (const double e : record.position) cm.push_back(100 * e);
    position.add("", record.error_time, cm);
    Plot angle{"Error of orientation", "time [s]", "[degrees]"};
    angle.add("", record.error_time, record.angle);
    report.add_plot(position, true).add_plot(angle, true);
  }
  std::size_t picture = 0;
  for (const auto& [k, png] : pictures) {
    char name[48];
    std::snprintf(name, sizeof name, "overlay_%02zu_frame_%05zu.png", picture++, k);
    write_file(folder / name, png);
    report.add_picture(png,
                       "Frame " + std::to_string(k) +
                           ": blobs (rings), the poses found (lines), the truth (crosses)",
                       true);
  }
  Table table{"Figures", {"key", "value"}};
  for (const auto& [k, v] : metrics.items()) table.add_row({k, v.dump()});
  report.add_table(table).write(folder / "report.html");
  std::printf("%d frames: tracked %.1f %%, %d ambiguous, %d lost", record.frames,
              100.0 * record.tracked / std::max(1, record.frames), record.ambiguous, record.lost);
  if (record.known > 0)
    std::printf(", %d wrong; mean errors %.2f cm, %.2f degrees", record.wrong,
                100 * summarize(record.position).mean, summarize(record.angle).mean);
  std::printf("; results in %s\n", folder.string().c_str());
  return complete ? cli::kDone : cli::kIncomplete;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("relative_localization", [&] { return run(argc, argv); });
}
