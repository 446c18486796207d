// SPDX-License-Identifier: MIT
/// @file
/// @brief Voronoi coverage by robots that know only what they asked their neighbours.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <utility>
#include <vector>

#include <surfleet/core/transport.hpp>
#include <surfleet/coverage/centroid.hpp>
#include <surfleet/coverage/voronoi_cells.hpp>

namespace surfleet {
/// What a robot answers: where it is, and where its Voronoi neighbours were when it last heard.
struct NeighbourReport {
  Point2 position = Point2::Zero();
  std::vector<std::pair<std::int32_t, Point2>> neighbours;
};

struct NeighbourMessage {
  bool is_question = false;
  NeighbourReport report{};  ///< The answer, if it is one.
};

/// Lloyd's algorithm on robots that exchange positions with their Voronoi neighbours alone.
///
/// A robot learns of a new neighbour from an old one: the neighbours of its neighbours come with
/// their answers, and one that cuts its cell is asked next. `discover` finds the first neighbours,
/// once, as robots that are switched on together would. Each round costs O(k) questions for k
/// neighbours.
class DistributedLloyd {
 public:
  DistributedLloyd(Polygon domain, std::vector<Point2> robots)
      : network(robots.size()),
        domain_(std::move(domain)),
        positions_(std::move(robots)),
        tables_(positions_.size()),
        cells_(positions_.size()) {
    require_placed(domain_, positions_);
    discover();
  }
  const std::vector<Point2>& positions() const { return positions_; }
  const VoronoiCell& cell(std::size_t i) const { return cells_[i]; }

  /// Every robot asks its neighbours where they are and computes its own cell.
  void exchange() {
    bool changed = true;
    for (int round = 0; changed && round < 64; ++round, ++round_) {
      for (std::size_t i = 0; i < positions_.size(); ++i)
        for (const auto& [j, old] : tables_[i]) send(i, j, {.is_question = true});
      answer_all();
      changed = false;
      for (std::size_t i = 0; i < positions_.size(); ++i) changed = update(i) || changed;
    }
  }
  /// Every robot moves towards its centroid, by `share` of the distance; then tables are brought up
  /// to date.
  double move(double share = 1.0) {
    double largest = 0.0;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const RegionMoments m =
          region_moments(cells_[i].region, positions_[i], UniformDensity{}, 0.0);
      const Point2 step = share * (m.centroid() - positions_[i]);
      largest = std::max(largest, step.norm());
      positions_[i] += step;
    }
    exchange();
    return largest;
  }

  PerfectTransport<NeighbourMessage> network;

 private:
  using Table = std::map<std::int32_t, Point2>;

  void send(std::size_t from, std::int32_t to, NeighbourMessage message) {
    network.send({.time = static_cast<double>(round_),
                  .from = static_cast<RobotId>(from),
                  .to = static_cast<RobotId>(to),
                  .payload = std::move(message)});
  }
  /// All tell each robot that has asked what they know now.
  void answer_all() {
    std::vector<std::vector<Message<NeighbourMessage>>> questions;
    for (std::size_t i = 0; i < positions_.size(); ++i)
      questions.push_back(network.receive(static_cast<RobotId>(i)));
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      const NeighbourReport report{positions_[i], {tables_[i].begin(), tables_[i].end()}};
      for (const auto& question : questions[i])
        send(i, static_cast<std::int32_t>(question.from), {.report = report});
    }
  }
  void discover() {
    const Box2 box = widened();
    const VoronoiNeighbourSearch search(positions_, box);
    for (std::size_t i = 0; i < positions_.size(); ++i)
      for (const auto& b : search.bounds(i))
        tables_[i][b.other] = positions_[static_cast<std::size_t>(b.other)];
    exchange();
  }
  /// The tables are those of a wide box, so that robots parted by an obstacle or a notch of the
  /// domain still hear of each other; the cells are those of the domain.
  Box2 widened() const {
    Box2 box = domain_.bounds();
    const Point2 margin = box.sizes();
    return Box2(box.min() - margin, box.max() + margin);
  }
  bool update(std::size_t i) {
    const auto self = static_cast<std::int32_t>(i);
    Table known;  // candidates heard of, then what the asked ones said themselves
    const auto answers = network.receive(static_cast<RobotId>(i));
    for (const auto& answer : answers)
      for (const auto& [k, place] : answer.payload.report.neighbours)
        if (k != self) known[k] = place;
    for (const auto& answer : answers)
      known[static_cast<std::int32_t>(answer.from)] = answer.payload.report.position;
    const std::vector<std::pair<std::int32_t, Point2>> others(known.begin(), known.end());
    const Box2 box = widened();
    const Polygon frame{
        {box.min(), {box.max().x(), box.min().y()}, box.max(), {box.min().x(), box.max().y()}}, {}};
    const VoronoiCell open = voronoi_cell(frame, positions_[i], others);
    Table table;
    for (const std::int32_t j : open.neighbours) table[j] = known[j];
    const std::vector<std::pair<std::int32_t, Point2>> near(table.begin(), table.end());
    cells_[i] = voronoi_cell(domain_, positions_[i], near);
    const bool same = std::equal(
        table.begin(), table.end(), tables_[i].begin(), tables_[i].end(),
        [](const auto& a, const auto& b) { return a.first == b.first && a.second == b.second; });
    tables_[i] = std::move(table);
    return !same;
  }

  Polygon domain_;
  std::vector<Point2> positions_;
  std::vector<Table> tables_;
  std::vector<VoronoiCell> cells_;
  std::uint64_t round_ = 0;  // stands for the time
};
}  // namespace surfleet
