// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/autoware.hpp"

#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/track_feed.hpp"

namespace jink::bridge::dds {

class DdsAutowareReader::Impl : public DdsTrackFeed {
 public:
  Impl(DdsParticipant& node, const base::Clock& clock)
      : DdsTrackFeed(node, clock, {kAutowareTopic, kAutowareType, cdr::decode_tracked_objects, refuse_frame}) {}

 private:
  static std::string refuse_frame(const std::string& frame_id) {
    if (frame_id == "map") return {};
    return "TrackedObjects: frame_id '" + cdr::printable(frame_id) + "' is not 'map'";
  }
};

DdsAutowareReader::DdsAutowareReader(DdsParticipant& node, const base::Clock& clock)
    : impl_(std::make_unique<Impl>(node, clock)) {}
DdsAutowareReader::~DdsAutowareReader() = default;
void DdsAutowareReader::notify(base::Notifier& notifier) {
  impl_->notify(notifier);
}
bool DdsAutowareReader::poll(tracking::TrackMessage& message) {
  return impl_->poll(message);
}
tracking::TrackSourceStatus DdsAutowareReader::status() const {
  return impl_->status();
}
std::uint64_t DdsAutowareReader::overruns() const {
  return impl_->overruns();
}
std::uint64_t DdsAutowareReader::malformed() const {
  return impl_->malformed();
}

}  // namespace jink::bridge::dds
