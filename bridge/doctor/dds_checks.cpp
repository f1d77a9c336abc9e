// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/doctor/dds_checks.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <cstdio>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>

#include "bridge/cdr/cloud_messages.hpp"
#include "bridge/cdr/px4_messages.hpp"
#include "bridge/cdr/track_messages.hpp"
#include "bridge/dds/clouds.hpp"
#include "bridge/dds/discovery.hpp"
#include "bridge/dds/payload_io.hpp"
#include "bridge/dds/px4_link.hpp"
#include "bridge/dds/tracks.hpp"
#include "config/text.hpp"

namespace jink::bridge::doctor {

namespace {

constexpr double kStampTolerance_s = 1.0;
constexpr const char* kTracksDemanded =
    "the frame must be 'map' (ENU about the autopilot's local origin, or tracks.origins says where), values finite and "
    "sane, and both ends built from the same message definition";
constexpr const char* kPositionDemanded = "both ends must be built from the same message definition";
constexpr const char* kCloudDemanded =
    "clouds need points of fields x, y and z (FLOAT32 or FLOAT64) in the frame that the mission mounts (cloud.frame), "
    "'map' or 'ned', and the sensor's clock must be this machine's (chrony, PTP)";
// A stamp of less is no system time: PX4 counts from its start where its agent does not synchronise the clocks.
constexpr double kNoSystemTime_s = 1e9;

/// What one payload is worth: its stamp (0: none), what is wrong with it, and how many obstacles it holds.
struct Verdict {
  double stamp_unix_s = 0.0;
  std::string fault;
  std::optional<std::size_t> obstacles{};  ///< none: it tells of none by its kind
};
using Judge = std::function<Verdict(const dds::Payload&)>;

/// A topic that the mission reads, and what came on it.
class Probe {
 public:
  /// `demands`: what its messages have to be, where some are faulty.
  Probe(dds::DdsParticipant& node, std::string topic, const char* type, Judge judge, const char* demands)
      : topic_(std::move(topic)),
        type_(type),
        judge_(std::move(judge)),
        demands_(demands),
        reader_(node, topic_, type,
                [this](const dds::Payload& payload, const dds::SampleWriter& writer) { take(payload, writer); }) {}

  struct Seen {
    int matched = 0;
    std::size_t writers = 0;  // heard
    std::set<dds::ParticipantNames::Prefix> participants;
    std::uint64_t messages = 0;
    std::uint64_t faulty = 0;
    std::string fault;
    std::optional<std::size_t> obstacles;  // the most at once
    double rate_hz = 0.0;
    std::optional<double> stamp_age_s;  // median
  };
  Seen seen() const {
    const std::scoped_lock lock(mutex_);
    Seen s = seen_;
    s.matched = reader_.writers();
    s.writers = heard_.size();
    if (s.messages > 1 && last_ > first_) s.rate_hz = static_cast<double>(s.messages - 1) / (last_ - first_);
    if (!ages_.empty()) {
      std::vector<double> sorted = ages_;
      std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
      s.stamp_age_s = sorted[sorted.size() / 2];
    }
    return s;
  }
  [[nodiscard]] std::string mismatch() const { return reader_.mismatch(); }
  [[nodiscard]] const std::string& topic() const { return topic_; }
  [[nodiscard]] const std::string& type() const { return type_; }
  [[nodiscard]] const char* demands() const { return demands_; }

 private:
  void take(const dds::Payload& payload, const dds::SampleWriter& writer) {
    const Verdict verdict = judge_(payload);
    const double now = dds::system_time();
    const std::scoped_lock lock(mutex_);
    if (seen_.messages++ == 0) first_ = now;
    last_ = now;
    heard_.insert(writer.identity);
    seen_.participants.insert(writer.participant);
    if (verdict.obstacles) seen_.obstacles = std::max(seen_.obstacles.value_or(0), *verdict.obstacles);
    if (!verdict.fault.empty()) {
      ++seen_.faulty;
      seen_.fault = verdict.fault;
    } else if (verdict.stamp_unix_s > kNoSystemTime_s) {
      ages_.push_back(now - verdict.stamp_unix_s);
    }
  }

  std::string topic_;
  std::string type_;
  Judge judge_;
  const char* demands_;
  mutable std::mutex mutex_;  // guards the next block
  Seen seen_;
  std::set<std::uint64_t> heard_;
  std::vector<double> ages_;
  double first_ = 0.0;
  double last_ = 0.0;
  dds::PayloadReader reader_;  // last: its destruction ends the callbacks
};

Verdict judge_tracks(std::optional<tracking::DecodedTracks> message, bool ned, const config::Mission& mission,
                     config::TrackTopic topic) {
  if (!message) return {0.0, "payload of another layout"};
  const bool known = message->frame_id == "map" || (ned && message->frame_id == "ned");
  if (!known) return {message->stamp_unix_s, "frame_id '" + cdr::printable(message->frame_id) + "'"};
  message->tracks.placed = mission.tracks.origins.at(static_cast<std::size_t>(topic)).has_value();
  if (tracking::elsewhere(message->tracks, mission.geofence))
    return {message->stamp_unix_s, "all obstacles are farther beside the geofence than that is wide"};
  return {message->stamp_unix_s, message->why, message->tracks.tracks.size()};
}

Verdict judge_position(const dds::Payload& payload) {
  const auto message = cdr::px4::decode_local_position(payload);
  if (!message) return {0.0, "payload of " + std::to_string(payload.size()) + " bytes, of no version known"};
  return {static_cast<double>(message->timestamp_us) * 1e-6, {}};
}

std::string number(double value, const char* format = "%.1f") {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

/// As the reader of clouds takes them.
Verdict judge_cloud(const dds::Payload& payload, const std::string& frame) {
  using map::CloudLimits;
  const auto cloud = cdr::decode_cloud(payload);
  if (!cloud) return {0.0, "no cloud of points, or more points than " + std::to_string(CloudLimits::kPoints)};
  const double age = dds::system_time() - cloud->stamp_unix_s;
  Verdict verdict{cloud->stamp_unix_s, {}};
  if (cloud->frame_id != frame && cloud->frame_id != "map" && cloud->frame_id != "ned") {
    verdict.fault = "frame_id '" + cdr::printable(cloud->frame_id) + "'";
  } else if (cloud->points.empty()) {
    verdict.fault = "no point in it";
  } else if (age > CloudLimits::kOldest || age < -CloudLimits::kAhead) {
    verdict.fault = "stamp " + number(age, "%.3f") + " s old";
  }
  return verdict;
}

std::string count(std::size_t number_of, const std::string& what) {
  return std::to_string(number_of) + " " + what + (number_of == 1 ? "" : "s");
}

std::string joined(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : ", ") + word;
  return line;
}

/// A topic as ROS 2 names it.
std::string ros_name(const std::string& topic) {
  return topic.starts_with("rt/") ? topic.substr(2) : topic;
}

std::string last_part(const std::string& topic) {
  return topic.substr(topic.find_last_of('/') + 1);
}

/// Whether somebody may have meant `wanted` by `other`: the same but for rt/ or a slash in front, another namespace, a
/// version's suffix, or a slip of the pen.
bool near(const std::string& wanted, const std::string& other) {
  if (other.empty() || other == wanted) return false;
  const auto bare = [](std::string name) {
    if (name.starts_with("rt/")) name.erase(0, 3);
    name.erase(0, name.find_first_not_of('/'));
    const std::size_t v = name.rfind("_v");
    const bool version = v != std::string::npos && v + 2 < name.size() &&
                         name.find_first_not_of("0123456789", v + 2) == std::string::npos;
    if (version) name.erase(v);
    return name;
  };
  const std::string a = bare(wanted);
  const std::string b = bare(other);
  if (a == b || last_part(a) == last_part(b)) return true;
  const std::string_view names[] = {a};
  return !config::nearest(b, names).empty();
}

/// The domain as discovery shows it, and the words for what is not as it should be.
class Inspector {
 public:
  explicit Inspector(const config::Mission& mission)
      : domain_(mission.dds_domain),
        node_(std::make_unique<dds::DdsParticipant::Impl>(domain_, "jink doctor", mission.dds_security, &discovery_)) {}

  dds::DdsParticipant& node() { return node_; }

  void settle() {
    endpoints_ = discovery_.endpoints();
    participants_ = discovery_.all();
  }

  Check domain_check(bool needed) const {
    const std::string name = "DDS domain " + std::to_string(domain_);
    if (!participants_.empty()) {
      return {
          Check::Level::kOk, name, count(participants_.size(), "other participant") + ": " + joined(participants_), {}};
    }
    const Check::Level level = needed ? Check::Level::kMissing : Check::Level::kWarning;
    return {level, name, "no other participant", nobody_remedy()};
  }

  /// `absent`: the level where there is nobody.
  Check reader_check(const Probe& probe, Check::Level absent) const {
    const Probe::Seen seen = probe.seen();
    if (seen.messages > 0) return data_check(probe, seen);
    if (seen.matched > 0) {
      return {
          Check::Level::kFault, probe.topic(),
          count(static_cast<std::size_t>(seen.matched), "writer") + " matched, but no data",
          "if the writer does publish, the two do not share memory (containers, other users): run both with UDP only "
          "(FASTRTPS_DEFAULT_PROFILES_FILE with a UDPv4 transport and useBuiltinTransports false) or with --ipc=host"};
    }
    return peerless_check(probe.topic(), probe.type(), true, probe.mismatch(), absent);
  }

  /// Whom the mission names as writers, and who else writes.
  void name_checks(const std::vector<config::TrackWriter>& wanted, config::TrackTopic topic, const Probe& probe,
                   std::vector<Check>& checks) const {
    std::set<std::string> heard;
    for (const auto& participant : probe.seen().participants) heard.insert(discovery_.name_of(participant));
    std::set<std::string> strangers = heard;
    std::vector<std::string> shown;
    for (const std::string& name : heard) shown.push_back(printable_long(name));
    for (const config::TrackWriter& writer : wanted) {
      if (writer.topic != topic) continue;
      strangers.erase(writer.participant);
      if (heard.contains(writer.participant)) continue;
      checks.push_back({Check::Level::kMissing, probe.topic(), "nothing from '" + writer.participant + "'",
                        "start it, or correct tracks.writers: " +
                            (heard.empty() ? "nobody writes" : "who writes is " + joined(shown))});
    }
    for (const std::string& stranger : strangers) {
      checks.push_back({Check::Level::kWarning, probe.topic(),
                        "also from '" + cdr::printable(stranger) + "', which is not heard",
                        "name it in tracks.writers, or find out what it is"});
    }
  }

  /// A topic that the mission writes: who would read it.
  Check writer_check(const std::string& topic, const char* type, Check::Level absent) const {
    const auto fits = [&](const dds::DdsEndpoint& e) {
      return !e.writes && e.topic == topic && e.type == type && dds::qos_mismatches(e).empty();
    };
    const auto readers = std::count_if(endpoints_.begin(), endpoints_.end(), fits);
    if (readers > 0) return {Check::Level::kOk, topic, count(static_cast<std::size_t>(readers), "reader"), {}};
    return peerless_check(topic, type, false, {}, absent);
  }

 private:
  std::string nobody_remedy() const {
    if (std::string trouble = dds::discovery_trouble(domain_); !trouble.empty()) return trouble;
    return "start the other side in this domain (ROS_DOMAIN_ID=" + std::to_string(domain_) +
           ", or dds.domain in the mission); multicast must pass (firewall, Wi-Fi, container networks), and "
           "ROS_LOCALHOST_ONLY must not be set on another machine";
  }

  static Check data_check(const Probe& probe, const Probe::Seen& seen) {
    std::string finding = count(seen.writers, "writer") + ", " + number(seen.rate_hz) + " Hz";
    if (seen.faulty > 0) {
      return {Check::Level::kFault, probe.topic(),
              finding + ", " + std::to_string(seen.faulty) + " of " + std::to_string(seen.messages) +
                  " messages not usable: " + seen.fault,
              probe.demands()};
    }
    finding += seen.stamp_age_s ? ", stamps " + number(*seen.stamp_age_s, "%.3f") + " s old"
                                : std::string(", stamps are not system time");
    if (seen.stamp_age_s && std::abs(*seen.stamp_age_s) > kStampTolerance_s) {
      return {Check::Level::kWarning, probe.topic(), finding,
              "the writer's clock differs from this machine's, or its data are late: synchronise them (chrony, PTP)"};
    }
    if (seen.obstacles == 0) {
      return {Check::Level::kWarning, probe.topic(), finding + ", no obstacle in them",
              "an empty scene and a blind tracker look the same: put something into its view"};
    }
    return {Check::Level::kOk, probe.topic(), finding, {}};
  }

  // Nobody matches. Why not, as far as discovery tells.
  Check peerless_check(const std::string& topic, const std::string& type, bool they_write, const std::string& mismatch,
                       Check::Level absent) const {
    const std::string who = they_write ? "writer" : "reader";
    for (const dds::DdsEndpoint& e : endpoints_) {
      if (e.writes != they_write || e.topic != topic) continue;
      if (e.type != type) {
        return {Check::Level::kFault, topic,
                "a " + who + " (" + e.participant + ") with type " + printable_long(e.type),
                "the type must be " + type};
      }
      const std::vector<std::string> policies = dds::qos_mismatches(e);
      if (!policies.empty()) {
        return {Check::Level::kFault, topic,
                "a " + who + " (" + e.participant + ") does not match: QoS policy " + joined(policies),
                "jink " + std::string(they_write ? "reads" : "writes") +
                    " best effort, volatile, shared ownership, no deadline, no partition"};
      }
    }
    if (!mismatch.empty()) return {Check::Level::kFault, topic, mismatch, "change that policy of the writer"};
    Check near_match = near_check(topic, type, they_write, absent);
    if (!near_match.finding.empty()) return near_match;
    return {absent, topic, "no " + who,
            participants_.empty() ? nobody_remedy()
                                  : "start what " + std::string(they_write ? "publishes" : "reads") +
                                        " it (ROS 2: " + ros_name(topic) + ")"};
  }

  // The same type elsewhere before a similar name. An empty finding where there is neither.
  Check near_check(const std::string& topic, const std::string& type, bool they_write, Check::Level absent) const {
    for (const bool by_type : {true, false}) {
      for (const dds::DdsEndpoint& e : endpoints_) {
        const bool same = by_type ? e.type == type && e.topic != topic : near(topic, e.topic);
        if (e.writes != they_write || !same) continue;
        std::string remedy = "it has to be " + topic + " (ROS 2: " + ros_name(topic) + ")";
        if (!e.topic.starts_with("rt/")) remedy += "; ROS 2 topics have rt/ in front on DDS";
        if (topic.find("/fmu/") != std::string::npos) remedy += "; dds.namespace in the mission is the agent's (-n)";
        return {absent, topic,
                std::string("no ") + (they_write ? "writer" : "reader") + ", but " + e.participant + " has " +
                    printable_long(e.topic) + " of type " + printable_long(e.type),
                remedy};
      }
    }
    return {};
  }

  // printable() in full: names of topics and types are no longer than 255 characters.
  static std::string printable_long(std::string text) {
    for (char& c : text) {
      if (c < ' ' || c > '~') c = '?';
    }
    return text;
  }

  int domain_;
  dds::DdsDiscovery discovery_;  // outlives node_
  dds::DdsParticipant node_;
  std::vector<dds::DdsEndpoint> endpoints_;
  std::vector<std::string> participants_;
};

/// One check out of those of alternative topics, of which one is enough: all that work, else all.
void add_alternatives(std::vector<Check>& checks, std::vector<Check> alternatives) {
  const auto idle = [](const Check& c) { return c.level == Check::Level::kMissing; };
  const bool all_idle = std::all_of(alternatives.begin(), alternatives.end(), idle);
  for (Check& check : alternatives) {
    if (idle(check) && !all_idle) {
      check.level = Check::Level::kOk;
      check.finding += "; another source speaks";
      check.remedy.clear();
    }
    checks.push_back(std::move(check));
  }
}

}  // namespace

std::vector<Check> inspect_dds(const config::Mission& mission, double seconds, const std::stop_token& stop) {
  Inspector inspector(mission);
  std::vector<std::unique_ptr<Probe>> tracks;
  std::vector<std::unique_ptr<Probe>> clouds;
  std::vector<std::unique_ptr<Probe>> positions;
  const auto add = [&](auto& probes, const std::string& topic, const char* type, Judge judge, const char* demands) {
    probes.push_back(std::make_unique<Probe>(inspector.node(), topic, type, std::move(judge), demands));
  };
  const auto px4_name = [&](const char* name) { return dds::px4_topic(mission.dds_namespace, name); };
  for (const config::TrackTopic topic : config::kTrackTopics) {
    if (!mission.tracks.sources.has(topic)) continue;
    const auto format = static_cast<dds::TrackFormat>(topic);
    const dds::TrackTopicInfo& info = dds::track_topic_info(format);
    add(
        tracks, dds::track_topic(format, mission.tracks.name_space), info.type,
        [&mission, &info, topic](const dds::Payload& payload) {
          return judge_tracks(info.decode(payload), info.ned, mission, topic);
        },
        kTracksDemanded);
  }
  if (mission.cloud) {
    add(
        clouds, dds::cloud_topic(mission.tracks.name_space), dds::kCloudType,
        [&mission](const dds::Payload& payload) { return judge_cloud(payload, mission.cloud->frame); }, kCloudDemanded);
  }
  if (mission.state == config::Transport::kDds) {
    add(positions, px4_name(dds::kLocalPositionTopicV1), dds::kLocalPositionType, judge_position, kPositionDemanded);
    add(positions, px4_name(dds::kLocalPositionTopic), dds::kLocalPositionType, judge_position, kPositionDemanded);
  }
  std::mutex waiting;
  std::unique_lock lock(waiting);
  std::condition_variable_any interrupt;
  interrupt.wait_for(lock, stop, std::chrono::duration<double>(seconds), [] { return false; });
  inspector.settle();

  const bool setpoints = mission.setpoints == config::Transport::kDds;
  const bool needed = (mission.tracks.required && !tracks.empty()) || !positions.empty() || setpoints || mission.cloud;
  std::vector<Check> checks{inspector.domain_check(needed)};
  const auto levels = [&](const auto& probes) {
    std::vector<Check> found;
    found.reserve(probes.size());
    for (const auto& probe : probes) found.push_back(inspector.reader_check(*probe, Check::Level::kMissing));
    return found;
  };
  std::vector<Check> of_tracks;
  add_alternatives(of_tracks, levels(tracks));
  for (Check& check : of_tracks) {
    if (check.level == Check::Level::kMissing && !mission.tracks.required) check.level = Check::Level::kWarning;
    checks.push_back(std::move(check));
  }
  if (!mission.tracks.writers.empty()) {
    std::size_t probe = 0;
    for (const config::TrackTopic topic : config::kTrackTopics) {
      if (mission.tracks.sources.has(topic))
        inspector.name_checks(mission.tracks.writers, topic, *tracks[probe++], checks);
    }
  }
  for (Check& check : levels(clouds)) checks.push_back(std::move(check));
  add_alternatives(checks, levels(positions));
  std::size_t writers = 0;
  for (const auto& probe : positions) writers += probe->seen().writers;
  if (writers > 1) {
    checks.push_back({Check::Level::kWarning, "vehicle_local_position", std::to_string(writers) + " writers",
                      "give each autopilot's agent a namespace of its own (-n) and name it in dds.namespace; with a "
                      "message translation node alone it is the same position twice"});
  }
  if (setpoints) {
    checks.push_back(inspector.writer_check(px4_name(dds::kTrajectorySetpointTopic), dds::kTrajectorySetpointType,
                                            Check::Level::kMissing));
    checks.push_back(inspector.writer_check(px4_name(dds::kOffboardControlModeTopic), dds::kOffboardControlModeType,
                                            Check::Level::kMissing));
  }
  return checks;
}

}  // namespace jink::bridge::doctor
