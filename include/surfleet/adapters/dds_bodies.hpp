// SPDX-License-Identifier: MIT
/// @file
/// @brief Where simulated bodies are in truth, over DDS: for what simulates cameras and sight
/// alone.
#pragma once

#include <dds/dds.h>
#include <surfleet/adapters/fleet_message.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <utility>

#include <surfleet/adapters/dds_team.hpp>
#include <surfleet/core/types.hpp>

namespace surfleet {
/// One robot's end. Poses go by a partition of their own, best effort: only the newest counts. A
/// body whose process ended stays where it was last.
class DdsBodies {
 public:
  /// Throws `Error` if there is no room for more.
  explicit DdsBodies(std::shared_ptr<DdsTeam> team) : team_(std::move(team)) {
    const dds_entity_t of = team_->participant();
    const detail::DdsQos all = team_->all_partitions(kRoom), own = team_->own_partition(kRoom);
    const detail::DdsQos newest(dds_create_qos());
    dds_qset_reliability(newest.get(), DDS_RELIABILITY_BEST_EFFORT, 0);
    dds_qset_history(newest.get(), DDS_HISTORY_KEEP_LAST, 1);
    detail::dds_bound(newest.get(), team_->options().robots, 1);
    dds_qset_ignorelocal(newest.get(), DDS_IGNORELOCAL_PARTICIPANT);
    const dds_entity_t topic = detail::dds_checked(
        dds_create_topic(of, &surfleet_dds_BodyPose_desc, "surfleet_body", newest.get(), nullptr),
        "topic");
    reader_ = detail::dds_checked(
        dds_create_reader(
            detail::dds_checked(dds_create_subscriber(of, all.get(), nullptr), "subscriber"), topic,
            newest.get(), nullptr),
        "reader");
    writer_ = detail::dds_checked(
        dds_create_writer(
            detail::dds_checked(dds_create_publisher(of, own.get(), nullptr), "publisher"), topic,
            newest.get(), nullptr),
        "writer");
  }

  void tell(const Configuration& at) {
    const surfleet_dds_BodyPose pose{team_->self(), at.position.x(), at.position.y(),
                                     at.position.z(), at.yaw};
    dds_write(writer_, &pose);
  }
  /// Where others were last, of all that have told.
  const std::map<RobotId, Configuration>& others() {
    constexpr std::size_t kAtOnce = 64;
    std::array<void*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos{};
    const dds_return_t n = dds_take(reader_, samples.data(), infos.data(), kAtOnce, kAtOnce);
    if (n <= 0) return last_;
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      if (!infos[i].valid_data) continue;
      const auto& pose = *static_cast<const surfleet_dds_BodyPose*>(samples[i]);
      const Point3 at(pose.x, pose.y, pose.z);
      if (!at.allFinite() || !std::isfinite(pose.yaw) || pose.robot == team_->self() ||
          team_->robot_of(reader_, infos[i].publication_handle, kRoom) != pose.robot)
        continue;
      last_[pose.robot] = {at, pose.yaw};
    }
    dds_return_loan(reader_, samples.data(), n);
    return last_;
  }

 private:
  static constexpr const char* kRoom = "body";
  std::shared_ptr<DdsTeam> team_;
  dds_entity_t reader_ = 0, writer_ = 0;
  std::map<RobotId, Configuration> last_;
};
}  // namespace surfleet
