// SPDX-License-Identifier: BSD-3-Clause
// Who is in a DDS domain: participants, their writers and readers, and whether these can meet the bridge's own. Not a
// public header.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "bridge/dds/payload_io.hpp"

namespace jink::bridge::dds {

/// A writer or reader of somebody else, as discovery tells of it.
struct DdsEndpoint {
  bool writes = false;
  std::string topic;
  std::string type;
  std::string participant;  ///< its name; "?" where it has none
  bool reliable = false;
  bool beyond_volatile = false;    ///< durability transient local and more
  bool deadline = false;           ///< a finite one
  bool strict_liveliness = false;  ///< manual, or with a finite lease
  bool exclusive = false;          ///< ownership
  std::vector<std::string> partitions;
};

/// The QoS policies, by name, by which an endpoint cannot match the bridge's own (best effort, volatile, shared
/// ownership, no partition). A writer that is reliable or transient local matches, a reader that asks for it does not.
[[nodiscard]] std::vector<std::string> qos_mismatches(const DdsEndpoint& theirs);

/// Hears of all that others have in the domain. Safe from any thread.
class DdsDiscovery final : public ParticipantNames {
 public:
  [[nodiscard]] std::vector<DdsEndpoint> endpoints() const;

  void on_subscriber_discovery(dds::DomainParticipant* own,
                               eprosima::fastrtps::rtps::ReaderDiscoveryInfo&& info) override;
  void on_publisher_discovery(dds::DomainParticipant* own,
                              eprosima::fastrtps::rtps::WriterDiscoveryInfo&& info) override;

 private:
  using Guid = eprosima::fastrtps::rtps::GUID_t;

  mutable std::mutex mutex_;  // guards endpoints_
  std::map<Guid, DdsEndpoint> endpoints_;
};

}  // namespace jink::bridge::dds
