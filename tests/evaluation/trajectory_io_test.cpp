// SPDX-License-Identifier: MIT
#include <surfleet/evaluation/trajectory_io.hpp>

#include <filesystem>

#include <surfleet/core/random.hpp>

#include "check.hpp"

using namespace surfleet;

TEST(trajectories_round_trip) {
  Random random(3);
  Trajectory t;
  for (int i = 0; i < 50; ++i) {
    StampedPose s{0.1 * i, Pose::Identity()};
    s.T_world_body.translate(Point3(random.normal(), 1e6 * random.normal(), -random.uniform()));
    s.T_world_body.rotate(
        Eigen::Quaterniond(random.normal(), random.normal(), random.normal(), random.normal())
            .normalized());
    t.push_back(s);
  }
  const auto path = std::filesystem::temp_directory_path() / "surfleet_trajectory_test.txt";
  write_tum(path, t);
  const Trajectory back = read_tum(path);
  std::filesystem::remove(path);
  CHECK(back.size() == t.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    CHECK(back[i].time == t[i].time);
    CHECK(back[i].T_world_body.translation() == t[i].T_world_body.translation());
    CHECK(back[i].T_world_body.isApprox(t[i].T_world_body, 1e-12));
  }
}

TEST(length_of_a_square) {
  const Trajectory t = parse_tum(
      "# comment\r\n\n0 0 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\r\n  2\t1 1 0 0 0 0 1 \n3 0 1 0 0 0 0 -1");
  CHECK(t.size() == 4);
  CHECK_NEAR(path_length(t), 3.0, 1e-15);
  CHECK(path_length({}) == 0.0 && parse_tum("").empty());
}

TEST(bad_lines_are_refused_with_their_number) {
  for (const char* bad :
       {"0 0 0 0 0 0 0", "0 0 0 0 0 0 0 1 5", "0 0 0 nan 0 0 0 1", "0 0 0 inf 0 0 0 1",
        "a 0 0 0 0 0 0 1", "0 0 0 0 0 0 0 0", "0 0 0 0 0 0 0 2", "0,0,0,0,0,0,0,1",
        "0 0 0 1e999 0 0 0 1", "0 0x1 0 0 0 0 0 1", "5 0 0 0 0 0 0 1\n4 0 0 0 0 0 0 1"})
    CHECK_THROWS(Error, parse_tum(bad));
  try {
    parse_tum("0 0 0 0 0 0 0 1\n\nbad", "file.txt");
  } catch (const Error& e) {
    CHECK(std::string(e.what()).starts_with("file.txt: line 3:"));
  }
  CHECK_THROWS(Error, read_tum("/nonexistent/file"));
}

TEST(lines_that_are_no_pose_leave_the_others) {
  const auto lines = parse_tum_lines(
      "# t\n1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 0\n3 0 0 nan 0 0 0 1\n\ncut\n4 1 0 0 0 0 0 1 9\n"
      "0.5 1 0 0 0 0 0 1\n5 7 0 0 0 0 0 1\r\n6 0 0");
  CHECK(lines.size() == 8);
  for (std::size_t i = 0; i < lines.size(); ++i)
    CHECK(lines[i].error.empty() == (i == 0 || i == 6));
  CHECK(lines[1].time == 2.0 && lines[2].time == 3.0 && !lines[3].time && lines[7].time == 6.0);
  CHECK(lines[3].number == 6 && lines[6].number == 9);
  CHECK(lines[6].T_world_body.translation() == Point3(7, 0, 0));
  CHECK(lines[1].error.find("rigid") != std::string::npos);
}
