// SPDX-License-Identifier: MIT
#include <surfleet/surface/sheet_tokens.hpp>
#include <surfleet/surface/tensor_voting.hpp>

#include <surfleet/core/random.hpp>
#include <surfleet/core/rotation.hpp>

#include "check.hpp"

namespace {
using namespace surfleet;

Eigen::Vector3d random_unit(Random& random) {
  return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}
double line_angle(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return degrees(std::atan2(a.cross(b).norm(), std::abs(a.dot(b))));
}
double median(std::vector<double> values) {
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2),
                   values.end());
  return values[values.size() / 2];
}
/// Points on a tube about the z axis, moved by noise in every direction.
std::vector<Point3> tube(Random& random, double radius, std::size_t count, double noise) {
  std::vector<Point3> points;
  for (std::size_t i = 0; i < count; ++i) {
    const double a = random.uniform(-kPi, kPi);
    const double z = random.uniform(-0.5, 0.5);
    const Eigen::Vector3d off(random.normal(), random.normal(), random.normal());
    points.push_back(Point3(radius * std::cos(a), radius * std::sin(a), z) + noise * off);
  }
  return points;
}

TEST(decays_peak_one_scale_away_and_end) {
  const KingDecay king;
  CHECK_NEAR(king(1.0, 0.0), 1.0, 1e-12);
  CHECK(king(0.9, 0.0) < 1.0 && king(1.1, 0.0) < 1.0 && king(0.0, 0.0) == 0.0 &&
        king(3.0, 0.0) == 0.0);
  CHECK(king(1.0, 0.71) == 0.0 && king(1.0, 0.5) > 0.0);
  CHECK_NEAR(king(1.0, 0.5), std::pow(0.75, 4), 1e-12);
  const GaussianVoteDecay gauss;
  CHECK(gauss(1.0, 0.3) < gauss(1.0, 0.0) && gauss(2.0, 0.0) < gauss(1.0, 0.0));
}

// A ball is a stick turned about every axis, a plate one turned about its tangent: the directions
// of the votes are those of the integrals.
TEST(balls_and_plates_are_turned_sticks) {
  Random random(3);
  const KingDecay decay;
  for (int i = 0; i < 30; ++i) {
    const Eigen::Vector3d u = random_unit(random);
    const double z = random.uniform(0.3, 2.5);
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (int k = 0; k < 4000; ++k) {  // an even spiral over the sphere
      const double h = 1.0 - (2.0 * k + 1.0) / 4000.0, a = k * kPi * (3.0 - std::sqrt(5.0));
      const double r = std::sqrt(1.0 - h * h);
      sum += stick_vote(decay, Eigen::Vector3d(r * std::cos(a), r * std::sin(a), h), u, z);
    }
    const Token turned = decomposed({0, 0, 0}, sum);
    const Token ball = decomposed({0, 0, 0}, ball_vote(decay, u, z));
    CHECK(line_angle(turned.tangent, u) < 0.5 && line_angle(ball.tangent, u) < 1e-3);
    CHECK(turned.stick < 0.02 * turned.plate && ball.stick < 1e-9);

    const Eigen::Vector3d t = random_unit(random);
    sum.setZero();
    const Eigen::Vector3d a = t.unitOrthogonal(), b = t.cross(a);
    for (int k = 0; k < 720; ++k)
      sum += stick_vote(decay, std::cos(kPi * k / 720) * a + std::sin(kPi * k / 720) * b, u, z);
    const Eigen::Matrix3d vote = plate_vote(decay, t, u, z);
    if (vote.isZero(0.0)) continue;
    const Token whole = decomposed({0, 0, 0}, sum), plate = decomposed({0, 0, 0}, vote);
    // Both are spanned by b2 and the mirrored b1, and lack the mirrored tangent.
    CHECK(line_angle(whole.tangent, plate.tangent) < 0.5);
    CHECK_NEAR(vote.trace(), 2.0 * decay(z, (u - u.dot(t) * t).norm()), 1e-12);
  }
}

TEST(votes_do_not_depend_on_frame_unit_order_or_threads) {
  Random random(5);
  const std::vector<Point3> points = tube(random, 0.3, 1500, 0.01);
  const TensorVoting<> vote{{.scale = 0.06}, {}};
  const auto tokens = vote.refined(points);
  CHECK(tokens.size() > 200 && tokens.size() < points.size());
  TensorVoting<> many = vote;
  many.options.threads = 3;
  const auto threaded = many.refined(points);
  CHECK(threaded.size() == tokens.size());
  for (std::size_t i = 0; i < tokens.size(); ++i)
    CHECK(threaded[i].stick == tokens[i].stick && threaded[i].normal == tokens[i].normal);

  const Eigen::Quaterniond q = rotation_between({0, 0, 1}, {0.3, 0.5, 0.2});
  std::vector<Point3> moved;
  for (const Point3& p : points) moved.push_back(1000.0 * (q * p) + Point3(5, -3, 2));
  TensorVoting<> wide = vote;
  wide.options.scale = 60.0;
  const auto far = wide.refined(moved);
  CHECK(far.size() == tokens.size());
  std::vector<Point3> reversed(points.rbegin(), points.rend());
  const auto back = vote.refined(reversed);
  CHECK(back.size() == tokens.size());
  for (std::size_t i = 0; i < std::min(tokens.size(), far.size()); ++i) {
    CHECK_NEAR(far[i].stick, tokens[i].stick, 1e-6 * (1.0 + tokens[i].stick));
    CHECK(line_angle(far[i].normal, q * tokens[i].normal) < 1e-3);
    CHECK_NEAR(back[tokens.size() - 1 - i].stick, tokens[i].stick, 1e-9 * (1.0 + tokens[i].stick));
  }
  for (std::size_t i = 0; i < tokens.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      CHECK((tokens[i].position - tokens[j].position).norm() > 0.03);
}

TEST(normals_of_a_noisy_tube) {
  Random random(8);
  const double radius = 0.35;
  for (const double noise : {0.005, 0.018}) {
    const std::vector<Point3> points = tube(random, radius, 7900, noise);
    const auto errors = [&](const std::vector<Token>& tokens) {
      std::vector<double> error;
      for (const Token& t : tokens)
        if (std::abs(t.position.z()) < 0.35)
          error.push_back(line_angle(t.normal, {t.position.x(), t.position.y(), 0.0}));
      return median(error);
    };
    CHECK(errors(SheetTokens{}(points)) < (noise < 0.01 ? 0.8 : 1.6));
    CHECK(errors(TensorVoting<>{{.scale = 0.06}, {}}.refined(points)) < 8.0);
  }
}

// A point off the border of a plate is led back to the plate, not tilted by where the others lie.
TEST(a_stray_point_returns_to_its_sheet) {
  Random random(6);
  std::vector<Point3> points;
  for (int i = 0; i < 1500; ++i)
    points.push_back({random.uniform(0, 0.4), random.uniform(-0.2, 0.2), 0});
  points.push_back({0.0, 0.0, 0.03});
  const Token token = SheetTokens{.rounds = 1}(points).back();
  CHECK(line_angle(token.normal, Eigen::Vector3d::UnitZ()) < 1.0);
  CHECK_NEAR(token.position.z(), 0.0, 2e-3);
}

// A right-angled fold: tokens near the crease are told apart by their share of plate.
TEST(a_fold_is_an_edge) {
  Random random(2);
  std::vector<Point3> points;
  for (int i = 0; i < 6000; ++i) {
    const double a = random.uniform(0, 0.6), y = random.uniform(-0.4, 0.4);
    points.push_back(i % 2 == 0 ? Point3(a, y, 0) : Point3(0, y, a));
  }
  const TensorVoting<> vote{{.scale = 0.06}, {}};
  double at_edge = 0.0, away = 0.0;
  int edges = 0, others = 0;
  for (const Token& t : vote.refined(points)) {
    if (std::abs(t.position.y()) > 0.2 || t.position.norm() > 0.5) continue;
    const double d = std::hypot(t.position.x(), t.position.z());
    if (d < 0.03) {
      at_edge += t.plate_share();
      ++edges;
      CHECK(line_angle(t.tangent, Eigen::Vector3d::UnitY()) < 15.0);
    } else if (d > 0.2) {
      away += t.plate_share();
      ++others;
    }
  }
  CHECK(edges > 3 && others > 50);
  CHECK(at_edge / edges > 3.0 * away / others);
}

TEST(odd_clouds_have_answers) {
  const TensorVoting<> vote;
  CHECK(vote.refined(std::vector<Point3>{}).empty());
  CHECK(vote.refined(std::vector<Point3>{{0, 0, 0}}).size() == 1);
  const std::vector<Point3> doubled(5, Point3(1, 2, 3));
  CHECK(vote.refined(doubled).size() == 1 && vote.balls(doubled)[0].stick == 0.0);
  CHECK(SheetTokens{}(doubled).size() == 5);
  std::vector<Point3> line;
  for (int i = 0; i < 30; ++i) line.push_back({0.02 * i, 0, 0});
  for (const Token& t : vote.balls(line))
    CHECK(line_angle(t.tangent, Eigen::Vector3d::UnitX()) < 1e-6);
  line.push_back({std::nan(""), 0, 0});
  CHECK_THROWS(Error, vote.balls(line));
  CHECK_THROWS(Error, SheetTokens{}(line));
  CHECK_THROWS(Error, (TensorVoting<>{{.scale = 0.0}, {}}.balls(doubled)));
}
}  // namespace
