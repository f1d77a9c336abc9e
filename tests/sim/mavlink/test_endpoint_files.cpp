// SPDX-License-Identifier: BSD-3-Clause
// Requests for files and logs: there are none, and that is said at once.
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>

#include "tests/sim/mavlink/endpoint_fixture.hpp"

namespace jink::sim::mavlink {
namespace {

/// MAVLink FTP's answer, of which these tests read the header and the error.
struct FileAnswer {
  int sequence = 0;
  int opcode = 0;
  int request_opcode = 0;
  int error = 0;
};

class FileRequests : public MavlinkEndpointTest {
 protected:
  FileAnswer ask(int opcode, const std::string& path, int size = -1, std::uint16_t sequence = 7) {
    mavlink_file_transfer_protocol_t message{};
    message.target_system = message.target_component = 1;
    message.payload[0] = static_cast<std::uint8_t>(sequence & 0xFFU);
    message.payload[1] = static_cast<std::uint8_t>(sequence >> 8U);
    message.payload[3] = static_cast<std::uint8_t>(opcode);
    message.payload[4] = static_cast<std::uint8_t>(size < 0 ? static_cast<int>(path.size()) : size);
    std::memcpy(message.payload + 12, path.data(), path.size());
    heard.clear();
    tell(mavlink_msg_file_transfer_protocol_encode_status, message);
    poll();
    mavlink_file_transfer_protocol_t answer;
    mavlink_msg_file_transfer_protocol_decode(&last(MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL), &answer);
    EXPECT_EQ(answer.target_system, kClientSystem);
    EXPECT_EQ(answer.target_component, kClientComponent);
    const std::uint8_t* p = answer.payload;
    return {p[0] + 256 * p[1], p[3], p[5], p[4] == 1 ? p[12] : 0};
  }
};

TEST_F(FileRequests, AreAnsweredAsOnAnEmptyWriteProtectedCard) {
  const FileAnswer listing = ask(MAV_FTP_OPCODE_LISTDIRECTORY, "/fs/microsd/log", -1, 255);
  EXPECT_EQ(listing.sequence, 256);
  EXPECT_EQ(listing.opcode, MAV_FTP_OPCODE_NAK);
  EXPECT_EQ(listing.request_opcode, MAV_FTP_OPCODE_LISTDIRECTORY);
  EXPECT_EQ(listing.error, MAV_FTP_ERR_FILENOTFOUND);
  EXPECT_EQ(ask(MAV_FTP_OPCODE_LISTDIRECTORY, "/").error, MAV_FTP_ERR_EOF);
  EXPECT_EQ(ask(MAV_FTP_OPCODE_OPENFILERO, "/etc/extras/component_general.json.xz").error, MAV_FTP_ERR_FILENOTFOUND);
  EXPECT_EQ(ask(MAV_FTP_OPCODE_CREATEFILE, "/a").error, MAV_FTP_ERR_FILEPROTECTED);
  EXPECT_EQ(ask(MAV_FTP_OPCODE_READFILE, "").error, MAV_FTP_ERR_INVALIDSESSION);
  EXPECT_EQ(ask(77, "").error, MAV_FTP_ERR_UNKNOWNCOMMAND);
  EXPECT_EQ(ask(MAV_FTP_OPCODE_LISTDIRECTORY, "/", 240).error, MAV_FTP_ERR_INVALIDDATASIZE);
  EXPECT_EQ(ask(MAV_FTP_OPCODE_RESETSESSION, "").opcode, MAV_FTP_OPCODE_ACK);
}

TEST_F(FileRequests, ThatAreAnswersOrForOthersAreLeftAlone) {
  mavlink_file_transfer_protocol_t message{};
  message.target_system = message.target_component = 1;
  message.payload[3] = MAV_FTP_OPCODE_NAK;
  tell(mavlink_msg_file_transfer_protocol_encode_status, message);
  message.payload[3] = MAV_FTP_OPCODE_LISTDIRECTORY;
  message.target_system = 2;
  tell(mavlink_msg_file_transfer_protocol_encode_status, message);
  poll();
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_FILE_TRANSFER_PROTOCOL), 0U);
}

TEST_F(MavlinkEndpointTest, TheListOfLogsIsEmptyAtOnce) {
  mavlink_log_request_list_t request{};
  request.target_system = request.target_component = 1;
  request.end = 0xFFFF;
  tell(mavlink_msg_log_request_list_encode_status, request);
  poll();
  EXPECT_EQ(count(heard, MAVLINK_MSG_ID_LOG_ENTRY), 1U);
  EXPECT_EQ(mavlink_msg_log_entry_get_num_logs(&last(MAVLINK_MSG_ID_LOG_ENTRY)), 0);
}

}  // namespace
}  // namespace jink::sim::mavlink
