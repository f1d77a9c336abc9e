// SPDX-License-Identifier: BSD-3-Clause
#include "sim/mavlink/mission_protocol.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

namespace jink::sim::mavlink {
namespace {

// PX4's.
constexpr double kRetry = 0.25;                                      ///< s
constexpr double kGiveUp = 5.0;                                      ///< s
constexpr std::array<std::uint16_t, 3> kMaxItems = {10000, 64, 32};  ///< by type

constexpr std::int32_t kMaxLatitudeE7 = 900000000;
constexpr std::int32_t kMaxLongitudeE7 = 1800000000;
constexpr float kMaxHeight = 10000.0F;  ///< m

bool is_global(std::uint8_t frame) {
  return frame == MAV_FRAME_GLOBAL_INT || frame == MAV_FRAME_GLOBAL_RELATIVE_ALT_INT;
}

/// With a place: what a multicopter flies to, and what a camera would look at.
bool takes_place(std::uint16_t command) {
  switch (command) {
    case MAV_CMD_NAV_WAYPOINT:
    case MAV_CMD_NAV_LOITER_UNLIM:
    case MAV_CMD_NAV_LOITER_TIME:
    case MAV_CMD_NAV_LOITER_TO_ALT:
    case MAV_CMD_NAV_TAKEOFF:
    case MAV_CMD_NAV_LAND:
    case MAV_CMD_NAV_ROI:
    case MAV_CMD_DO_SET_ROI:
    case MAV_CMD_DO_SET_ROI_LOCATION:
      return true;
    default:
      return false;
  }
}

/// Without one. Camera and gimbal are not there: what is meant for them is passed over in flight.
bool takes_no_place(std::uint16_t command) {
  switch (command) {
    case MAV_CMD_NAV_RETURN_TO_LAUNCH:
    case MAV_CMD_NAV_DELAY:
    case MAV_CMD_DO_JUMP:
    case MAV_CMD_DO_CHANGE_SPEED:
    case MAV_CMD_DO_LAND_START:
    case MAV_CMD_NAV_ROI:
    case MAV_CMD_DO_SET_ROI:
    case MAV_CMD_DO_SET_ROI_WPNEXT_OFFSET:
    case MAV_CMD_DO_SET_ROI_NONE:
    case MAV_CMD_DO_TRIGGER_CONTROL:
    case MAV_CMD_DO_DIGICAM_CONTROL:
    case MAV_CMD_DO_CONTROL_VIDEO:
    case MAV_CMD_DO_MOUNT_CONFIGURE:
    case MAV_CMD_DO_MOUNT_CONTROL:
    case MAV_CMD_DO_GIMBAL_MANAGER_PITCHYAW:
    case MAV_CMD_DO_GIMBAL_MANAGER_CONFIGURE:
    case MAV_CMD_DO_SET_CAM_TRIGG_DIST:
    case MAV_CMD_DO_SET_CAM_TRIGG_INTERVAL:
    case MAV_CMD_SET_CAMERA_MODE:
    case MAV_CMD_SET_CAMERA_ZOOM:
    case MAV_CMD_SET_CAMERA_FOCUS:
    case MAV_CMD_IMAGE_START_CAPTURE:
    case MAV_CMD_IMAGE_STOP_CAPTURE:
    case MAV_CMD_VIDEO_START_CAPTURE:
    case MAV_CMD_VIDEO_STOP_CAPTURE:
      return true;
    default:
      return false;
  }
}

bool is_fence(std::uint16_t command) {
  return command >= MAV_CMD_NAV_FENCE_RETURN_POINT && command <= MAV_CMD_NAV_FENCE_CIRCLE_EXCLUSION;
}

bool is_polygon(std::uint16_t command) {
  return command == MAV_CMD_NAV_FENCE_POLYGON_VERTEX_INCLUSION || command == MAV_CMD_NAV_FENCE_POLYGON_VERTEX_EXCLUSION;
}

MAV_MISSION_RESULT check_command(const ListItem& item) {
  const bool place = is_global(item.frame);
  switch (item.mission_type) {
    case MAV_MISSION_TYPE_FENCE:
      if (!is_fence(item.command)) return MAV_MISSION_ERROR;
      if (is_polygon(item.command) && !(item.param1 >= 2.5F)) return MAV_MISSION_ERROR;  // not three vertices
      return place ? MAV_MISSION_ACCEPTED : MAV_MISSION_UNSUPPORTED;
    case MAV_MISSION_TYPE_RALLY:
      if (item.command != MAV_CMD_NAV_RALLY_POINT) return MAV_MISSION_ERROR;
      return place ? MAV_MISSION_ACCEPTED : MAV_MISSION_UNSUPPORTED;
    default:
      if (is_fence(item.command) || item.command == MAV_CMD_NAV_RALLY_POINT) return MAV_MISSION_ERROR;
      return (place ? takes_place(item.command) : takes_no_place(item.command)) ? MAV_MISSION_ACCEPTED
                                                                                : MAV_MISSION_UNSUPPORTED;
  }
}

/// PX4 keeps and tells every frame in the form with integers.
std::uint8_t with_integers(std::uint8_t frame) {
  if (frame == MAV_FRAME_GLOBAL) return MAV_FRAME_GLOBAL_INT;
  return frame == MAV_FRAME_GLOBAL_RELATIVE_ALT ? std::uint8_t{MAV_FRAME_GLOBAL_RELATIVE_ALT_INT} : frame;
}

std::uint8_t with_floats(std::uint8_t frame) {
  if (frame == MAV_FRAME_GLOBAL_INT) return MAV_FRAME_GLOBAL;
  return frame == MAV_FRAME_GLOBAL_RELATIVE_ALT_INT ? std::uint8_t{MAV_FRAME_GLOBAL_RELATIVE_ALT} : frame;
}

/// All fields but the two coordinates, whose type differs.
template <typename To, typename From>
To without_coordinates(const From& from) {
  To to{};
  to.param1 = from.param1;
  to.param2 = from.param2;
  to.param3 = from.param3;
  to.param4 = from.param4;
  to.z = from.z;
  to.seq = from.seq;
  to.command = from.command;
  to.target_system = from.target_system;
  to.target_component = from.target_component;
  to.frame = from.frame;
  to.current = from.current;
  to.autocontinue = from.autocontinue;
  to.mission_type = from.mission_type;
  return to;
}

mavlink_mission_item_t in_floats(const ListItem& item) {
  auto result = without_coordinates<mavlink_mission_item_t>(item);
  result.frame = with_floats(item.frame);
  const double scale = is_global(item.frame) ? kDegreesE7 : 1.0;
  result.x = static_cast<float>(item.x / scale);
  result.y = static_cast<float>(item.y / scale);
  return result;
}

/// The item, and why it cannot be read. A frame that only integers have is none here.
std::pair<ListItem, MAV_MISSION_RESULT> in_integers(const mavlink_mission_item_t& item) {
  auto result = without_coordinates<ListItem>(item);
  if (is_global(item.frame)) return {result, MAV_MISSION_UNSUPPORTED_FRAME};
  result.frame = with_integers(item.frame);
  if (!is_global(result.frame)) {
    const auto whole = [](float value) {
      return std::abs(value) < 1e9F ? static_cast<std::int32_t>(std::lround(value)) : 0;  // NaN is not
    };
    result.x = whole(item.x);
    result.y = whole(item.y);
    return {result, MAV_MISSION_ACCEPTED};
  }
  if (!(std::abs(item.x) <= 90.0F)) return {result, MAV_MISSION_INVALID_PARAM5_X};
  if (!(std::abs(item.y) <= 180.0F)) return {result, MAV_MISSION_INVALID_PARAM6_Y};
  result.x = static_cast<std::int32_t>(std::lround(static_cast<double>(item.x) * kDegreesE7));
  result.y = static_cast<std::int32_t>(std::lround(static_cast<double>(item.y) * kDegreesE7));
  return {result, MAV_MISSION_ACCEPTED};
}

bool same(const std::vector<ListItem>& a, const std::vector<ListItem>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(ListItem)) == 0);
}

}  // namespace

MAV_MISSION_RESULT check_item(const ListItem& item) {
  if (!is_global(item.frame) && item.frame != MAV_FRAME_MISSION) return MAV_MISSION_UNSUPPORTED_FRAME;
  const MAV_MISSION_RESULT command = check_command(item);
  if (command != MAV_MISSION_ACCEPTED || !is_global(item.frame)) return command;
  if (item.x < -kMaxLatitudeE7 || item.x > kMaxLatitudeE7) return MAV_MISSION_INVALID_PARAM5_X;
  if (item.y < -kMaxLongitudeE7 || item.y > kMaxLongitudeE7) return MAV_MISSION_INVALID_PARAM6_Y;
  return std::abs(item.z) <= kMaxHeight ? MAV_MISSION_ACCEPTED : MAV_MISSION_INVALID_PARAM7;  // NaN is not
}

void MissionProtocol::reset() {
  if (state_ == State::kReceiving) lists_->receiving = false;
  *this = MissionProtocol(*lists_, system_id_);
}

/// PX4 takes what is for its mission planner, too.
bool MissionProtocol::for_us(std::uint8_t system, std::uint8_t component) const {
  return system == system_id_ && (component == MAV_COMP_ID_AUTOPILOT1 || component == MAV_COMP_ID_ALL ||
                                  component == MAV_COMP_ID_MISSIONPLANNER);
}

const std::vector<ListItem>& MissionProtocol::list() const {
  static const std::vector<ListItem> none;
  return type_ < lists_->items.size() ? lists_->items[type_] : none;
}

std::vector<MissionMessage> MissionProtocol::handle(const mavlink_message_t& message, int current, double now) {
  sender_ = {message.sysid, message.compid};
  current_ = current;
  now_ = now;
  const auto with = [&](auto payload, auto decode, auto use) {
    decode(&message, &payload);
    if (for_us(payload.target_system, payload.target_component)) use(payload);
  };
  switch (message.msgid) {
    case MAVLINK_MSG_ID_MISSION_COUNT:
      with(mavlink_mission_count_t{}, mavlink_msg_mission_count_decode, [&](const auto& m) { handle_count(m); });
      break;
    case MAVLINK_MSG_ID_MISSION_ITEM_INT:
      with(ListItem{}, mavlink_msg_mission_item_int_decode, [&](ListItem item) {
        integers_ = true;
        item.frame = with_integers(item.frame);
        handle_item(item, MAV_MISSION_ACCEPTED);
      });
      break;
    case MAVLINK_MSG_ID_MISSION_ITEM:
      with(mavlink_mission_item_t{}, mavlink_msg_mission_item_decode, [&](const auto& item) {
        integers_ = false;
        const auto [converted, readable] = in_integers(item);
        handle_item(converted, readable);
      });
      break;
    case MAVLINK_MSG_ID_MISSION_REQUEST_LIST:
      with(mavlink_mission_request_list_t{}, mavlink_msg_mission_request_list_decode,
           [&](const auto& m) { handle_request_list(m); });
      break;
    case MAVLINK_MSG_ID_MISSION_REQUEST_INT:
      with(mavlink_mission_request_int_t{}, mavlink_msg_mission_request_int_decode, [&](const auto& m) {
        integers_ = true;
        handle_request(m.seq, m.mission_type);
      });
      break;
    case MAVLINK_MSG_ID_MISSION_REQUEST:
      with(mavlink_mission_request_t{}, mavlink_msg_mission_request_decode, [&](const auto& m) {
        integers_ = false;
        handle_request(m.seq, m.mission_type);
      });
      break;
    case MAVLINK_MSG_ID_MISSION_ACK:
      with(mavlink_mission_ack_t{}, mavlink_msg_mission_ack_decode, [&](const auto& m) { handle_ack(m); });
      break;
    case MAVLINK_MSG_ID_MISSION_SET_CURRENT:
      with(mavlink_mission_set_current_t{}, mavlink_msg_mission_set_current_decode,
           [&](const auto& m) { handle_set_current(m.seq); });
      break;
    case MAVLINK_MSG_ID_MISSION_CLEAR_ALL:
      with(mavlink_mission_clear_all_t{}, mavlink_msg_mission_clear_all_decode,
           [&](const auto& m) { handle_clear(m.mission_type); });
      break;
    default:
      break;
  }
  return std::exchange(answers_, {});
}

std::vector<MissionMessage> MissionProtocol::update(double now) {
  now_ = now;
  if (state_ == State::kIdle) return {};
  if (now_ - heard_ > kGiveUp) {
    report("Operation timeout");
    finish();
  } else if (state_ == State::kReceiving && now_ - sent_ > kRetry) {
    request_next();
  }
  return std::exchange(answers_, {});
}

void MissionProtocol::finish() {
  if (state_ == State::kReceiving) lists_->receiving = false;
  state_ = State::kIdle;
  items_.clear();
}

void MissionProtocol::acknowledge(MAV_MISSION_RESULT result, std::uint8_t type) {
  mavlink_mission_ack_t ack{};
  ack.target_system = sender_.system;
  ack.target_component = sender_.component;
  ack.type = static_cast<std::uint8_t>(result);
  ack.mission_type = type;
  answers_.emplace_back(ack);
}

/// As PX4, which sees whether it is another list.
void MissionProtocol::replace(std::uint8_t type, std::vector<ListItem> items, std::optional<std::uint16_t> marked) {
  if (type >= lists_->items.size() || same(lists_->items[type], items)) return;
  lists_->items[type] = std::move(items);
  if (type == MAV_MISSION_TYPE_MISSION) {
    lists_->mission_replaced = true;
    lists_->wanted_current = marked;
  }
}

void MissionProtocol::handle_count(const mavlink_mission_count_t& count) {
  switch (state_) {
    case State::kIdle:
      return receive_first(count);
    case State::kReceiving:
      if (sender_ != peer_) return acknowledge(MAV_MISSION_ERROR, count.mission_type);
      heard_ = now_;
      if (next_ == 0) return request_next();  // the first request was lost
      report("WPM: REJ. CMD: Busy");
      return acknowledge(MAV_MISSION_ERROR, count.mission_type);
    case State::kSending:
      report("WPM: IGN MISSION_COUNT: Busy");
      return acknowledge(MAV_MISSION_ERROR, count.mission_type);
  }
}

void MissionProtocol::receive_first(const mavlink_mission_count_t& count) {
  if (lists_->receiving) return acknowledge(MAV_MISSION_ERROR, count.mission_type);  // on another link
  peer_ = sender_;
  type_ = count.mission_type;
  const std::uint16_t most = type_ < kMaxItems.size() ? kMaxItems[type_] : std::uint16_t{0};
  if (count.count > most) return acknowledge(MAV_MISSION_NO_SPACE, type_);
  next_ = 0;
  count_ = count.count;
  if (count_ == 0) {
    replace(type_, {});
    return acknowledge(MAV_MISSION_ACCEPTED, type_);
  }
  state_ = State::kReceiving;
  lists_->receiving = true;
  heard_ = now_;
  items_.clear();
  marked_.reset();
  request_next();
}

void MissionProtocol::request_next() {
  sent_ = now_;
  const auto request = [&](auto message) {
    message.target_system = peer_->system;
    message.target_component = peer_->component;
    message.seq = next_;
    message.mission_type = type_;
    answers_.emplace_back(message);
  };
  if (integers_) return request(mavlink_mission_request_int_t{});
  request(mavlink_mission_request_t{});
}

void MissionProtocol::handle_item(const ListItem& item, MAV_MISSION_RESULT readable) {
  if (sender_ != peer_) return report("REJ. MIS ITEM: partner id mismatch");
  if (item.mission_type != type_) return acknowledge(MAV_MISSION_ERROR, type_);
  if (state_ == State::kIdle) {
    // The last item once more: our acknowledgement was lost.
    if (count_ > 0 && next_ == count_ && item.seq + 1 == count_) return acknowledge(MAV_MISSION_ACCEPTED, type_);
    report("IGN MISSION_ITEM: No transfer");
    return acknowledge(MAV_MISSION_ERROR, type_);
  }
  if (state_ == State::kSending) {
    report("IGN MISSION_ITEM: Busy");
    return acknowledge(MAV_MISSION_ERROR, type_);
  }
  heard_ = now_;
  if (item.seq != next_) return;  // it will be asked for again
  const MAV_MISSION_RESULT result = readable == MAV_MISSION_ACCEPTED ? check_item(item) : readable;
  if (result != MAV_MISSION_ACCEPTED) {
    report("IGN MISSION_ITEM: Invalid item");
    acknowledge(result, type_);
    return finish();
  }
  ListItem& kept = items_.emplace_back(item);
  if (kept.current != 0) marked_ = next_;
  kept.target_system = kept.target_component = kept.current = 0;
  if (++next_ < count_) return request_next();
  replace(type_, std::move(items_), marked_);
  acknowledge(MAV_MISSION_ACCEPTED, type_);
  finish();
}

void MissionProtocol::handle_request_list(const mavlink_mission_request_list_t& request) {
  const bool all_sent = state_ == State::kSending && next_ == count_;
  const bool again = state_ == State::kSending && sender_ == peer_ && request.mission_type == type_;
  if (state_ != State::kIdle && !all_sent && !again) {
    return report("Mission download request ignored, already active");
  }
  peer_ = sender_;
  type_ = request.mission_type;
  state_ = State::kSending;
  heard_ = now_;
  next_ = 0;
  count_ = static_cast<std::uint16_t>(list().size());
  mavlink_mission_count_t count{};
  count.target_system = sender_.system;
  count.target_component = sender_.component;
  count.count = count_;
  count.mission_type = type_;
  answers_.emplace_back(count);
}

void MissionProtocol::handle_request(std::uint16_t seq, std::uint8_t type) {
  if (sender_ != peer_) return report("WPM: REJ. CMD: partner id mismatch");
  if (state_ == State::kIdle) return;  // some ask without a transfer
  if (state_ == State::kReceiving) return report("WPM: REJ. CMD: Busy");
  if (type != type_) return;
  heard_ = now_;
  const bool next = seq == next_ && next_ < count_;
  const bool again = seq + 1 == next_;
  if ((!next && !again) || seq >= list().size()) {  // another link may have changed the list meanwhile
    report("WPM: REJ. CMD: Req. WP was unexpected");
    acknowledge(MAV_MISSION_ERROR, type_);
    return finish();
  }
  if (next) ++next_;
  send_item(seq);
}

void MissionProtocol::send_item(std::uint16_t seq) {
  ListItem item = list()[seq];
  item.target_system = peer_->system;
  item.target_component = peer_->component;
  item.seq = seq;
  item.current = type_ == MAV_MISSION_TYPE_MISSION && seq == current_ ? 1 : 0;
  if (integers_) {
    answers_.emplace_back(item);
  } else {
    answers_.emplace_back(in_floats(item));
  }
}

void MissionProtocol::handle_ack(const mavlink_mission_ack_t& ack) {
  if (sender_ != peer_) return report("REJ. WP CMD: partner id mismatch");
  if (state_ == State::kSending && ack.mission_type == type_) return finish();  // whatever it thinks of it
  if (state_ != State::kReceiving) return;
  heard_ = now_;
  if (ack.type == MAV_MISSION_OPERATION_CANCELLED) return finish();
  if (ack.type != MAV_MISSION_UNSUPPORTED) return;
  integers_ = !integers_;  // it speaks the other form
  request_next();
}

void MissionProtocol::handle_set_current(std::uint16_t seq) {
  if (state_ != State::kIdle) return report("WPM: IGN WP CURR CMD: Busy");
  if (seq >= lists_->mission().size()) return report("WPM: WP CURR CMD: Not in list");
  lists_->wanted_current = seq;
}

void MissionProtocol::handle_clear(std::uint8_t type) {
  if (state_ != State::kIdle) return report("WPM: IGN CLEAR CMD: Busy");
  for (std::uint8_t each = 0; each < lists_->items.size(); ++each) {
    if (type == each || type == MAV_MISSION_TYPE_ALL) replace(each, {});
  }
  acknowledge(MAV_MISSION_ACCEPTED, type);
}

}  // namespace jink::sim::mavlink
