// SPDX-License-Identifier: BSD-3-Clause
#include "bridge/prediction/motion_learner.hpp"

#include <algorithm>
#include <cmath>

#include "planner/base/settings.hpp"
#include "planner/geometry/obstacle_motion.hpp"

namespace jink::bridge::prediction {
namespace {

constexpr double kSpacing = 0.05;     // s, between samples at first
constexpr double kCoarsest = 0.2;     // s, that means of noisy samples are taken over
constexpr double kFitPeriod = 0.15;   // s
constexpr double kPatience = 4.0;     // fit periods, between fits where there is little to learn
constexpr double kShortest = 0.3;     // s, of history for a first fit
constexpr double kPlainMisfit = 0.1;  // m in kLead seconds, with which plain prediction does
constexpr double kProven = 0.5;       // m, that a fit may be off by in kLead seconds, whatever plain prediction is
constexpr double kLongestLead = 2.5;  // s, until which a fit is tried where plain prediction does as well
constexpr double kUnderstood = 0.25;  // m in kLead seconds, with which a fit that has proved right explains the motion
constexpr double kBetter = 0.6;       // times plain prediction's misfit, that its own may be
constexpr double kCurving = 1.0;      // m/s², measured, with which plain prediction will not do for long
constexpr double kMuchBetter = 0.5;   // the same, noise included, that proves it before kLead seconds are over
constexpr double kSigmas = 3.0;       // of the estimate that a misfit may be by noise
constexpr double kExact = 1e-4;       // m, m/s: sigmas below are taken for this
constexpr double kBeyond = 0.1;       // m, that noise may put a track behind a bound
constexpr double kTurnSpeed = 0.3;    // m/s, below which a turn is no bounce
constexpr std::size_t kNoisyWindow = 5;  // samples on either side of a turn
constexpr double kDoubt = 0.1;           // m/s, that a forecast is worse by than its measure
constexpr planner::base::HorizonSettings kDefaults;
constexpr double kTrust = kDefaults.acceleration_trust;  // s, of plain prediction's acceleration
constexpr double kAhead = kDefaults.time;                // s, in which a turn is of interest
constexpr int kCertain = 2;                              // turns at one place, after which it is relied on
constexpr double kTurnPause = 0.3;                       // s, between two turns of a track

double along(double x, bool upper) {
  return upper ? x : -x;
}

MotionSample mean(const MotionSample& a, const MotionSample& b) {
  const double all = a.measurements + b.measurements;
  const double first = a.measurements / all;
  const double second = b.measurements / all;
  return {first * a.t + second * b.t, first * a.position + second * b.position,
          first * a.velocity + second * b.velocity, all};
}

}  // namespace

void LearnedBounds::saw(const Vec3& position, double radius) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool upper : {false, true}) {
      Side& side = sides_[static_cast<std::size_t>(axis)][upper ? 1 : 0];
      side.extent = std::max(side.extent, along(position[axis], upper) + radius);
      if (side.any && side.extent > side.surface + 2.0 * kBeyond) side.any = side.confirmed = false;
    }
  }
}

void LearnedBounds::turned(std::uint64_t track, int axis, bool upper, double surface) {
  Side& side = sides_[static_cast<std::size_t>(axis)][upper ? 1 : 0];
  const double outward = along(surface, upper);
  if (outward < side.extent - kBeyond) return;
  if (side.any && std::abs(outward - side.surface) < 2.0 * kBeyond) {
    side.confirmed = side.confirmed || track != side.first;
    return;
  }
  side.surface = outward;
  side.first = track;
  side.any = true;
  side.confirmed = false;
}

planner::base::Box LearnedBounds::bounds(double radius) const {
  planner::base::Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const auto& [lower, upper] = sides_[static_cast<std::size_t>(axis)];
    if (lower.confirmed) box.min[axis] = -lower.surface + radius;
    if (upper.confirmed) box.max[axis] = upper.surface - radius;
  }
  return box;
}

bool MotionLearner::Trial::plain_wrong() const {
  return plain_misfit > kPlainMisfit + noise;
}

// Makes room for as many again. Exact measurements are enough of every other one; of noisy ones each counts.
void MotionLearner::thin_out(bool exact) {
  if (!exact && spacing_ > 0.5 * kCoarsest) {
    samples_.erase(samples_.begin());
    return;
  }
  std::size_t kept = 0;
  for (std::size_t i = 1; i < samples_.size(); i += 2)
    samples_[kept++] = exact ? samples_[i] : mean(samples_[i - 1], samples_[i]);
  samples_.resize(kept);
  spacing_ *= 2.0;
}

void MotionLearner::remember(const MotionSample& sample, bool exact) {
  if (spacing_ == 0.0) spacing_ = kSpacing;
  const auto early = [&] { return !samples_.empty() && sample.t - begun_ < spacing_ - 1e-3; };
  if (early()) {
    if (!exact) samples_.back() = mean(samples_.back(), sample);
    return;
  }
  if (samples_.size() >= kMost) thin_out(exact);
  if (exact && early()) return;
  samples_.push_back(sample);
  begun_ = sample.t;
}

void MotionLearner::observe(double t, const planner::base::Track& measured, const planner::base::Track& estimate,
                            std::uint64_t name, Experience& all) {
  if (first_ < 0.0) first_ = t;
  remember({t, measured.position, measured.velocity}, measured.is_exact());
  recent_.push_back({t, measured.position, measured.velocity});
  if (recent_.size() > 2 * kNoisyWindow) recent_.erase(recent_.begin());
  const double noise = kSigmas * estimate.position_sigma;
  all.bounds.saw(estimate.position, estimate.radius - noise);
  // A bound that the track has passed is none.
  const double slack = kBeyond + noise;
  for (int axis = 0; axis < 3; ++axis) {
    auto& [below, above] = returns_[static_cast<std::size_t>(axis)];
    if (estimate.position[axis] > turns_.max[axis] + slack) {
      all.turns.note(/*came_true=*/false);
      turns_.max[axis] = planner::base::kInfinity;
      above = 0;
    }
    if (estimate.position[axis] < turns_.min[axis] - slack) {
      all.turns.note(/*came_true=*/false);
      turns_.min[axis] = -planner::base::kInfinity;
      below = 0;
    }
  }
  look_for_turn(t, measured, name, all);
  judge(t, estimate, all.swings);
  const bool curves = estimate.position_sigma <= 0.0 && estimate.acceleration.squaredNorm() > kCurving * kCurving;
  const bool fails =
      std::any_of(trials_.begin(), trials_.end(), [](const Trial& trial) { return trial.plain_wrong(); });
  const bool understood = proven_ && *proven_ < kUnderstood + noise;
  unexplained_ = !understood && !plain_ && (curves || fails);
}

void MotionLearner::turned(double t, int axis, double where, double speed, std::uint64_t name, double radius,
                           Experience& all) {
  const bool upper = speed > 0.0;
  double& bound = (upper ? turns_.max : turns_.min)[axis];
  int& returns = returns_[static_cast<std::size_t>(axis)][upper ? 1 : 0];
  const bool again = std::abs(where - bound) < 2.0 * kBeyond;
  if (again) all.turns.note(/*came_true=*/true);
  returns = again ? returns + 1 : 1;
  bound = where;
  all.bounds.turned(name, axis, upper, upper ? where + radius : where - radius);
  last_turn_ = t;
}

// Two straight pieces at the same speed, one axis turned round.
void MotionLearner::look_for_turn(double t, const planner::base::Track& measured, std::uint64_t name, Experience& all) {
  const std::size_t window = measured.is_exact() ? 1 : kNoisyWindow;
  if (recent_.size() < 2 * window) return;
  if (!measured.is_exact() && last_turn_ >= 0.0 && t - last_turn_ < kTurnPause) return;
  struct Piece {
    double t = 0.0;
    Vec3 position = Vec3::Zero(), velocity = Vec3::Zero();
  };
  const auto mean = [&](std::size_t begin) {
    Piece piece;
    for (std::size_t i = begin; i < begin + window; ++i) {
      piece.t += recent_[i].t;
      piece.position += recent_[i].position;
      piece.velocity += recent_[i].velocity;
    }
    const double share = 1.0 / static_cast<double>(window);
    return Piece{share * piece.t, share * piece.position, share * piece.velocity};
  };
  const std::size_t first = recent_.size() - 2 * window;
  const Piece before = mean(first);
  const Piece after = mean(first + window);
  const double noise = kSigmas * measured.velocity_sigma / std::sqrt(static_cast<double>(window));
  for (int axis = 0; axis < 3; ++axis) {
    const double v0 = before.velocity[axis];
    const double v1 = after.velocity[axis];
    if (v0 * v1 >= 0.0 || std::abs(v0) < kTurnSpeed + noise) continue;
    if (std::abs(v0 + v1) > 0.01 * std::abs(v0) + noise) continue;
    // Where the two pieces meet.
    const double dt = after.t - before.t;
    const double until = (after.position[axis] - before.position[axis] + std::abs(v1) * (v0 > 0.0 ? dt : -dt)) /
                         (std::abs(v1) * (v0 > 0.0 ? 1.0 : -1.0) + v0);
    if (!(until >= -0.5 * dt && until <= 1.5 * dt)) continue;
    turned(t, axis, before.position[axis] + until * v0, v0, name, measured.radius, all);
  }
}

// Holds the fits on trial against the newest estimate.
void MotionLearner::judge(double t, const planner::base::Track& estimate, PredictionRecord& swings) {
  const double noise = kSigmas * estimate.position_sigma;
  const auto lead = [t](const Trial& trial) { return t - trial.begun; };
  const auto note = [&](bool came_true) {
    swings.note(came_true);
    swings_.note(came_true);
  };
  for (Trial& trial : trials_) {
    trial.noise = std::max(trial.noise, noise);
    trial.misfit = std::max(trial.misfit, (trial.motion.position(lead(trial)) - estimate.position).norm());
    trial.plain_misfit =
        std::max(trial.plain_misfit,
                 (planner::geometry::predict_position(trial.plain, lead(trial), kTrust) - estimate.position).norm());
  }
  // A fit may be off by as much as it is better than plain prediction.
  const auto wrong = [](const Trial& trial) {
    return trial.misfit > std::max(kProven + trial.noise, kBetter * trial.plain_misfit);
  };
  const auto decided = [&](const Trial& trial) {
    // Where plain prediction has gone wrong already and the fit has not, there is no need to wait.
    if (trial.plain_wrong() && trial.misfit + trial.noise < kMuchBetter * trial.plain_misfit) return true;
    return lead(trial) >= (wrong(trial) || trial.plain_wrong() ? kLead : kLongestLead);
  };
  while (!trials_.empty() && decided(trials_.front())) {
    Trial& trial = trials_.front();
    plain_ = !trial.plain_wrong();
    if (trial.misfit < kBetter * trial.plain_misfit) {
      if (proven_ && t - recorded_ >= kLead) {
        note(/*came_true=*/true);
        recorded_ = t;
      }
      if (failures_ < 0) proven_ = trial.misfit;
      failures_ = std::min(failures_, 0) - 1;
      if (trials_.size() == 1) {  // a forecast needs a fit that is on trial: the same again, until there is a new one
        trial = {t, trial.motion.later(lead(trial)), estimate};
        break;
      }
    } else {
      if (proven_ && wrong(trial)) note(/*came_true=*/false);
      proven_.reset();
      failures_ = std::max(failures_, 0) + 1;
    }
    trials_.erase(trials_.begin());
  }
  // A fit that goes wrong before its time is over ends the belief at once.
  if (std::any_of(trials_.begin(), trials_.end(), wrong)) {
    if (proven_) note(/*came_true=*/false);
    proven_.reset();
    failures_ = std::max(failures_, 0);
  }
}

void MotionLearner::fit(double t, const planner::base::Track& measured, const planner::base::Track& estimate) {
  next_fit_ = t + kFitPeriod * (plain_ ? kPatience : std::clamp(0.25 * failures_, 1.0, kPatience));
  if (samples_.empty() || samples_.back().t - samples_.front().t < kShortest) return;
  const double guess = proven_ ? frequency_ : 0.0;
  const auto found = fit_harmonics(samples_, std::max(kExact, measured.position_sigma),
                                   std::max(kExact, measured.velocity_sigma), guess);
  if (!found) return;
  frequency_ = found->motion.frequency;
  trials_.push_back({t, found->motion.later(t - samples_.back().t), estimate});
}

// Whether a turn of `motion` is where the track itself turned again and again.
bool MotionLearner::certain(const BouncingMotion& motion, const BouncingMotion::Turn& turn) const {
  const auto bound = [&](const planner::base::Box& box) { return (turn.upper ? box.max : box.min)[turn.axis]; };
  return bound(motion.room) == bound(turns_) &&
         returns_[static_cast<std::size_t>(turn.axis)][turn.upper ? 1 : 0] >= kCertain;
}

std::optional<Forecast> MotionLearner::forecast(double now, double t, const planner::base::Track& estimate,
                                                const Experience& all) const {
  Forecast forecast;
  forecast.radius = estimate.radius;
  forecast.position_sigma = estimate.position_sigma;
  if (proven_ && !plain_ && !trials_.empty()) {
    const Trial& newest = trials_.back();
    forecast.motion = newest.motion.later(now - newest.begun);
    forecast.velocity_sigma = kDoubt + 0.5 * *proven_ / kLead;
    if (all.swings.good()) forecast.plain_until = swings_.good() ? 0.0 : kLead;
    return forecast;
  }
  BouncingMotion bouncing{estimate.position, estimate.velocity, all.bounds.bounds(estimate.radius)};
  bouncing.room.min = bouncing.room.min.cwiseMax(turns_.min);
  bouncing.room.max = bouncing.room.max.cwiseMin(turns_.max);
  const BouncingMotion::Turn next = bouncing.first_turn();
  if (!(next.t < now - t + kAhead)) return std::nullopt;
  // Until then nothing tells the obstacle that turns from the one that goes on.
  if (certain(bouncing, next) && all.turns.good()) forecast.plain_until = std::max(0.0, next.t - (now - t)) + kLead;
  bouncing.begin = bouncing.position(now - t);
  for (int axis = 0; axis < 3; ++axis) {
    const double x = estimate.position[axis] + (now - t) * estimate.velocity[axis];
    if (x < bouncing.room.min[axis] || x > bouncing.room.max[axis]) bouncing.velocity[axis] = -bouncing.velocity[axis];
  }
  forecast.velocity_sigma = kDoubt + estimate.velocity_sigma;
  forecast.motion = bouncing;
  return forecast;
}

}  // namespace jink::bridge::prediction
