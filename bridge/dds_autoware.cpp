// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds_autoware.hpp"

#include "bridge/dds_support.hpp"
#include "bridge/dds_track_feed.hpp"
#include "bridge/dds_track_messages.hpp"

namespace jink::bridge {

class DdsAutowareReader::Impl : public DdsTrackFeed {
 public:
  Impl(DdsNode& node, const Clock& clock)
      : DdsTrackFeed(node, clock, {kAutowareTopic, kAutowareType, decode_tracked_objects, refuse_frame}) {}

 private:
  static std::string refuse_frame(const std::string& frame_id) {
    if (frame_id == "map") return {};
    return "TrackedObjects: frame_id '" + printable(frame_id) + "' is not 'map'";
  }
};

DdsAutowareReader::DdsAutowareReader(DdsNode& node, const Clock& clock) : impl_(std::make_unique<Impl>(node, clock)) {}
DdsAutowareReader::~DdsAutowareReader() = default;
void DdsAutowareReader::notify(Wake& wake) {
  impl_->notify(wake);
}
bool DdsAutowareReader::poll(TrackMessage& message) {
  return impl_->poll(message);
}
TrackSourceStatus DdsAutowareReader::status() const {
  return impl_->status();
}
std::uint64_t DdsAutowareReader::overruns() const {
  return impl_->overruns();
}
std::uint64_t DdsAutowareReader::malformed() const {
  return impl_->malformed();
}

}  // namespace jink::bridge
