// SPDX-License-Identifier: MIT
#include <surfleet/geometry/pose_io.hpp>

#include <cmath>
#include <limits>
#include <string>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

namespace {
Pose some_pose(Random& random) {
  const auto number = [&] { return 2.0 * random.uniform() - 1.0; };
  Pose pose = Pose::Identity();
  pose.linear() =
      Eigen::Quaterniond(number(), number(), number(), number()).normalized().toRotationMatrix();
  pose.translation() = 1e3 * Point3(number(), number(), number());
  return pose;
}
std::string refusal(const std::string& text) {
  try {
    static_cast<void>(parse_pose(text, "p.txt"));
  } catch (const Error& e) {
    return e.what();
  }
  return {};
}
constexpr const char* kIdentity = "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
}  // namespace

TEST(poses_round_trip_to_the_last_bit) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Pose pose = some_pose(random);
    CHECK(parse_pose(format_pose(pose)).matrix() == pose.matrix());
  }
}

TEST(poses_are_read_as_data_sets_write_them) {
  // As Windows wrote them, with exponents of three digits and a tab at the end.
  const Pose p = parse_pose(
      "# camera to world\r\n\r\n  0.0e+000\t -1.0000000e+000  0 1.5\t\r\n1 0 0 -2\r\n0 0 1 +3\r\n"
      "  # the last\r\n0 0 0 1");
  CHECK_NEAR((p * Point3(1, 2, 3) - Point3(-0.5, -1, 6)).norm(), 0.0, 1e-15);
  CHECK(parse_pose("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1").isApprox(Pose::Identity()));
  // Rounded to three digits, the nearest rotation.
  const Pose rounded = parse_pose("0.866 -0.5 0 0\n0.5 0.866 0 0\n0 0 1 0\n0 0 0 1\n");
  CHECK_NEAR((rounded.linear().transpose() * rounded.linear() - Eigen::Matrix3d::Identity()).norm(),
             0.0, 1e-14);
  CHECK_NEAR(rounded.linear()(1, 0), 0.5, 1e-4);
}

TEST(what_is_no_pose_is_refused_with_its_place) {
  CHECK(refusal(kIdentity).empty());
  CHECK(refusal("1 0 0 0\n0 1 0 0\n0 0 1 0\n").find("p.txt: line 3: the numbers end") == 0);
  CHECK(refusal(std::string(kIdentity) + "7\n").find("line 5: more numbers") != std::string::npos);
  CHECK(refusal("1 0 0 0\n0 1 nan 0\n0 0 1 0\n0 0 0 1").find("line 2: no finite") !=
        std::string::npos);
  for (const char* text : {"", "# nothing\n", "-1.#IND 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
                           "1e999 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "1,0,0,0"})
    CHECK(!refusal(text).empty());
  // Scaled, sheared, mirrored, projective, all nought.
  for (const char* text :
       {"1.1 0 0 0 0 1.1 0 0 0 0 1.1 0 0 0 0 1", "1 0.1 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
        "-1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "1 0 0 0 0 1 0 0 0 0 1 0 0 0 0.1 1",
        "0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 1", "1e200 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1"})
    CHECK(refusal(text).find("not rigid") != std::string::npos);
}

TEST(intrinsics_round_trip_and_are_checked) {
  const Intrinsics k{525.25, 524.75, 319.5, 239.5};
  const Intrinsics back = parse_intrinsics(format_intrinsics(k));
  CHECK(back.fx == k.fx && back.fy == k.fy && back.cx == k.cx && back.cy == k.cy);
  const Intrinsics read =
      parse_intrinsics(" 5.85e+02\t 0 3.2e+02\t\r\n 0 586 2.4e+02\r\n 0 0 1\r\n");
  CHECK(read.fx == 585.0 && read.fy == 586.0 && read.cx == 320.0 && read.cy == 240.0);
  for (const char* text :
       {"", "585 0 320 0 585 240 0 0", "585 0 320 0 585 240 0 0 2", "-585 0 320 0 585 240 0 0 1",
        "585 3 320 0 585 240 0 0 1", "585 0 nan 0 585 240 0 0 1", "585 0 320 0 585 240 0 0 1 1"})
    CHECK_THROWS(Error, parse_intrinsics(text));
}
