// SPDX-License-Identifier: BSD-3-Clause
// What the bridge's DDS topics have in common, over Fast DDS: payloads in, payloads out. Samples travel as the bytes of
// the wire and each topic decodes its own, because generated code resizes a sequence to whatever length a payload
// states and lets the exceptions of that go through Fast DDS. Not a public header: only .cpp files and tests include
// it.
#pragma once

#include <fastcdr/Cdr.h>
#include <fastcdr/FastBuffer.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantListener.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/DataWriterListener.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "bridge/cdr/input.hpp"
#include "bridge/dds/participant.hpp"

namespace jink::bridge::dds {

namespace dds = eprosima::fastdds::dds;

/// One sample as it stands on the wire: encapsulation header (4 bytes), then CDR.
using Payload = std::vector<std::uint8_t>;

/// A DDS type of which only the name is known here; its samples are Payloads.
class PayloadType final : public dds::TopicDataType {
 public:
  explicit PayloadType(const std::string& name);

  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override;
  bool deserialize(eprosima::fastrtps::rtps::SerializedPayload_t* payload, void* data) override;
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override;
  void* createData() override;
  void deleteData(void* data) override;
  bool getKey(void* data, eprosima::fastrtps::rtps::InstanceHandle_t* handle, bool force_md5) override;
};

/// The names of the domain's participants, as discovery tells them: a claim of theirs, unless the domain is secured.
/// Safe from any thread.
class ParticipantNames : public dds::DomainParticipantListener {
 public:
  using Prefix = eprosima::fastrtps::rtps::GuidPrefix_t;

  /// As it is told: not for the terminal. "?" where it has none or is not known.
  [[nodiscard]] std::string name_of(const Prefix& prefix) const;
  /// Of all others, printable.
  [[nodiscard]] std::vector<std::string> all() const;

  void on_participant_discovery(dds::DomainParticipant* own,
                                eprosima::fastrtps::rtps::ParticipantDiscoveryInfo&& info) override;

 private:
  mutable std::mutex mutex_;  // guards names_
  std::map<Prefix, std::string> names_;
};

/// The participant. A topic or type that is asked for again is the same one; they live as long as the node.
class DdsParticipant::Impl {
 public:
  /// `discovery`, where given, hears of the domain's participants and endpoints; it must outlive this.
  Impl(int domain, const std::string& name, const std::filesystem::path& security = {},
       ParticipantNames* discovery = nullptr);
  ~Impl();
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;

  /// The topic of this name and type; null where the name is taken by another type of this node.
  [[nodiscard]] dds::Topic* topic(const std::string& name, const std::string& type_name);
  [[nodiscard]] dds::DomainParticipant& participant() { return *participant_; }
  [[nodiscard]] dds::Publisher& publisher() { return *publisher_; }
  [[nodiscard]] dds::Subscriber& subscriber() { return *subscriber_; }
  [[nodiscard]] int domain() const { return domain_; }
  [[nodiscard]] const ParticipantNames& names() const { return *names_; }

 private:
  int domain_;
  ParticipantNames own_names_;
  ParticipantNames* names_;
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
  std::mutex mutex_;  // guards topics_ and the making of types
  std::map<std::string, dds::Topic*> topics_;
};

/// Who wrote a sample.
struct SampleWriter {
  std::uint64_t identity = 0;            ///< stable
  ParticipantNames::Prefix participant;  ///< for ParticipantNames::name_of
};

/// Reads a topic best effort, volatile, keep last: any writer's reliability and durability matches. Payloads are handed
/// to `take` one after another, on Fast DDS's thread, with their writer; `take` must not call DDS.
class PayloadReader final : private dds::DataReaderListener {
 public:
  using Take = std::function<void(const Payload& payload, const SampleWriter& writer)>;
  static constexpr int kDepth = 64;  ///< samples of several writers that may wait for `take`

  /// @throws std::runtime_error, one line, when Fast DDS cannot make it.
  PayloadReader(DdsParticipant& node, const std::string& topic, const std::string& type_name, Take take);
  /// After it `take` is not called any more.
  ~PayloadReader() override;
  PayloadReader(const PayloadReader&) = delete;
  PayloadReader& operator=(const PayloadReader&) = delete;

  /// Matched now.
  [[nodiscard]] int writers() const { return writers_; }
  /// Why the newest writer that does not match does not, by the name of its QoS policy; empty: there was none.
  [[nodiscard]] std::string mismatch() const;

 private:
  void on_data_available(dds::DataReader* reader) override;
  void on_subscription_matched(dds::DataReader* reader, const dds::SubscriptionMatchedStatus& matched) override;
  void on_requested_incompatible_qos(dds::DataReader* reader,
                                     const dds::RequestedIncompatibleQosStatus& status) override;

  DdsParticipant::Impl& node_;
  Take take_;
  Payload sample_;  // the listener's own; reused
  std::atomic<int> writers_ = 0;
  std::atomic<std::uint32_t> mismatched_policy_ = 0;  // 0: none
  dds::DataReader* reader_ = nullptr;
};

struct WriterQos {
  bool reliable = false;
  bool transient_local = false;
  int depth = 1;
  /// Asynchronous: for messages of more than 64 KiB, which go out in fragments.
  bool large = false;
};

/// Writes a topic, keep last. Not safe for concurrent writes.
class PayloadWriter final : private dds::DataWriterListener {
 public:
  /// @throws std::runtime_error, one line, when Fast DDS cannot make it.
  PayloadWriter(DdsParticipant& node, const std::string& topic, const std::string& type_name,
                const WriterQos& qos = {});
  ~PayloadWriter() override;
  PayloadWriter(const PayloadWriter&) = delete;
  PayloadWriter& operator=(const PayloadWriter&) = delete;

  /// False when Fast DDS does not take it. With no reader there it goes nowhere.
  [[nodiscard]] bool write(const Payload& payload);
  /// `message` is of a type that fastddsgen made.
  template <typename Generated>
  [[nodiscard]] bool write_message(const Generated& message);
  /// Matched now.
  [[nodiscard]] int readers() const { return readers_; }
  /// What a PayloadReader, here or elsewhere, knows this writer by.
  [[nodiscard]] std::uint64_t identity() const;

 private:
  void on_publication_matched(dds::DataWriter* writer, const dds::PublicationMatchedStatus& matched) override;

  DdsParticipant::Impl& node_;
  Payload buffer_;  // of write_message; reused
  std::atomic<int> readers_ = 0;
  dds::DataWriter* writer_ = nullptr;
};

/// `message`, of a type that fastddsgen made, as little-endian plain CDR.
template <typename Generated>
void encode(const Generated& message, Payload& payload) {
  constexpr std::size_t kEncapsulation = 4;
  payload.resize(kEncapsulation + Generated::getCdrSerializedSize(message));
  // Signed in the library's interface.
  eprosima::fastcdr::FastBuffer buffer(reinterpret_cast<char*>(payload.data()), payload.size());  // NOLINT
  eprosima::fastcdr::Cdr cdr(buffer, eprosima::fastcdr::Cdr::LITTLE_ENDIANNESS, eprosima::fastcdr::Cdr::DDS_CDR);
  cdr.serialize_encapsulation();
  message.serialize(cdr);
  payload.resize(cdr.getSerializedDataLength());
}

template <typename Generated>
bool PayloadWriter::write_message(const Generated& message) {
  encode(message, buffer_);
  return write(buffer_);
}

/// "DURABILITY", "RELIABILITY", ...: the name of a DDS QoS policy by its number.
std::string policy_name(std::uint32_t policy_id);

/// System time, seconds since 1970: a message's stamp is of that clock, so its age needs it and not the companion's.
double system_time();

}  // namespace jink::bridge::dds
