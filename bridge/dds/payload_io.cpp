// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/dds/payload_io.hpp"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <fastdds/rtps/participant/ParticipantDiscoveryInfo.h>
#include <fastrtps/attributes/LibrarySettingsAttributes.h>
#include <fastrtps/xmlparser/XMLProfileManager.h>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/Topic.hpp>
#include <stdexcept>
#include <utility>

namespace jink::bridge::dds {

namespace {

namespace rtps = eprosima::fastrtps::rtps;

// OMG DDS Security 1.1, the built-in plugins; file names as SROS 2 has them.
void secure(dds::DomainParticipantQos& qos, const std::filesystem::path& folder) {
  auto& properties = qos.properties().properties();
  const auto file = [&](const char* name) { return "file://" + (folder / name).string(); };
  const std::string authentication = "dds.sec.auth.builtin.PKI-DH.";
  const std::string access = "dds.sec.access.builtin.Access-Permissions.";
  properties.emplace_back("dds.sec.auth.plugin", "builtin.PKI-DH");
  properties.emplace_back(authentication + "identity_ca", file("identity_ca.cert.pem"));
  properties.emplace_back(authentication + "identity_certificate", file("cert.pem"));
  properties.emplace_back(authentication + "private_key", file("key.pem"));
  properties.emplace_back("dds.sec.access.plugin", "builtin.Access-Permissions");
  properties.emplace_back(access + "permissions_ca", file("permissions_ca.cert.pem"));
  properties.emplace_back(access + "governance", file("governance.p7s"));
  properties.emplace_back(access + "permissions", file("permissions.p7s"));
  properties.emplace_back("dds.sec.crypto.plugin", "builtin.AES-GCM-GMAC");
}

// A burst of fragments; Linux gives what net.core.*mem_max allows.
constexpr std::uint32_t kSocketBuffer_bytes = 1 << 20;
// What a sample's memory is made for at first; it grows with the samples.
constexpr std::uint32_t kFirstPayload_bytes = 512;

[[noreturn]] void fail(const std::string& what, const std::string& topic) {
  throw std::runtime_error("DDS " + what + " of " + topic + " cannot be made");
}

std::uint64_t identity_of(const eprosima::fastrtps::rtps::GUID_t& guid) {
  return cdr::fnv1a(guid.entityId.value, cdr::fnv1a(guid.guidPrefix.value));
}

}  // namespace

PayloadType::PayloadType(const std::string& name) {
  setName(name.c_str());
  m_typeSize = kFirstPayload_bytes;
}

bool PayloadType::serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) {
  const Payload& bytes = *static_cast<const Payload*>(data);
  if (bytes.size() < 4 || bytes.size() > payload->max_size) return false;
  std::memcpy(payload->data, bytes.data(), bytes.size());
  payload->length = static_cast<std::uint32_t>(bytes.size());
  payload->encapsulation = bytes[1] == 0 ? CDR_BE : CDR_LE;
  return true;
}

bool PayloadType::deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) {
  static_cast<Payload*>(data)->assign(payload->data, payload->data + payload->length);
  return true;
}

std::function<std::uint32_t()> PayloadType::getSerializedSizeProvider(void* data) {
  return [data] { return static_cast<std::uint32_t>(static_cast<const Payload*>(data)->size()); };
}

void* PayloadType::createData() {
  return new Payload;  // NOLINT: the library's interface; deleteData takes it back
}

void PayloadType::deleteData(void* data) {
  delete static_cast<Payload*>(data);  // NOLINT
}

bool PayloadType::getKey(void* /*data*/, eprosima::fastrtps::rtps::InstanceHandle_t* /*handle*/, bool /*force_md5*/) {
  return false;  // no keys in ROS 2's types
}

std::string discovery_trouble(int domain) {
  constexpr int kPortBase = 7400;
  constexpr int kPortsPerDomain = 250;
  sockaddr_in where{};
  where.sin_family = AF_INET;
  where.sin_port = htons(static_cast<std::uint16_t>(kPortBase + kPortsPerDomain * domain));
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (socket < 0) return {};
  // Participants share the port, so it can be had beside them.
  const int yes = 1;
  (void)::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  const bool taken = ::bind(socket, reinterpret_cast<const sockaddr*>(&where), sizeof where) != 0 &&  // NOLINT
                     errno == EADDRINUSE;
  ::close(socket);
  if (!taken) return {};
  return "another program holds UDP port " + std::to_string(ntohs(where.sin_port)) +
         ", on which the participants of DDS " + "domain " + std::to_string(domain) +
         " find each other; end it (ss -ulpn), or take a domain from 0 to 101, whose " +
         "ports Linux gives to nobody who does not ask for them";
}

std::string ParticipantNames::name_of(const Prefix& prefix) const {
  const std::scoped_lock lock(mutex_);
  const auto known = names_.find(prefix);
  return known == names_.end() ? "?" : known->second;
}

std::vector<std::string> ParticipantNames::all() const {
  const std::scoped_lock lock(mutex_);
  std::vector<std::string> names;
  for (const auto& [prefix, name] : names_) names.push_back(cdr::printable(name));
  return names;
}

void ParticipantNames::on_participant_discovery(dds::DomainParticipant* own, rtps::ParticipantDiscoveryInfo&& info) {
  const Prefix prefix = info.info.m_guid.guidPrefix;
  if (own != nullptr && prefix == own->guid().guidPrefix) return;
  const std::scoped_lock lock(mutex_);
  if (info.status == rtps::ParticipantDiscoveryInfo::REMOVED_PARTICIPANT ||
      info.status == rtps::ParticipantDiscoveryInfo::DROPPED_PARTICIPANT) {
    names_.erase(prefix);
    return;
  }
  const std::string name = info.info.m_participantName.to_string();
  names_[prefix] = name.empty() ? "?" : name;
}

namespace {

// Fast DDS 2.9 calls the readers of the same process itself, also one that is being matched by then: once in some
// hundred times a participant that ended beside another one crashed, in StatefulWriter::intraprocess_gap.
void send_to_own_process_as_to_others() {
  using eprosima::fastrtps::xmlparser::XMLProfileManager;
  eprosima::fastrtps::LibrarySettingsAttributes settings = XMLProfileManager::library_settings();
  settings.intraprocess_delivery = eprosima::fastrtps::INTRAPROCESS_OFF;
  XMLProfileManager::library_settings(settings);
}

}  // namespace

DdsParticipant::Impl::Impl(int domain, const std::string& name, const std::filesystem::path& security,
                           ParticipantNames* discovery)
    : domain_(domain), names_(discovery != nullptr ? discovery : &own_names_) {
  if (domain < 0 || domain > kMaxDdsDomain) {
    throw std::runtime_error("dds.domain " + std::to_string(domain) + " is outside [0, 232]");
  }
  auto* factory = dds::DomainParticipantFactory::get_instance();
  factory->load_profiles();  // a user's own transports, by FASTRTPS_DEFAULT_PROFILES_FILE
  send_to_own_process_as_to_others();
  dds::DomainParticipantQos qos = factory->get_default_participant_qos();
  qos.name(name);
  auto& transport = qos.transport();
  if (transport.listen_socket_buffer_size == 0) transport.listen_socket_buffer_size = kSocketBuffer_bytes;
  if (transport.send_socket_buffer_size == 0) transport.send_socket_buffer_size = kSocketBuffer_bytes;
  if (!security.empty()) secure(qos, security);
  participant_ = factory->create_participant(static_cast<dds::DomainId_t>(domain), qos, names_,
                                             dds::StatusMask::none());  // samples and matches are the endpoints' own
  if (participant_ != nullptr) {
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  if (publisher_ == nullptr || subscriber_ == nullptr) {
    if (participant_ != nullptr) {
      participant_->delete_contained_entities();
      factory->delete_participant(participant_);
    }
    throw std::runtime_error("DDS domain " + std::to_string(domain) + ": Fast DDS cannot open its transports" +
                             (security.empty() ? "" : ", or takes the keys in " + security.string() + " for none"));
  }
}

DdsParticipant::Impl::~Impl() {
  participant_->delete_contained_entities();
  dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
}

dds::Topic* DdsParticipant::Impl::topic(const std::string& name, const std::string& type_name) {
  const std::scoped_lock lock(mutex_);
  if (const auto known = topics_.find(name); known != topics_.end()) {
    return known->second->get_type_name() == type_name ? known->second : nullptr;
  }
  if (participant_->find_type(type_name).empty())
    dds::TypeSupport(new PayloadType(type_name)).register_type(participant_);
  dds::Topic* topic = participant_->create_topic(name, type_name, dds::TOPIC_QOS_DEFAULT);
  if (topic != nullptr) topics_.emplace(name, topic);
  return topic;
}

DdsParticipant::DdsParticipant(int domain, const std::string& name, const std::filesystem::path& security)
    : impl_(std::make_unique<Impl>(domain, name, security)) {}
DdsParticipant::DdsParticipant(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DdsParticipant::~DdsParticipant() = default;
int DdsParticipant::domain() const {
  return impl_->domain();
}

PayloadReader::PayloadReader(DdsParticipant& node, const std::string& topic, const std::string& type_name, Take take)
    : node_(node.impl()), take_(std::move(take)) {
  dds::DataReaderQos qos = dds::DATAREADER_QOS_DEFAULT;
  qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = kDepth;
  // Types without a bound: the payload grows with the message.
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  if (dds::Topic* made = node_.topic(topic, type_name); made != nullptr) {
    reader_ = node_.subscriber().create_datareader(made, qos, this);
  }
  if (reader_ == nullptr) fail("reader", topic);
}

PayloadReader::~PayloadReader() {
  node_.subscriber().delete_datareader(reader_);
}

std::string PayloadReader::mismatch() const {
  const std::uint32_t policy = mismatched_policy_;
  return policy == 0 ? std::string() : "a writer with an incompatible QoS (" + policy_name(policy) + ")";
}

void PayloadReader::on_data_available(dds::DataReader* reader) {
  dds::SampleInfo info;
  while (reader->take_next_sample(&sample_, &info) == ReturnCode_t::RETCODE_OK) {
    if (!info.valid_data) continue;
    const auto& writer = info.sample_identity.writer_guid();
    take_(sample_, {identity_of(writer), writer.guidPrefix});
  }
}

void PayloadReader::on_subscription_matched(dds::DataReader* /*reader*/,
                                            const dds::SubscriptionMatchedStatus& matched) {
  writers_ = matched.current_count;
}

void PayloadReader::on_requested_incompatible_qos(dds::DataReader* /*reader*/,
                                                  const dds::RequestedIncompatibleQosStatus& status) {
  mismatched_policy_ = status.last_policy_id;
}

PayloadWriter::PayloadWriter(DdsParticipant& node, const std::string& topic, const std::string& type_name,
                             const WriterQos& wanted)
    : node_(node.impl()) {
  dds::DataWriterQos qos = dds::DATAWRITER_QOS_DEFAULT;
  qos.reliability().kind = wanted.reliable ? dds::RELIABLE_RELIABILITY_QOS : dds::BEST_EFFORT_RELIABILITY_QOS;
  qos.durability().kind = wanted.transient_local ? dds::TRANSIENT_LOCAL_DURABILITY_QOS : dds::VOLATILE_DURABILITY_QOS;
  qos.history().kind = dds::KEEP_LAST_HISTORY_QOS;
  qos.history().depth = wanted.depth;
  qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
  // What does not fit one datagram goes out in fragments, which Fast DDS sends asynchronously only.
  if (wanted.large) qos.publish_mode().kind = dds::ASYNCHRONOUS_PUBLISH_MODE;
  if (dds::Topic* made = node_.topic(topic, type_name); made != nullptr) {
    writer_ = node_.publisher().create_datawriter(made, qos, this);
  }
  if (writer_ == nullptr) fail("writer", topic);
}

PayloadWriter::~PayloadWriter() {
  node_.publisher().delete_datawriter(writer_);
}

bool PayloadWriter::write(const Payload& payload) {
  return writer_->write(const_cast<Payload*>(&payload));  // NOLINT: the library's interface; it only reads
}

std::uint64_t PayloadWriter::identity() const {
  return identity_of(writer_->guid());
}

void PayloadWriter::on_publication_matched(dds::DataWriter* /*writer*/, const dds::PublicationMatchedStatus& matched) {
  readers_ = matched.current_count;
}

std::string policy_name(std::uint32_t policy_id) {
  switch (policy_id) {
    case dds::DURABILITY_QOS_POLICY_ID:
      return "DURABILITY";
    case dds::PRESENTATION_QOS_POLICY_ID:
      return "PRESENTATION";
    case dds::DEADLINE_QOS_POLICY_ID:
      return "DEADLINE";
    case dds::LATENCYBUDGET_QOS_POLICY_ID:
      return "LATENCY_BUDGET";
    case dds::OWNERSHIP_QOS_POLICY_ID:
      return "OWNERSHIP";
    case dds::LIVELINESS_QOS_POLICY_ID:
      return "LIVELINESS";
    case dds::PARTITION_QOS_POLICY_ID:
      return "PARTITION";
    case dds::RELIABILITY_QOS_POLICY_ID:
      return "RELIABILITY";
    case dds::DESTINATIONORDER_QOS_POLICY_ID:
      return "DESTINATION_ORDER";
    case dds::DATAREPRESENTATION_QOS_POLICY_ID:
      return "DATA_REPRESENTATION";
    case dds::TYPECONSISTENCYENFORCEMENT_QOS_POLICY_ID:
      return "TYPE_CONSISTENCY_ENFORCEMENT";
    case dds::DISABLEPOSITIVEACKS_QOS_POLICY_ID:
      return "DISABLE_POSITIVE_ACKS";
    default:
      return "policy " + std::to_string(policy_id);
  }
}

double system_time() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

}  // namespace jink::bridge::dds
