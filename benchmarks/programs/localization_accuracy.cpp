// SPDX-License-Identifier: MIT
// requires: opencv
/// @file
/// @brief How well and how fast targets are found: P3P, labelled and unlabelled poses, covariances,
/// blob centres, whole frames; OpenCV's solvers on the same data.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <string>
#include <utility>
#include <vector>

#include <surfleet/core/parallel.hpp>
#include <surfleet/core/random.hpp>
#include <surfleet/evaluation/statistics.hpp>
#include <surfleet/localization.hpp>
#include <surfleet/simulation/marker_images.hpp>
#include <surfleet/simulation/target_motions.hpp>

#include "support/cli.hpp"
#include "support/stopwatch.hpp"

namespace {
using namespace surfleet;
using Json = nlohmann::ordered_json;
using examples::Clock;
using examples::seconds_since;

struct Settings {
  std::string what = "p3p";
  int poses = 1000, seeds = 10, first_seed = 101;
};

PinholeCamera camera_with(double f) {
  PinholeCamera c;
  c.width = 752;
  c.height = 480;
  c.fx = c.fy = f;
  c.cx = 375.5;
  c.cy = 239.5;
  return c;
}
/// Five markers, distances between 8 and 25 cm, by the room's own design from a fixed seed.
MarkerTarget five_leds() {
  TargetDesignOptions o;
  o.markers = 5;
  o.min_distance = 0.08;
  o.max_distance = 0.25;
  o.min_height = 0.0;
  o.marker_radius = 0.0;
  o.starts = 400;
  return design_targets(o).targets[0];
}
Eigen::Matrix3d random_rotation(Random& random) {
  return Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
      .normalized()
      .toRotationMatrix();
}
Pose random_view(const PinholeCamera& camera, const MarkerTarget& target, double near, double far,
                 Random& random) {
  for (;;) {
    Pose T = Pose::Identity();
    T.linear() = random_rotation(random);
    T.translation() = random.uniform(near, far) *
                      bearing(camera, {random.uniform(0, 751), random.uniform(0, 479)});
    if (std::all_of(target.markers.begin(), target.markers.end(),
                    [&](const Point3& m) { return camera.project(T * m).has_value(); }))
      return T;
  }
}
std::vector<Eigen::Vector2d> see(const PinholeCamera& camera, const MarkerTarget& target,
                                 const Pose& T, double noise, Random& random) {
  std::vector<Eigen::Vector2d> out;
  for (const Point3& m : target.markers)
    out.push_back(*camera.project(T * m) +
                  noise * Eigen::Vector2d(random.normal(), random.normal()));
  return out;
}

template <P3pSolver Solver>
Json p3p(const Settings& s) {
  constexpr std::size_t kAll = 1000000;
  struct Case {
    Bearings3 f;
    Points3 p;
    Pose T;
  };
  Random random(static_cast<std::uint64_t>(s.first_seed));
  std::vector<Case> cases(kAll);
  for (Case& c : cases) {
    c.T = Pose::Identity();
    c.T.linear() = random_rotation(random);
    c.T.translation() = Point3(random.normal(), random.normal(), random.normal());
    for (std::size_t k = 0; k < 3; ++k) {
      c.f[k] = Eigen::Vector3d(random.uniform(-1, 1), random.uniform(-1, 1), 1.0).normalized();
      c.p[k] = c.T.inverse() * (random.uniform(0.1, 10.0) * c.f[k]);
    }
  }
  const Solver solver;
  std::size_t solutions = 0, found = 0;
  for (const Case& c : cases) {
    const P3pSolutions all = solver(c.f, c.p);
    solutions += all.size();
    found += std::any_of(all.begin(), all.end(),
                         [&](const Pose& T) { return (T.matrix() - c.T.matrix()).norm() < 1e-6; });
  }
  double best = 1e9;  // over a part that stays in the cache
  for (int round = 0; round < 200; ++round) {
    const auto start = Clock::now();
    std::size_t sum = 0;
    for (std::size_t i = 0; i < 2000; ++i) sum += solver(cases[i].f, cases[i].p).size();
    best = std::min(best, seconds_since(start) / 2000);
    if (sum == 0) return nullptr;
  }
  return {{"us", 1e6 * best},
          {"found", static_cast<double>(found) / kAll},
          {"missed", kAll - found},
          {"solutions", static_cast<double>(solutions) / kAll}};
}
Json opencv_p3p(const Settings& s, int method) {
  Random random(static_cast<std::uint64_t>(s.first_seed));
  double seconds = 0.0;
  constexpr int kCases = 20000;
  for (int i = 0; i < kCases; ++i) {
    Pose T = Pose::Identity();
    T.linear() = random_rotation(random);
    T.translation() = Point3(random.normal(), random.normal(), random.normal());
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d x(random.uniform(-1, 1), random.uniform(-1, 1), 1.0);
      const Point3 p = T.inverse() * (random.uniform(0.1, 10.0) * x.normalized());
      points.emplace_back(p.x(), p.y(), p.z());
      pixels.emplace_back(x.x(), x.y());
    }
    std::vector<cv::Mat> r, t;
    const auto start = Clock::now();
    cv::solveP3P(points, pixels, cv::Matx33d::eye(), cv::noArray(), r, t, method);
    seconds += seconds_since(start);
  }
  return {{"us", 1e6 * seconds / kCases}};
}

struct Errors {
  std::vector<double> translation, rotation;
  double seconds = 0.0;
  void add(const Pose& T, const Pose& truth) {
    translation.push_back(100 * (T.translation() - truth.translation()).norm() /
                          truth.translation().norm());
    rotation.push_back(degrees(Eigen::AngleAxisd(T.linear().transpose() * truth.linear()).angle()));
  }
  Json json() const {
    const auto n = static_cast<double>(translation.size());
    return {{"translation_median_percent", percentile(translation, 0.5)},
            {"rotation_median_deg", percentile(rotation, 0.5)},
            {"translation_p95_percent", percentile(translation, 0.95)},
            {"rotation_p95_deg", percentile(rotation, 0.95)},
            {"above_5_percent", std::count_if(translation.begin(), translation.end(),
                                              [](double e) { return e > 5.0; })},
            {"poses", translation.size()},
            {"us", 1e6 * seconds / n}};
  }
};
Json labelled(const Settings& s) {
  const PinholeCamera camera = camera_with(600.0);
  const MarkerTarget target = five_leds();
  Errors ours, sqpnp, epnp;
  const cv::Matx33d k(600, 0, camera.cx, 0, 600, camera.cy, 0, 0, 1);
  std::vector<cv::Point3d> points;
  for (const Point3& m : target.markers) points.emplace_back(m.x(), m.y(), m.z());
  for (int seed = 0; seed < s.seeds; ++seed) {
    Random random(static_cast<std::uint64_t>(s.first_seed + seed));
    for (int i = 0; i < s.poses; ++i) {
      const Pose T = random_view(camera, target, 0.8, 3.0, random);
      const auto pixels = see(camera, target, T, 0.3, random);
      auto start = Clock::now();
      const auto seen = observe_all(camera, pixels);
      const auto found = estimate_pose(seen, target.markers);
      ours.seconds += seconds_since(start);
      if (found) ours.add(found->T_camera_target, T);
      std::vector<cv::Point2d> px;
      for (const auto& p : pixels) px.emplace_back(p.x(), p.y());
      const auto theirs = [&](int method, Errors& e) {
        cv::Vec3d r, t;
        start = Clock::now();
        cv::solvePnP(points, px, k, cv::noArray(), r, t, false, method);
        e.seconds += seconds_since(start);
        Pose P = Pose::Identity();
        P.linear() = rotation_exp({r[0], r[1], r[2]});
        P.translation() = Point3(t[0], t[1], t[2]);
        e.add(P, T);
      };
      theirs(cv::SOLVEPNP_SQPNP, sqpnp);
      theirs(cv::SOLVEPNP_EPNP, epnp);
    }
  }
  return {{"surfleet", ours.json()}, {"opencv_sqpnp", sqpnp.json()}, {"opencv_epnp", epnp.json()}};
}

struct Cell {
  int right = 0, unique = 0, unique_right = 0, none = 0, poses = 0;
  double seconds = 0.0;
  Json json() const {
    return {{"right", right},
            {"of", poses},
            {"right_of_200", 200.0 * right / poses},
            {"unique", unique},
            {"unique_right", unique_right},
            {"none", none},
            {"ms", 1e3 * seconds / poses}};
  }
};
Cell unlabelled(const Settings& s, const PinholeCamera& camera, const MarkerTarget& target,
                double near, double far, double noise, int hidden, int outliers) {
  Cell cell;
  for (int seed = 0; seed < s.seeds; ++seed) {
    Random random(static_cast<std::uint64_t>(s.first_seed + seed));
    for (int i = 0; i < s.poses; ++i) {
      const Pose T = random_view(camera, target, near, far, random);
      auto pixels = see(camera, target, T, noise, random);
      for (int h = 0; h < hidden; ++h)
        pixels.erase(pixels.begin() + static_cast<std::ptrdiff_t>(random.below(pixels.size())));
      for (int o = 0; o < outliers; ++o)
        pixels.emplace_back(random.uniform(0, 751), random.uniform(0, 479));
      random.shuffle(pixels);
      IdentifyOptions options;
      options.pixel_noise = noise;
      const auto start = Clock::now();
      const auto found = identify(observe_all(camera, pixels), target, options);
      cell.seconds += seconds_since(start);
      ++cell.poses;
      if (found.fits.empty()) {
        ++cell.none;
        continue;
      }
      const Vector6 xi = difference(T, found.fits[0].T_camera_target);
      const bool right =
          xi.head<3>().norm() < radians(10.0) && xi.tail<3>().norm() < 0.1 * T.translation().norm();
      cell.right += right;
      cell.unique += !found.ambiguous();
      cell.unique_right += right && !found.ambiguous();
    }
  }
  return cell;
}
/// RMS error of labelled poses over what their covariance says, and how often the truth is within
/// its 95 % region.
Json covariance(const Settings& s, double noise) {
  const PinholeCamera camera = camera_with(376.0);
  const MarkerTarget target = printed_target();
  Json rows = Json::array();
  for (const double distance : {0.7, 1.7, 3.0}) {
    double squares = 0.0, bound = 0.0, turn = 0.0, turn_bound = 0.0;
    int within = 0, all = 0;
    for (int seed = 0; seed < s.seeds; ++seed) {
      Random random(static_cast<std::uint64_t>(s.first_seed + seed));
      for (int i = 0; i < s.poses; ++i, ++all) {
        const Pose T = random_view(camera, target, distance, distance, random);
        const auto seen = observe_all(camera, see(camera, target, T, noise, random));
        const RefinedPose found = refine_pose(seen, target.markers, T);
        const UncertainPose pose{found.T_camera_target, found.covariance(noise)};
        const Vector6 xi = difference(T, pose.pose);
        squares += xi.tail<3>().squaredNorm();
        turn += xi.head<3>().squaredNorm();
        bound += pose.covariance.diagonal().tail<3>().sum();
        turn_bound += pose.covariance.diagonal().head<3>().sum();
        within += pose.normalized_error(T) <= 12.592;
      }
    }
    rows.push_back({{"distance_m", distance},
                    {"rms_m", std::sqrt(squares / all)},
                    {"bound_m", std::sqrt(bound / all)},
                    {"rms_deg", degrees(std::sqrt(turn / all))},
                    {"bound_deg", degrees(std::sqrt(turn_bound / all))},
                    {"position_over_bound", std::sqrt(squares / bound)},
                    {"rotation_over_bound", std::sqrt(turn / turn_bound)},
                    {"within_95", static_cast<double>(within) / all}});
  }
  return rows;
}
Json blobs(const Settings& s) {
  Json rows = Json::array();
  const PinholeCamera camera = camera_with(376.0);
  for (const double diameter : {4.0, 6.0, 8.0, 12.0, 16.0, 20.0}) {
    double squares = 0.0;
    int found = 0, drawn = 0;
    for (int seed = 0; seed < s.seeds; ++seed) {
      Random random(static_cast<std::uint64_t>(s.first_seed + seed));
      MarkerImages draw({}, static_cast<std::uint64_t>(s.first_seed + seed));
      for (int i = 0; i < 10; ++i) {
        std::vector<ImageDisc> discs;
        for (int y = 0; y < 4; ++y)
          for (int x = 0; x < 6; ++x, ++drawn)
            discs.push_back(
                {{60 + 120 * x + random.uniform(-8, 8), 60 + 110 * y + random.uniform(-8, 8)},
                 0.5 * diameter,
                 false});
        for (const Blob& b : extract_blobs(draw(camera, MarkerTarget{}, Pose::Identity(), discs))) {
          double least = 1e9;
          for (const ImageDisc& d : discs) least = std::min(least, (d.center - b.center).norm());
          squares += least * least;
          ++found;
        }
      }
    }
    rows.push_back({{"diameter_px", diameter},
                    {"rms_px", std::sqrt(squares / found)},
                    {"found", found},
                    {"drawn", drawn}});
  }
  return rows;
}
/// Rendered sequences at one distance or over a motion, with clutter and hidden markers.
struct Sequence {
  int frames = 0, tracked = 0, wrong = 0, longest_recovery = 0, hidden_frames = 0;
  std::vector<double> position, angle, whole_ms, tracked_ms;
  Json json() const {
    return {{"frames", frames},
            {"tracked_share", static_cast<double>(tracked) / frames},
            {"wrong_share", static_cast<double>(wrong) / frames},
            {"slowest_recovery_frames", longest_recovery},
            {"position_mean_m", summarize(position).mean},
            {"orientation_mean_deg", summarize(angle).mean},
            {"position_max_m", summarize(position).maximum},
            {"whole_frame_ms", percentile(whole_ms, 0.5)},
            {"tracked_frame_ms", percentile(tracked_ms, 0.5)}};
  }
};
void run_sequence(const CameraMotionOptions& motion, int frames, bool hide, int outliers,
                  std::uint64_t seed, Sequence& out) {
  const PinholeCamera camera = camera_with(376.0);
  const MarkerTarget target = printed_target();
  MarkerImages draw({}, seed);
  ImageTracker track(camera, target);
  const CameraMotion move(motion, seed);
  Random random(seed);
  int waiting = 0;
  for (int k = 0; k < frames; ++k) {
    const double t = k / 30.0;
    std::vector<ImageDisc> discs;
    for (int i = 0; i < outliers; ++i)
      discs.push_back(
          {{random.uniform(0, 752), random.uniform(0, 480)}, random.uniform(1.5, 6.0), false});
    std::vector<bool> hidden(4, false);
    const double phase = std::fmod(t, 10.0);
    if (hide && phase >= 4.0 && phase < 6.0) hidden[static_cast<std::size_t>(t / 10.0) % 4] = true;
    const Pose truth = move(t);
    const GreyImage image = draw(camera, target, truth, discs, hidden);
    const auto start = Clock::now();
    const ImageFrame frame = track(image, t);
    const double ms = 1e3 * seconds_since(start);
    (frame.whole ? out.whole_ms : out.tracked_ms).push_back(ms);
    ++out.frames;
    if (frame.tracked.state != TrackState::tracked) {
      ++waiting;
      continue;
    }
    out.longest_recovery = std::max(out.longest_recovery, waiting);
    waiting = 0;
    ++out.tracked;
    const Vector6 xi = difference(truth, frame.tracked.fits[0].T_camera_target);
    out.position.push_back(xi.tail<3>().norm());
    out.angle.push_back(degrees(xi.head<3>().norm()));
    out.wrong += out.angle.back() > 15.0 || out.position.back() > 0.15 * truth.translation().norm();
  }
}
Json rendered(const Settings& s) {
  Json out;
  for (const double distance : {0.7, 1.7, 3.0}) {
    Sequence seq;
    for (int seed = 0; seed < s.seeds; ++seed)
      run_sequence({.nearest = distance, .farthest = distance}, 2 * s.poses / s.seeds, false, 0,
                   static_cast<std::uint64_t>(s.first_seed + seed), seq);
    out["at_" + format_number(distance, 1) + "_m"] = seq.json();
  }
  return out;
}
Json tracking(const Settings& s) {
  Json out;
  for (const bool hide : {false, true}) {
    Sequence seq;
    for (int seed = 0; seed < s.seeds; ++seed)
      run_sequence(handheld_motion(), 2 * s.poses, hide, hide ? 5 : 0,
                   static_cast<std::uint64_t>(s.first_seed + seed), seq);
    out[hide ? "hidden_2_s_and_5_outliers" : "clear"] = seq.json();
  }
  // The first frame, with five outliers.
  const PinholeCamera camera = camera_with(376.0);
  std::vector<double> ms;
  for (int i = 0; i < 200; ++i) {
    const auto seed = static_cast<std::uint64_t>(s.first_seed + i);
    Random random(seed);
    MarkerImages draw({}, seed);
    std::vector<ImageDisc> discs;
    for (int k = 0; k < 5; ++k)
      discs.push_back({{random.uniform(0, 752), random.uniform(0, 480)}, 4.0, false});
    const GreyImage image = draw(camera, printed_target(), CameraMotion({}, seed)(0.0), discs);
    ImageTracker track(camera, printed_target());
    const auto start = Clock::now();
    static_cast<void>(track(image, 0.0));
    ms.push_back(1e3 * seconds_since(start));
  }
  out["start_up_ms"] = percentile(ms, 0.5);
  return out;
}

int run(int argc, char** argv) {
  Settings s;
  cli::Options app("Measures the localisation of targets; prints JSON.");
  app.add("what", s.what,
          "p3p, labelled, unlabelled, printed, covariance, blobs, rendered, tracking")
      .one_of({"p3p", "labelled", "unlabelled", "printed", "covariance", "blobs", "rendered",
               "tracking"});
  app.add("--poses", s.poses, "Poses for each seed").within(1, 1000000);
  app.add("--seeds", s.seeds, "Number of seeds").within(1, 1000);
  app.add("--first-seed", s.first_seed, "First of them").within(0, 1000000);
  app.parse(argc, argv);
  Json out;
  if (s.what == "p3p")
    out = {{"lambda_twist", p3p<LambdaTwistP3p>(s)},
           {"kneip", p3p<KneipP3p>(s)},
           {"opencv_p3p", opencv_p3p(s, cv::SOLVEPNP_P3P)},
           {"opencv_ap3p", opencv_p3p(s, cv::SOLVEPNP_AP3P)}};
  if (s.what == "labelled") out = labelled(s);
  if (s.what == "unlabelled") {
    const MarkerTarget target = five_leds();
    const PinholeCamera camera = camera_with(600.0);
    const char* names[] = {"all_seen", "one_hidden", "five_outliers", "both"};
    for (int k = 0; k < 4; ++k)
      out[names[k]] = unlabelled(s, camera, target, 0.8, 3.0, 0.3, k % 2, k >= 2 ? 5 : 0).json();
  }
  if (s.what == "printed")
    out = unlabelled(s, camera_with(376.0), printed_target(), 0.7, 3.0, 0.1, 0, 0).json();
  if (s.what == "covariance")
    out = {{"0.1 px", covariance(s, 0.1)}, {"0.3 px", covariance(s, 0.3)}};
  if (s.what == "blobs") out = blobs(s);
  if (s.what == "rendered") out = rendered(s);
  if (s.what == "tracking") out = tracking(s);
  std::printf("%s\n", out.dump(1).c_str());
  return cli::kDone;
}
}  // namespace

int main(int argc, char** argv) {
  return surfleet::cli::run("localization_accuracy", [&] { return run(argc, argv); });
}
