// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/map/mapper.hpp"

#include <algorithm>
#include <utility>

#include "planner/base/solid.hpp"
#include "planner/horizon/placed_solid.hpp"

namespace jink::bridge::map {
namespace {

constexpr double kGrown = Occupancy::kCell;  // m, by which what is tracked counts as larger: no trail is left of it
constexpr double kSigmas = 2.0;              // of its position, likewise
constexpr double kUnseen = 0.1;              // m, beside the vehicle, that are to be seen, too

/// Something tracked, where it was.
struct Tracked {
  Vec3 center;
  double grown;
  double reach;  // of the sphere around it, grown
  planner::horizon::PlacedSolid solid;

  [[nodiscard]] bool holds(const Vec3& p) const {
    return (p - center).squaredNorm() < reach * reach && (solid.is_none() || solid.distance(p) < grown);
  }
};

std::vector<Tracked> tracked_near(const CloudJob& job) {
  std::vector<Tracked> near;
  for (const planner::base::Track& track : job.tracked) {
    const double grown = kGrown + kSigmas * track.position_sigma;
    const double reach = track.radius + grown;
    if ((track.position - job.sensor).norm() > Occupancy::kLongestRange + reach) continue;
    near.push_back({track.position, grown, reach, {track.body, track.position, 0.0}});
  }
  return near;
}

}  // namespace

std::shared_ptr<const planner::geometry::StaticMap> with_boxes(const planner::geometry::StaticMap& known,
                                                               std::span<const CellBox> boxes, const Vec3& origin) {
  std::vector<planner::base::Track> tracks(known.tracks().begin(), known.tracks().end());
  tracks.reserve(tracks.size() + boxes.size());
  for (const CellBox& box : boxes) {
    planner::base::Track track;
    const Vec3 edges = Occupancy::kCell * (box.max - box.min).cast<double>();
    track.position = origin + 0.5 * Occupancy::kCell * (box.max + box.min).cast<double>();
    track.body.solid = planner::base::Solid::box(edges, {});
    track.radius = track.body.solid->reach();
    tracks.push_back(std::move(track));
  }
  return std::make_shared<const planner::geometry::StaticMap>(std::move(tracks));
}

Mapper::Mapper(const OccupancySettings& settings, double own_radius,
               std::shared_ptr<const planner::geometry::StaticMap> known, const base::Clock* clock)
    : own_radius_(own_radius), known_(std::move(known)), clock_(clock), grid_(settings) {
  if (clock_ != nullptr) thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

Mapper::~Mapper() {
  thread_.request_stop();
  wake_.notify_all();
}

void Mapper::put(CloudJob job) {
  if (clock_ == nullptr) return take(job);
  {
    const std::scoped_lock lock(mutex_);
    if (job_) {
      ++counts_.skipped;
      job.anew = job.anew || job_->anew;
    }
    job_ = std::move(job);
  }
  wake_.notify_all();
}

std::shared_ptr<const Seen> Mapper::seen() const {
  const std::scoped_lock lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
  return seen_;
}

std::optional<Occupancy::Column> Mapper::column() const {
  const std::scoped_lock lock(mutex_);
  return column_;
}

std::size_t Mapper::first_unseen(std::span<const Vec3> places) const {
  const std::scoped_lock lock(grid_mutex_);
  const double radius = own_radius_ + kUnseen;
  const auto unseen = std::find_if(places.begin(), places.end(), [&](const Vec3& place) {
    return !grid_.is_known(place - shift_, radius, places.front() - shift_);
  });
  return static_cast<std::size_t>(unseen - places.begin());
}

MapperCounts Mapper::counts() const {
  const std::scoped_lock lock(mutex_);
  return counts_;
}

void Mapper::work(const std::stop_token& stop) {
  while (true) {
    CloudJob job;
    {
      std::unique_lock lock(mutex_);
      if (!wake_.wait(lock, stop, [&] { return job_.has_value(); })) return;
      job = std::move(*job_);
      job_.reset();
    }
    try {
      take(job);
    } catch (...) {
      const std::scoped_lock lock(mutex_);
      failure_ = std::current_exception();
    }
  }
}

// The cells lie still where the local frame jumps.
void Mapper::take(const CloudJob& job) {
  const double begun = clock_ != nullptr ? clock_->now() : 0.0;
  const std::vector<Tracked> tracked = tracked_near(job);
  CloudView cloud;
  cloud.time = job.time;
  cloud.points = job.points;
  cloud.to_enu = Eigen::Translation3d(-job.shift) * job.to_local;
  cloud.sensor = job.sensor - job.shift;
  cloud.vehicle = job.vehicle - job.shift;
  cloud.own_radius = own_radius_;
  cloud.floor = job.floor - job.shift.z();
  if (!tracked.empty()) {
    cloud.elsewhere = [&](const Vec3& p) {
      return std::any_of(tracked.begin(), tracked.end(), [&](const Tracked& t) { return t.holds(p + job.shift); });
    };
  }
  std::unique_lock grid_lock(grid_mutex_);
  shift_ = job.shift;
  if (job.anew) grid_.forget();
  const CloudCounts counts = grid_.insert(cloud);
  if (seen() == nullptr || job.anew) grid_.free_around(cloud.vehicle, kRoomAtStart);
  Occupancy::Column column = grid_.free_column(cloud.vehicle, own_radius_);
  column.low += job.shift.z();
  column.high += job.shift.z();
  Seen now;
  now.boxes = grid_.boxes();
  grid_lock.unlock();
  now.origin = job.shift - Vec3(0.0, 0.0, job.up);
  now.up = job.up;
  std::shared_ptr<const Seen> before = seen();
  const bool same =
      before != nullptr && now.boxes == before->boxes && now.origin == before->origin && now.up == before->up;
  if (!same) {
    now.number = before == nullptr ? 1 : before->number + 1;
    now.map = with_boxes(*known_, now.boxes, now.origin);
    before = std::make_shared<const Seen>(std::move(now));
  }
  const double ms = clock_ != nullptr ? 1e3 * (clock_->now() - begun) : 0.0;
  const std::scoped_lock lock(mutex_);
  seen_ = std::move(before);
  column_ = column;
  ++counts_.clouds;
  counts_.points.hits += counts.hits;
  counts_.points.clear += counts.clear;
  counts_.points.none += counts.none;
  counts_.points.own += counts.own;
  counts_.points.repeated += counts.repeated;
  counts_.most_ms = std::max(counts_.most_ms, ms);
}

}  // namespace jink::bridge::map
