// SPDX-License-Identifier: BSD-3-Clause
// Files and logs, of which there are none: every request is answered at once, as PX4 answers it on an empty card that
// is write-protected, so that no client waits for its time-out.
#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include "sim/mavlink/endpoint_impl.hpp"

namespace jink::sim::mavlink {
namespace {

// MAVLink FTP's header, inside of FILE_TRANSFER_PROTOCOL.payload; the data follow it.
constexpr std::size_t kSequence = 0;  // two bytes, little-endian
constexpr std::size_t kOpcode = 3;
constexpr std::size_t kSize = 4;
constexpr std::size_t kRequestOpcode = 5;
constexpr std::size_t kData = 12;
constexpr std::size_t kMaxData = 239;

using FilePayload = std::array<std::uint8_t, kData + kMaxData>;

std::string_view path(const FilePayload& payload) {
  const auto* text = reinterpret_cast<const char*>(payload.data() + kData);  // NOLINT: characters on the wire
  const std::string_view all(text, payload[kSize]);
  return all.substr(0, all.find('\0'));
}

/// None: it is granted.
MAV_FTP_ERR refusal(const FilePayload& payload) {
  if (payload[kSize] > kMaxData) return MAV_FTP_ERR_INVALIDDATASIZE;
  switch (payload[kOpcode]) {
    case MAV_FTP_OPCODE_NONE:
    case MAV_FTP_OPCODE_RESETSESSION:
      return MAV_FTP_ERR_NONE;
    case MAV_FTP_OPCODE_TERMINATESESSION:
    case MAV_FTP_OPCODE_READFILE:
    case MAV_FTP_OPCODE_WRITEFILE:
    case MAV_FTP_OPCODE_BURSTREADFILE:
      return MAV_FTP_ERR_INVALIDSESSION;
    case MAV_FTP_OPCODE_LISTDIRECTORY:  // the root is there, and empty
      return path(payload).empty() || path(payload) == "/" ? MAV_FTP_ERR_EOF : MAV_FTP_ERR_FILENOTFOUND;
    case MAV_FTP_OPCODE_OPENFILERO:
    case MAV_FTP_OPCODE_REMOVEFILE:
    case MAV_FTP_OPCODE_REMOVEDIRECTORY:
    case MAV_FTP_OPCODE_TRUNCATEFILE:
    case MAV_FTP_OPCODE_RENAME:
    case MAV_FTP_OPCODE_CALCFILECRC:
      return MAV_FTP_ERR_FILENOTFOUND;
    case MAV_FTP_OPCODE_CREATEFILE:
    case MAV_FTP_OPCODE_CREATEDIRECTORY:
    case MAV_FTP_OPCODE_OPENFILEWO:
      return MAV_FTP_ERR_FILEPROTECTED;
    default:
      return MAV_FTP_ERR_UNKNOWNCOMMAND;
  }
}

}  // namespace

void MavlinkEndpoint::Impl::handle_file_transfer(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_file_transfer_protocol_t fields;
  mavlink_msg_file_transfer_protocol_decode(&message, &fields);
  const bool any_component = fields.target_component == MAV_COMP_ID_ALL;
  if (!(fields.target_system == 0 && any_component) && !for_us(fields.target_system, fields.target_component)) return;
  FilePayload payload;
  std::memcpy(payload.data(), fields.payload, payload.size());
  if (payload[kOpcode] >= MAV_FTP_OPCODE_ACK) return;  // an answer
  const MAV_FTP_ERR error = refusal(payload);
  if (++payload[kSequence] == 0) ++payload[kSequence + 1];
  payload[kRequestOpcode] = payload[kOpcode];
  payload[kOpcode] = error == MAV_FTP_ERR_NONE ? MAV_FTP_OPCODE_ACK : MAV_FTP_OPCODE_NAK;
  payload[kSize] = error == MAV_FTP_ERR_NONE ? 0 : 1;
  std::fill(payload.begin() + kData, payload.end(), std::uint8_t{0});
  payload[kData] = static_cast<std::uint8_t>(error);
  std::memcpy(fields.payload, payload.data(), payload.size());
  fields.target_network = 0;
  fields.target_system = message.sysid;
  fields.target_component = message.compid;
  link.send(mavlink_msg_file_transfer_protocol_encode_status, fields);
}

/// One entry that says that there is none.
void MavlinkEndpoint::Impl::handle_log_list(MavlinkLink& link, const mavlink_message_t& message) {
  mavlink_log_request_list_t request;
  mavlink_msg_log_request_list_decode(&message, &request);
  if (for_us(request.target_system, request.target_component)) link.send(mavlink_msg_log_entry_encode_status, {});
}

}  // namespace jink::sim::mavlink
