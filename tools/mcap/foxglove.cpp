// SPDX-License-Identifier: BSD-3-Clause
#include "tools/mcap/foxglove.hpp"

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

namespace jink::tools::mcap::foxglove {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::uint64_t kSecond_ns = 1'000'000'000;
constexpr double kTextSize_px = 14.0;

Json object(const Json& properties) {
  return {{"type", "object"}, {"properties", properties}};
}
Json named(std::string_view name, Json schema) {
  schema["title"] = name;
  return schema;
}
Json list(const Json& items) {
  return {{"type", "array"}, {"items", items}};
}
Json integer(std::uint64_t most = 0) {
  Json schema{{"type", "integer"}, {"minimum", 0}};
  if (most > 0) schema["maximum"] = most;
  return schema;
}
const Json kNumber{{"type", "number"}};
const Json kText{{"type", "string"}};
const Json kFlag{{"type", "boolean"}};

Json numbers(std::initializer_list<const char*> keys) {
  Json properties = Json::object();
  for (const char* key : keys) properties[key] = kNumber;
  return object(properties);
}
Json time_schema(const char* title) {
  return named(title, object({{"sec", integer()}, {"nsec", integer(kSecond_ns - 1)}}));
}
Json vector_schema() {
  return named("foxglove.Vector3", numbers({"x", "y", "z"}));
}
Json points_schema() {
  return list(named("foxglove.Point3", numbers({"x", "y", "z"})));
}
Json quaternion_schema() {
  return named("foxglove.Quaternion", numbers({"x", "y", "z", "w"}));
}
Json color_schema() {
  return named("foxglove.Color", numbers({"r", "g", "b", "a"}));
}
Json pose_schema() {
  return named("foxglove.Pose", object({{"position", vector_schema()}, {"orientation", quaternion_schema()}}));
}
Json values(std::initializer_list<std::pair<int, const char*>> list) {
  Json schema{{"oneOf", Json::array()}};
  for (const auto& [value, title] : list) schema["oneOf"].push_back({{"title", title}, {"const", value}});
  return schema;
}

Json entity_schema() {
  const Json pose = pose_schema(), color = color_schema(), colors = list(color), indices = list(integer());
  const Json solid = object({{"pose", pose}, {"size", vector_schema()}, {"color", color}});
  const Json line_kinds = values({{0, "LINE_STRIP"}, {1, "LINE_LOOP"}, {2, "LINE_LIST"}});
  Json line{{"type", line_kinds}, {"pose", pose}, {"thickness", kNumber}, {"scale_invariant", kFlag}};
  line.update({{"points", points_schema()}, {"color", color}, {"colors", colors}, {"indices", indices}});
  const Json triangles{
      {"pose", pose}, {"points", points_schema()}, {"color", color}, {"colors", colors}, {"indices", indices}};
  const Json text{{"pose", pose},   {"billboard", kFlag}, {"font_size", kNumber}, {"scale_invariant", kFlag},
                  {"color", color}, {"text", kText}};
  Json properties{{"timestamp", time_schema("time")},
                  {"frame_id", kText},
                  {"id", kText},
                  {"lifetime", time_schema("duration")},
                  {"frame_locked", kFlag}};
  properties["metadata"] = list(named("foxglove.KeyValuePair", object({{"key", kText}, {"value", kText}})));
  for (const char* none : {"arrows", "cylinders", "models"}) properties[none] = list(object(Json::object()));
  properties["cubes"] = list(named("foxglove.CubePrimitive", solid));
  properties["spheres"] = list(named("foxglove.SpherePrimitive", solid));
  properties["lines"] = list(named("foxglove.LinePrimitive", object(line)));
  properties["triangles"] = list(named("foxglove.TriangleListPrimitive", object(triangles)));
  properties["texts"] = list(named("foxglove.TextPrimitive", object(text)));
  return named("foxglove.SceneEntity", object(properties));
}

Json scene_schema() {
  const Json deletion{
      {"timestamp", time_schema("time")}, {"type", values({{0, "MATCHING_ID"}, {1, "ALL"}})}, {"id", kText}};
  return object({{"deletions", list(named("foxglove.SceneEntityDeletion", object(deletion)))},
                 {"entities", list(entity_schema())}});
}

Json log_schema() {
  const Json levels = values({{0, "UNKNOWN"}, {1, "DEBUG"}, {2, "INFO"}, {3, "WARNING"}, {4, "ERROR"}, {5, "FATAL"}});
  return object({{"timestamp", time_schema("time")},
                 {"level", levels},
                 {"message", kText},
                 {"name", kText},
                 {"file", kText},
                 {"line", integer()}});
}

Json properties_of(std::string_view name) {
  if (name == "foxglove.SceneUpdate") return scene_schema();
  if (name == "foxglove.Log") return log_schema();
  if (name == "foxglove.FrameTransform") {
    return object({{"timestamp", time_schema("time")},
                   {"parent_frame_id", kText},
                   {"child_frame_id", kText},
                   {"translation", vector_schema()},
                   {"rotation", quaternion_schema()}});
  }
  Json pose = object({{"timestamp", time_schema("time")}, {"frame_id", kText}});
  if (name == "foxglove.PoseInFrame") {
    pose["properties"]["pose"] = pose_schema();
  } else if (name == "foxglove.PosesInFrame") {
    pose["properties"]["poses"] = list(pose_schema());
  } else {
    throw std::logic_error("no such schema: " + std::string(name));
  }
  return pose;
}

void put_time(base::JsonWriter& line, const char* key, std::uint64_t time_ns) {
  line.key(key).open('{').key("sec").integer(time_ns / kSecond_ns).key("nsec").integer(time_ns % kSecond_ns).close('}');
}

void put_vector(base::JsonWriter& line, const Vec3& v) {
  line.open('{').key("x").number(v.x()).key("y").number(v.y()).key("z").number(v.z()).close('}');
}

/// A rotation about the vertical.
void put_rotation(base::JsonWriter& line, const char* key, double yaw) {
  line.key(key).open('{').key("x").number(0.0).key("y").number(0.0).key("z").number(std::sin(0.5 * yaw));
  line.key("w").number(std::cos(0.5 * yaw)).close('}');
}

void put_pose(base::JsonWriter& line, const Vec3& position, double yaw = 0.0) {
  line.open('{').key("position");
  put_vector(line, position);
  put_rotation(line, "orientation", yaw);
  line.close('}');
}

void put_color(base::JsonWriter& line, const Color& c) {
  line.key("color").open('{').key("r").number(c[0]).key("g").number(c[1]).key("b").number(c[2]);
  line.key("a").number(c[3]).close('}');
}

void put_points(base::JsonWriter& line, std::span<const Vec3> points) {
  line.key("points").open('[');
  for (const Vec3& p : points) put_vector(line, p);
  line.close(']');
}

void put_solid(base::JsonWriter& line, const Vec3& center, const Vec3& size, const Color& color) {
  line.open('{').key("pose");
  put_pose(line, center);
  line.key("size");
  put_vector(line, size);
  put_color(line, color);
  line.close('}');
}

void put_primitive(base::JsonWriter& line, const Sphere& s) {
  put_solid(line, s.center, Vec3::Constant(2.0 * s.radius), s.color);
}

void put_primitive(base::JsonWriter& line, const Cube& c) {
  put_solid(line, c.center, c.edges, c.color);
}

void put_primitive(base::JsonWriter& line, const Triangles& t) {
  line.open('{').key("pose");
  put_pose(line, t.origin);
  put_points(line, t.points);
  put_color(line, t.color);
  line.key("colors").open('[').close(']').key("indices").open('[');
  for (const report::Triangle& face : t.faces) {
    for (const std::size_t corner : face) line.integer(corner);
  }
  line.close(']').close('}');
}

void put_primitive(base::JsonWriter& line, const Line& l) {
  line.open('{').key("type").integer(l.pairs ? 2 : 0).key("pose");
  put_pose(line, Vec3::Zero());
  line.key("thickness").number(l.pixels).key("scale_invariant").flag(true);
  put_points(line, l.points);
  put_color(line, l.color);
  line.key("colors").open('[').close(']').key("indices").open('[').close(']').close('}');
}

void put_primitive(base::JsonWriter& line, const Text& t) {
  line.open('{').key("pose");
  put_pose(line, t.position);
  line.key("billboard").flag(true).key("font_size").number(kTextSize_px).key("scale_invariant").flag(true);
  put_color(line, t.color);
  line.key("text").text(t.text).close('}');
}

template <typename Primitive>
void put_all(base::JsonWriter& line, const char* key, const std::vector<Primitive>& primitives) {
  line.key(key).open('[');
  for (const Primitive& primitive : primitives) put_primitive(line, primitive);
  line.close(']');
}

void put_entity(base::JsonWriter& line, std::uint64_t time_ns, std::string_view frame, const Entity& entity) {
  line.open('{');
  put_time(line, "timestamp", time_ns);
  line.key("frame_id").text(frame).key("id").text(entity.id);
  put_time(line, "lifetime", 0);  // until it is replaced
  line.key("frame_locked").flag(true);
  for (const char* none : {"metadata", "arrows", "cylinders", "models"}) line.key(none).open('[').close(']');
  put_all(line, "cubes", entity.cubes);
  put_all(line, "spheres", entity.spheres);
  put_all(line, "lines", entity.lines);
  put_all(line, "triangles", entity.triangles);
  put_all(line, "texts", entity.texts);
  line.close('}');
}

}  // namespace

std::string schema(std::string_view name) {
  return named(name, properties_of(name)).dump();
}

std::string scene_update(std::uint64_t time_ns, std::string_view frame, const std::vector<Entity>& entities,
                         bool afresh) {
  base::JsonWriter line;
  line.open('{').key("deletions").open('[');
  if (afresh) {
    line.open('{');
    put_time(line, "timestamp", time_ns);
    line.key("type").integer(1).key("id").text("").close('}');
  }
  line.close(']').key("entities").open('[');
  for (const Entity& entity : entities) put_entity(line, time_ns, frame, entity);
  line.close(']').close('}');
  return line.str();
}

std::string pose_in_frame(std::uint64_t time_ns, std::string_view frame, const Vec3& position, double yaw) {
  base::JsonWriter line;
  line.open('{');
  put_time(line, "timestamp", time_ns);
  line.key("frame_id").text(frame).key("pose");
  put_pose(line, position, yaw);
  line.close('}');
  return line.str();
}

std::string poses_in_frame(std::uint64_t time_ns, std::string_view frame, std::span<const Vec3> positions) {
  base::JsonWriter line;
  line.open('{');
  put_time(line, "timestamp", time_ns);
  line.key("frame_id").text(frame).key("poses").open('[');
  for (const Vec3& position : positions) put_pose(line, position);
  line.close(']').close('}');
  return line.str();
}

std::string frame_transform(std::uint64_t time_ns, std::string_view parent, std::string_view child,
                            const Vec3& translation) {
  base::JsonWriter line;
  line.open('{');
  put_time(line, "timestamp", time_ns);
  line.key("parent_frame_id").text(parent).key("child_frame_id").text(child).key("translation");
  put_vector(line, translation);
  put_rotation(line, "rotation", 0.0);
  line.close('}');
  return line.str();
}

std::string log(std::uint64_t time_ns, LogLevel level, std::string_view message, std::string_view name) {
  base::JsonWriter line;
  line.open('{');
  put_time(line, "timestamp", time_ns);
  line.key("level").integer(static_cast<std::uint64_t>(level)).key("message").text(message).key("name").text(name);
  line.key("file").text("").key("line").integer(0).close('}');
  return line.str();
}

}  // namespace jink::tools::mcap::foxglove
