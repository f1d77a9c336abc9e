// SPDX-License-Identifier: BSD-3-Clause
// One place in a DDS domain: what all readers and writers of a process share, so that the domain sees one participant
// and its discovery is paid for once. What is made on it is private to the bridge (dds_support).
#pragma once

#include <filesystem>
#include <memory>
#include <string>

namespace jink::bridge::dds {

inline constexpr int kMaxDdsDomain = 232;  ///< the port formula of DDS ends there

/// Why participants of this domain cannot find each other by multicast on this machine, one line: another program holds
/// the UDP port on which they would (RTPS 2.2, 9.6.1.1). Fast DDS says nothing then. Empty where it is free or shared.
[[nodiscard]] std::string discovery_trouble(int domain);

/// Over UDP and shared memory with plain multicast discovery; a profile in FASTRTPS_DEFAULT_PROFILES_FILE may say
/// otherwise. Safe from any thread. It must outlive what is made on it.
class DdsParticipant {
 public:
  /// Returns at once; discovery goes on in the background. `name` is what other tools show. `security`: a folder of
  /// keys as SROS 2 lays out an enclave's (OMG DDS Security 1.1): what its governance says is authenticated and
  /// encrypted, and whom it does not let in is not seen. Empty: none.
  /// @throws std::runtime_error, one line, for a domain outside [0, 232], keys that are not valid, or when Fast DDS
  /// cannot open its transports.
  explicit DdsParticipant(int domain, const std::string& name = "jink", const std::filesystem::path& security = {});
  ~DdsParticipant();
  DdsParticipant(const DdsParticipant&) = delete;
  DdsParticipant& operator=(const DdsParticipant&) = delete;

  [[nodiscard]] int domain() const;

  class Impl;  ///< bridge/dds/payload_io.hpp
  /// For what watches discovery itself (dds_discovery).
  explicit DdsParticipant(std::unique_ptr<Impl> impl);
  [[nodiscard]] Impl& impl() { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace jink::bridge::dds
