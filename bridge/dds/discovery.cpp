// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/discovery.hpp"

#include <fastdds/rtps/reader/ReaderDiscoveryInfo.h>
#include <fastdds/rtps/writer/WriterDiscoveryInfo.h>
#include <algorithm>

namespace jink::bridge::dds {

namespace {

namespace rtps = eprosima::fastrtps::rtps;

// The policies that writers and readers have alike.
template <typename ProxyData>
DdsEndpoint endpoint_of(const ProxyData& data, bool writes) {
  const auto& qos = data.m_qos;
  DdsEndpoint endpoint;
  endpoint.writes = writes;
  endpoint.topic = data.topicName().to_string();
  endpoint.type = data.typeName().to_string();
  endpoint.reliable = qos.m_reliability.kind == dds::RELIABLE_RELIABILITY_QOS;
  endpoint.beyond_volatile = qos.m_durability.kind != dds::VOLATILE_DURABILITY_QOS;
  endpoint.deadline = qos.m_deadline.period != eprosima::fastrtps::c_TimeInfinite;
  endpoint.strict_liveliness = qos.m_liveliness.kind != dds::AUTOMATIC_LIVELINESS_QOS ||
                               qos.m_liveliness.lease_duration != eprosima::fastrtps::c_TimeInfinite;
  endpoint.exclusive = qos.m_ownership.kind == dds::EXCLUSIVE_OWNERSHIP_QOS;
  endpoint.partitions = qos.m_partition.getNames();
  return endpoint;
}

}  // namespace

std::vector<std::string> qos_mismatches(const DdsEndpoint& theirs) {
  std::vector<std::string> names;
  if (!theirs.writes) {
    if (theirs.reliable) names.push_back(policy_name(dds::RELIABILITY_QOS_POLICY_ID));
    if (theirs.beyond_volatile) names.push_back(policy_name(dds::DURABILITY_QOS_POLICY_ID));
    if (theirs.deadline) names.push_back(policy_name(dds::DEADLINE_QOS_POLICY_ID));
    if (theirs.strict_liveliness) names.push_back(policy_name(dds::LIVELINESS_QOS_POLICY_ID));
  }
  if (theirs.exclusive) names.push_back(policy_name(dds::OWNERSHIP_QOS_POLICY_ID));
  const auto& partitions = theirs.partitions;
  if (!partitions.empty() && std::find(partitions.begin(), partitions.end(), "") == partitions.end()) {
    names.push_back(policy_name(dds::PARTITION_QOS_POLICY_ID));
  }
  return names;
}

std::vector<DdsEndpoint> DdsDiscovery::endpoints() const {
  const std::scoped_lock lock(mutex_);
  std::vector<DdsEndpoint> all;
  for (const auto& [guid, endpoint] : endpoints_) {
    all.push_back(endpoint);
    all.back().participant = cdr::printable(name_of(guid.guidPrefix));
  }
  return all;
}

void DdsDiscovery::on_subscriber_discovery(dds::DomainParticipant* own, rtps::ReaderDiscoveryInfo&& info) {
  const Guid guid = info.info.guid();
  if (own != nullptr && guid.guidPrefix == own->guid().guidPrefix) return;
  const std::scoped_lock lock(mutex_);
  if (info.status == rtps::ReaderDiscoveryInfo::REMOVED_READER) {
    endpoints_.erase(guid);
  } else {
    endpoints_[guid] = endpoint_of(info.info, false);
  }
}

void DdsDiscovery::on_publisher_discovery(dds::DomainParticipant* own, rtps::WriterDiscoveryInfo&& info) {
  const Guid guid = info.info.guid();
  if (own != nullptr && guid.guidPrefix == own->guid().guidPrefix) return;
  const std::scoped_lock lock(mutex_);
  if (info.status == rtps::WriterDiscoveryInfo::REMOVED_WRITER) {
    endpoints_.erase(guid);
  } else {
    endpoints_[guid] = endpoint_of(info.info, true);
  }
}

}  // namespace jink::bridge::dds
