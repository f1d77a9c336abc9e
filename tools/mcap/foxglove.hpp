// SPDX-License-Identifier: BSD-3-Clause
// Foxglove's message schemas, as far as a flight needs them, and their messages as JSON. Field names, meanings and
// enumeration values: https://docs.foxglove.dev/docs/visualization/message-schemas/introduction
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tools/base/json_writer.hpp"
#include "tools/report/convex_hull.hpp"

namespace jink::tools::mcap::foxglove {

/// The JSON schema of "foxglove.SceneUpdate", "foxglove.PoseInFrame", "foxglove.PosesInFrame",
/// "foxglove.FrameTransform" or "foxglove.Log". Another name is a programming error.
[[nodiscard]] std::string schema(std::string_view name);

/// Red, green, blue, opacity, each 0 to 1.
using Color = std::array<double, 4>;

enum class LogLevel : std::uint8_t { kInfo = 2, kWarning = 3, kError = 4 };

/// What an entity of a scene is made of; all in the entity's frame, orientations are the identity.
struct Sphere {
  Vec3 center = Vec3::Zero();
  double radius = 0.0;
  Color color{};
};
struct Cube {
  Vec3 center = Vec3::Zero(), edges = Vec3::Zero();
  Color color{};
};
struct Triangles {
  Vec3 origin = Vec3::Zero();
  std::vector<Vec3> points{};
  std::span<const report::Triangle> faces{};
  Color color{};
};
struct Line {
  std::vector<Vec3> points{};
  double pixels = 2.0;
  Color color{};
  bool pairs = false;  ///< each two points a segment of their own
};
struct Text {
  Vec3 position = Vec3::Zero();
  std::string text{};
  Color color{};
};
struct Entity {
  std::string id{};
  std::vector<Sphere> spheres{};
  std::vector<Cube> cubes{};
  std::vector<Triangles> triangles{};
  std::vector<Line> lines{};
  std::vector<Text> texts{};
};

// Messages: one JSON object each. Times are ns since the recording's epoch.

/// `afresh`: all entities of the topic from before go.
[[nodiscard]] std::string scene_update(std::uint64_t time_ns, std::string_view frame,
                                       const std::vector<Entity>& entities, bool afresh);
[[nodiscard]] std::string pose_in_frame(std::uint64_t time_ns, std::string_view frame, const Vec3& position,
                                        double yaw);
[[nodiscard]] std::string poses_in_frame(std::uint64_t time_ns, std::string_view frame,
                                         std::span<const Vec3> positions);
[[nodiscard]] std::string frame_transform(std::uint64_t time_ns, std::string_view parent, std::string_view child,
                                          const Vec3& translation);
[[nodiscard]] std::string log(std::uint64_t time_ns, LogLevel level, std::string_view message, std::string_view name);

}  // namespace jink::tools::mcap::foxglove
